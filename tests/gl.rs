//! Does wgpu's GL backend draw what Vulkan draws? Where there is no GL adapter, these tests say so and pass.

mod support;

use rigd::service::Service;
use serde_json::json;
use std::sync::{Arc, LazyLock};
use support::pictures::{Tolerance, ask_attached, attached_bytes, draw, matches, over};

/// The same rasterizer rules, other shader compilers: rounding anywhere, and one sample of four on a few edges, which is linear 0.25.
const PICTURES: Tolerance = Tolerance {
    channel: 2,
    share: 0.01,
    most: 140,
};

/// Of positions in meters and of unit normals: a few steps of float32, summed in another order.
const VERTICES: f32 = 1e-5;

/// GL's and Vulkan's, or `None` where one is missing.
static SERVICES: LazyLock<Option<[Arc<Service>; 2]>> =
    LazyLock::new(|| Some([support::service_on("gl")?, support::service_on("vulkan")?]));

fn both() -> Option<&'static [Arc<Service>; 2]> {
    SERVICES.as_ref()
}

#[test]
fn both_backends_draw_the_same_pictures() {
    let Some([gl, vulkan]) = both() else { return };
    for (name, changes) in [
        ("one sample", json!({"samples": 1})),
        ("four samples", json!({"samples": 4})),
        ("flat", json!({"show": {"normals": "flat"}})),
        (
            "translucent",
            json!({"show": {"skin_opacity": 0.5, "skeleton": "wireframe"}, "background": [0.2, 0.1, 0.0, 0.5]}),
        ),
        (
            "skeleton",
            json!({"show": {"skin": "none", "skeleton": "wireframe"}}),
        ),
        (
            "balls and sticks",
            json!({"show": {"skeleton": "sticks", "skin_opacity": 0.4}}),
        ),
        (
            "boxes",
            json!({"show": {"skin": "none", "skeleton": "boxes"}}),
        ),
        (
            "face, with morph targets",
            json!({"pose": {"base": "rest", "dofs": {"morph.smile": 1, "morph.blink": 0.5}},
                "camera": {"kind": "look_at", "eye": [-0.08, 1.62, 0.85], "target": [0.02, 1.58, 0.03], "fov_y": 0.42}}),
        ),
        (
            "pinhole, wide",
            json!({"size": [160, 90], "camera": {"kind": "pinhole", "fx": 150, "fy": 150, "cx": 60, "cy": 50,
                "world_from_camera": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.9, 4, 1]}}),
        ),
    ] {
        let request = json!({"rig": "figure", "size": [120, 160], "pose": {"base": "rest"}});
        let request = over(request, changes);
        let [by_gl, by_vulkan] = [gl, vulkan].map(|service| draw(service, &request).image);
        let first = by_vulkan.at(0, 0);
        assert!(
            by_vulkan.iter().any(|it| it.2 != first),
            "{name}: something is drawn"
        );
        let differing = by_gl.pixels.iter().zip(&by_vulkan.pixels);
        let differing = differing.filter(|(a, b)| a != b).count();
        println!(
            "{name}: {differing} pixels differ, at most by {}",
            by_gl.worst_difference(&by_vulkan)
        );
        assert_eq!(matches(&by_vulkan, &by_gl, PICTURES), Ok(()), "{name}");
    }
}

#[test]
fn both_backends_skin_the_same_vertices() {
    let Some([gl, vulkan]) = both() else { return };
    let dofs = json!({"morph.smile": 0.7, "forearm_l.rx": -1.2, "spine.ry": 0.5});
    let request =
        json!({"rig": "figure", "pose": {"base": "rest", "dofs": dofs}, "transport": "attach"});
    let ways = ["linear", "dual_quaternion"].into_iter();
    let cases = ways.flat_map(|skinning| [(skinning, "positions"), (skinning, "normals")]);
    for (skinning, attribute) in cases {
        let request = over(request.clone(), json!({"skinning": skinning}));
        let [by_gl, by_vulkan] = [gl, vulkan].map(|service| -> Vec<f32> {
            let (result, attached) = ask_attached(service, "mesh.vertices", &request);
            let bytes = attached_bytes(&result["meshes"][0][attribute], &attached);
            let words = bytes.as_chunks::<4>().0.iter();
            words.map(|word| f32::from_le_bytes(*word)).collect()
        });
        assert_eq!(by_gl.len(), by_vulkan.len());
        assert!(by_gl.len() > 3000);
        let off = by_gl.iter().zip(&by_vulkan).map(|(a, b)| (a - b).abs());
        // Not `max`, which would pass over what is not a number.
        let worst = off.fold(0.0f32, |worst, off| if off <= worst { worst } else { off });
        println!("{skinning}, {attribute}: at most {worst:e}");
        assert!(worst <= VERTICES, "{skinning}, {attribute}: {worst}");
    }
}
