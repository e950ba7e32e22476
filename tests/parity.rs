//! Do the two renderers draw the same pictures and skin the same vertices? rigd's own is held against wgpu on a software driver, or on
//! `RIGD_TEST_ADAPTER`. Where there is none, these tests say so and pass.

mod support;

use glam::{DVec3, Vec3, Vec4};
use rigd::render::cpu::Cores;
use rigd::rig::{Draft, MeshDraft};
use rigd::scene::{Bounds, Camera, LookAt, Near, Samples};
use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use support::adapters::{gpu_on, wgpu_adapter};
use support::alike::{self, ALIKE, has_coarse_corners, is_on_an_edge, share_of_all};
use support::pictures::{
    Image, Mismatch, Tolerance, ask_attached, attached_bytes, draw, matches, over,
};
use support::quads::{by_gpu, lit, own, plan, scene};
use support::random::Random;
use support::suite::{base, load_corners, load_reed, load_samples, suite};
use support::{ask_ok, note};

/// Share of a position or normal: a few steps of float32, summed in another order.
const VERTICES: f32 = 1e-5;

/// rigd's own renderer, and wgpu's.
static RENDERERS: LazyLock<Option<[Arc<Service>; 2]>> = LazyLock::new(|| {
    let renderers = [
        support::service_on("cpu")?,
        support::service_on(&support::adapters::wgpu_adapter())?,
    ];
    renderers.iter().for_each(load_corners);
    renderers.iter().for_each(load_reed);
    renderers.iter().for_each(load_samples);
    Some(renderers)
});

/// Their pictures of one request, which must show something.
fn drawn(renderers: &[Arc<Service>; 2], name: &str, request: &Value) -> [Image; 2] {
    let images = [0, 1].map(|index| draw(&renderers[index], request).image);
    let first = images[0].at(0, 0);
    assert!(
        images[0].pixels.len() == 1 || images[0].iter().any(|it| it.2 != first),
        "{name}: nothing is drawn"
    );
    images
}

fn compare(renderers: &[Arc<Service>; 2], name: &str, request: &Value) -> (usize, usize) {
    let images = drawn(renderers, name, request);
    alike::compare(name, &images, request["samples"] == 1)
}

/// What the suite of small pictures leaves out: size, one sample, cameras in the midst of things, lights of every kind at once.
fn more() -> Vec<(&'static str, Value)> {
    let stride =
        json!({"base": "rest", "clip": {"name": "walk", "time": 0.3}, "dofs": {"pelvis.tz": 0}});
    let near = |eye: [f64; 3], target: [f64; 3]| json!({"kind": "look_at", "eye": eye, "target": target, "fov_y": 0.9});
    let point = |position: [f64; 3], falloff: &str| json!({"kind": "point", "position": position, "falloff": falloff, "intensity": 0.4});
    let lights = json!([
        point([1.0, 2.0, 1.0], "none"), point([-1.0, 1.5, 0.5], "inverse_square"), point([0.0, 0.2, 1.0], "inverse_square"),
        {"kind": "directional", "direction": [0, -1, 0], "intensity": 0.3},
    ]);
    let sharp =
        json!({"diffuse": [0.2, 0.2, 0.25], "specular": [0.9, 0.9, 0.9], "shininess": 2000});
    vec![
        ("large", json!({"size": [512, 512], "pose": stride})),
        (
            "one sample",
            json!({"size": [300, 300], "samples": 1, "pose": stride}),
        ),
        ("odd size", json!({"size": [333, 127], "pose": stride})),
        (
            "a single pixel",
            json!({"size": [1, 1], "camera": near([0.0, 1.2, 1.0], [0.0, 1.2, 0.0])}),
        ),
        (
            "from its inside",
            json!({"size": [200, 200], "camera": near([0.0, 1.2, 0.0], [0.3, 1.3, 1.0])}),
        ),
        (
            "through its shoulder",
            json!({"size": [200, 200], "camera": near([0.25, 1.4, 0.3], [0.0, 1.3, -0.4])}),
        ),
        (
            "near plane in its face",
            json!({"size": [200, 200], "camera": {"kind": "look_at", "eye": [0, 1.6, 0.4], "target": [0, 1.6, 0], "near": 0.32}}),
        ),
        (
            "nose to nose",
            json!({"size": [200, 200], "camera": {"kind": "look_at", "eye": [0, 1.58, 0.2], "target": [0, 1.58, 0], "fov_y": 2.5}}),
        ),
        (
            "many lights",
            json!({"size": [200, 200], "lights": lights, "pose": stride}),
        ),
        (
            "sharp highlights",
            json!({"size": [200, 200], "material": sharp}),
        ),
        (
            "translucent before nothing",
            json!({"size": [200, 200], "background": [0, 0, 0, 0], "show": {"skin_opacity": 0.3, "skeleton": "boxes"}}),
        ),
        (
            "culling nothing",
            json!({"size": [200, 200], "cull": "never", "pose": stride}),
        ),
        (
            "flat, from below",
            json!({"size": [200, 200], "show": {"normals": "flat"}, "camera": near([0.3, -1.0, 1.0], [0.0, 0.9, 0.0])}),
        ),
        (
            "dual quaternions",
            json!({"size": [200, 200], "pose": stride, "skinning": "dual_quaternion"}),
        ),
        (
            "its shirt, magnified",
            json!({"size": [200, 200], "camera": near([0.0, 1.3, 0.35], [0.0, 1.25, 0.0])}),
        ),
        (
            "far away",
            json!({"size": [200, 200], "camera": near([0.0, 1.0, 60.0], [0.0, 1.0, 0.0])}),
        ),
    ]
}

#[test]
fn both_renderers_draw_the_same_pictures() {
    let Some(renderers) = RENDERERS.as_ref() else {
        return;
    };
    let of_suite = suite().into_iter();
    let more = more()
        .into_iter()
        .map(|(name, changes)| (name, over(base(json!({})), changes)));
    let (mut off, mut all) = (0, 0);
    for (name, request) in of_suite.chain(more) {
        let (of_picture, channels) = compare(renderers, name, &request);
        println!("{name}: {of_picture} of {channels} channels differ by more than 1");
        (off, all) = (off + of_picture, all + channels);
    }
    note(&format!("{off} of {all} channels differ by more than 1"));
    assert!(off as f64 <= share_of_all() * all as f64);
}

/// Triangles smaller than a pixel, side by side, each corner with a normal and a color of its own. In a picture of 64 x 64 pixels that is
/// seen from the origin, corners fall on sixteenths of a pixel, the coarsest grid that Vulkan lets drivers round them to: so all cover
/// the same samples.
fn mosaic() -> Draft {
    const SIDE: u32 = 100;
    let mut random = Random(7);
    let corner = |index: u32| {
        let mut sixteenths = |at: u32| (10.0 * f64::from(at) + 4.0 * random.unit()).round() / 16.0;
        let [x, y] = [index % SIDE, index / SIDE].map(&mut sixteenths);
        let depth = 3.0 + random.unit();
        let position = DVec3::new(x / 32.0 - 1.0, 1.0 - y / 32.0, -1.0) * depth;
        let mut unit = || random.unit() as f32;
        let normal = Vec3::new(2.0 * unit() - 1.0, 2.0 * unit() - 1.0, 1.0).normalize_or(Vec3::Z);
        let color = Vec4::new(unit(), unit(), unit(), 1.0);
        (position.as_vec3(), (normal, color))
    };
    let (positions, rest): (_, Vec<_>) = (0..SIDE * SIDE).map(corner).unzip();
    let (normals, colors) = rest.into_iter().unzip();
    let squares = (0..SIDE - 1).flat_map(|row| (0..SIDE - 1).map(move |at| row * SIDE + at));
    let triangles = squares.flat_map(|at| {
        let [right, below, across] = [at + 1, at + SIDE, at + SIDE + 1];
        [[at, below, right], [right, below, across]]
    });
    let mesh = MeshDraft {
        positions,
        normals: Some(normals),
        colors: Some(colors),
        triangles: triangles.collect(),
        ..MeshDraft::default()
    };
    Draft {
        meshes: vec![mesh],
        ..Draft::default()
    }
}

#[test]
fn triangles_that_share_a_pixel_are_shaded_at_the_same_places_on_every_driver() {
    let Some(mut gpu) = gpu_on(&wgpu_adapter()) else {
        return;
    };
    for samples in [Samples::One, Samples::Four] {
        let mut scene = lit(scene([64, 64], samples), DVec3::new(0.3, -0.2, -1.0));
        let look = LookAt {
            eye: DVec3::ZERO,
            target: DVec3::NEG_Z,
            up: DVec3::Y,
            fov_y: Some(std::f64::consts::FRAC_PI_2),
            height: None,
            near: Near(None),
        };
        let bounds = Bounds {
            min: DVec3::splat(-4.0),
            max: DVec3::new(4.0, 4.0, -3.0),
        };
        scene.camera = Camera::look_at(look, &bounds, scene.size).expect("a camera");
        let plan = plan(mosaic(), scene);
        let [own, wgpu] = [own(&plan, Cores::One), by_gpu(&mut gpu, &plan)];
        assert!(
            own.iter().any(|it| it.2 != own.at(0, 0)),
            "nothing is drawn"
        );
        // Nothing lies on an edge: what is left is rounding.
        let rounding = Tolerance {
            channel: 1,
            share: 0.0005,
            most: 8,
        };
        assert_eq!(matches(&wgpu, &own, rounding), Ok(()), "{samples:?}");
    }
}

#[test]
fn both_renderers_skin_the_same_vertices() {
    let Some(renderers) = RENDERERS.as_ref() else {
        return;
    };
    let dofs = json!({"morph.smile": 0.7, "forearm_l.rx": -1.2, "spine.ry": 0.5});
    for (skinning, range) in [
        ("linear", json!(null)),
        ("dual_quaternion", json!(null)),
        ("linear", json!({"start": 17, "count": 5})),
        ("dual_quaternion", json!({"start": 3, "count": 0})),
    ] {
        let mut request = json!({
            "rig": "figure", "pose": {"base": "rest", "dofs": dofs}, "transport": "attach", "skinning": skinning,
        });
        if !range.is_null() {
            request["range"] = range.clone();
        }
        for attribute in ["positions", "normals"] {
            let [own, wgpu] = [0, 1].map(|index| -> Vec<f32> {
                let (result, attached) = ask_attached(&renderers[index], "mesh.vertices", &request);
                let bytes = attached_bytes(&result["meshes"][0][attribute], &attached);
                let words = bytes.as_chunks::<4>().0.iter();
                words.map(|word| f32::from_le_bytes(*word)).collect()
            });
            assert_eq!(own.len(), wgpu.len());
            let off = own.iter().zip(&wgpu).map(|(a, b)| (a - b).abs());
            // Not `max`, which would pass over what is not a number.
            let worst = off.fold(0.0f32, |worst, off| if off <= worst { worst } else { off });
            assert!(worst <= VERTICES, "{skinning}, {attribute}: {worst}");
        }
    }
}

#[test]
fn culling_is_not_seen() {
    let Some(renderers) = RENDERERS.as_ref() else {
        return;
    };
    for (name, request) in suite() {
        for (renderer, of) in renderers.iter().zip(["cpu", "wgpu"]) {
            // SwiftShader shows some samples of the far side along silhouettes.
            if of == "wgpu" && has_coarse_corners() {
                continue;
            }
            let culled = draw(renderer, &request).image;
            let whole = draw(renderer, &over(request.clone(), json!({"cull": "never"}))).image;
            let pixels = culled.pixels.iter().zip(&whole.pixels);
            let differing = pixels
                .filter(|(a, b)| (0..4).any(|i| a[i].abs_diff(b[i]) > 1))
                .count();
            let allowed = culled.pixels.len() / 1000;
            assert!(differing <= allowed, "{name}, {of}: {differing} pixels");
        }
    }
}

#[test]
fn the_comparison_refuses_what_is_not_alike() {
    let accepted = Image::from_bytes([20, 50], &[100; 4000]);
    let with = |count: usize, value: u8| {
        let mut image = accepted.clone();
        let pixels = image.pixels.iter_mut().take(count);
        pixels.for_each(|pixel| pixel[1] = value);
        image
    };
    let check = |found: &Image| matches(&accepted, found, ALIKE);
    assert_eq!(check(&accepted), Ok(()));
    assert_eq!(check(&with(1000, 101)), Ok(()), "rounding everywhere");
    assert_eq!(check(&with(16, 240)), Ok(()), "an edge or two");
    let off = |differing, color| {
        let worst = (0, 0, [100; 4], [100, color, 100, 100]);
        Err(Mismatch::Channels {
            differing,
            allowed: 16,
            worst,
        })
    };
    assert_eq!(check(&with(1, 241)), off(1, 241), "one pixel too far off");
    assert_eq!(check(&with(17, 102)), off(17, 102), "too many channels");
    let sideways = Image {
        width: 50,
        height: 20,
        ..accepted.clone()
    };
    let (wanted, found) = ([20, 50], [50, 20]);
    assert_eq!(check(&sideways), Err(Mismatch::Size { wanted, found }));
    assert!(!is_on_an_edge(&accepted, 5, 5) && is_on_an_edge(&with(3, 160), 3, 0));
}

#[test]
fn a_figure_that_moved_a_little_is_not_the_same() {
    let Some(renderers) = RENDERERS.as_ref() else {
        return;
    };
    let wgpu = draw(&renderers[1], &base(json!({}))).image;
    for change in [
        json!({"pose": {"base": "rest", "dofs": {"pelvis.tx": 0.005}}}),
        json!({"samples": 1}),
        json!({"material": {"specular": [0.26, 0.22, 0.22], "shininess": 40}}),
        json!({"show": {"normals": "flat"}}),
    ] {
        let own = draw(&renderers[0], &over(base(json!({})), change.clone())).image;
        assert!(matches(&wgpu, &own, ALIKE).is_err(), "{change}");
    }
    // Both know what they draw with.
    let is_own = renderers
        .each_ref()
        .map(|renderer| ask_ok(renderer, "server.info", json!({}))["adapter"]["type"] == "cpu");
    assert_eq!(is_own, [true, false]);
}
