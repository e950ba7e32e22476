//! Does a pick hit what the picture shows at that pixel? Hits are held against vertices, cameras and pixels of the same requests.

mod support;

use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};
use support::pictures::{Drawn, draw, over};
use support::random::Random;
use support::{ask, ask_kind, ask_ok};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

const SIDE: u32 = 96;

/// The figure in a pose that is no one's rest, against nothing.
fn request(changes: Value) -> Value {
    let request = json!({
        "rig": "figure", "size": [SIDE, SIDE], "samples": 1, "background": [0, 0, 0, 0],
        "pose": {"dofs": {"upper_arm_l.rz": 0.9, "head.ry": 0.5, "thigh_r.rx": -0.8, "shin_r.rx": 1.1}},
    });
    over(request, changes)
}

fn picked(request: &Value, pixel: [f64; 2], changes: Value) -> Value {
    let params = over(request.clone(), json!({"pixel": pixel}));
    ask_ok(&SERVICE, "scene.pick", over(params, changes))
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let numbers: Vec<f64> = serde_json::from_value(value.clone()).expect("a list of numbers");
    numbers.try_into().expect("as many as wanted")
}

fn cameras() -> [(&'static str, Value); 4] {
    let pinhole = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.1, 0.9, 3.0, 1.0,
    ];
    [
        (
            "orbit",
            json!({"kind": "orbit", "azimuth": 0.4, "distance": 3}),
        ),
        (
            "look_at",
            json!({"kind": "look_at", "eye": [1, 2, 2], "target": [0, 0.9, 0]}),
        ),
        (
            "orthographic",
            json!({"kind": "look_at", "eye": [1, 2, 2], "target": [0, 0.9, 0], "height": 2}),
        ),
        (
            "pinhole",
            json!({"kind": "pinhole", "fx": 130, "fy": 125, "cx": 50, "cy": 45, "world_from_camera": pinhole}),
        ),
    ]
}

/// Skinned positions of the request's pose.
fn positions(request: &Value) -> Vec<[f64; 3]> {
    let params =
        json!({"rig": request["rig"], "pose": request["pose"], "attributes": ["positions"]});
    let vertices = ask_ok(&SERVICE, "mesh.vertices", params);
    let flat: Vec<f64> = serde_json::from_value(vertices["meshes"][0]["positions"]["data"].clone())
        .expect("numbers");
    flat.as_chunks::<3>().0.to_vec()
}

fn triangles(rig: &str) -> Vec<[usize; 3]> {
    let topology = ask_ok(&SERVICE, "mesh.topology", json!({"rig": rig}));
    let flat: Vec<usize> =
        serde_json::from_value(topology["meshes"][0]["triangles"]["data"].clone())
            .expect("indices");
    flat.as_chunks::<3>().0.to_vec()
}

fn pixel_of(drawn: &Drawn, camera: &str, point: [f64; 3]) -> [f64; 2] {
    drawn.pixel_by_intrinsics(point, camera == "orthographic")
}

#[test]
fn a_hit_of_the_skin_lies_on_its_triangle_and_projects_back_onto_its_pixel() {
    let corners_of = triangles("figure");
    let mut random = Random(7);
    for (name, camera) in cameras() {
        let request = request(json!({"camera": camera}));
        let drawn = draw(&SERVICE, &request);
        let at = positions(&request);
        let mut hits = 0;
        for _ in 0..150 {
            let pixel =
                [0; 2].map(|_| f64::from(SIDE) / 2.0 + random.within(f64::from(SIDE) / 2.0));
            let found = picked(&request, pixel, json!({"targets": ["skin"]}));
            let hit = &found["hit"];
            if hit.is_null() {
                continue;
            }
            hits += 1;
            let position: [f64; 3] = numbers(&hit["position"]);
            let [x, y] = pixel_of(&drawn, name, position);
            assert!(
                (x - pixel[0]).hypot(y - pixel[1]) < 1e-3,
                "{name}: {pixel:?} became {x}, {y}"
            );

            let triangle = hit["triangle"].as_u64().expect("an index") as usize;
            let shares: [f64; 3] = numbers(&hit["barycentric"]);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let [origin, direction] =
                ["origin", "direction"].map(|field| numbers::<3>(&found["ray"][field]));
            let distance = hit["distance"].as_f64().expect("a number");
            let mut toward = 0.0;
            let normal: [f64; 3] = numbers(&hit["normal"]);
            for axis in 0..3 {
                let corner = |i: usize| shares[i] * at[corners_of[triangle][i]][axis];
                let on_triangle: f64 = (0..3).map(corner).sum();
                assert!(
                    (on_triangle - position[axis]).abs() < 1e-5,
                    "{name}: triangle {triangle}"
                );
                let on_ray = origin[axis] + distance * direction[axis];
                assert!((on_ray - position[axis]).abs() < 1e-9);
                toward += normal[axis] * direction[axis];
            }
            // An interpolated normal may lean away from the eye at a silhouette, though not far.
            assert!(toward < 0.4, "{name}: {toward}");
        }
        assert!(hits > 8, "{name}: only {hits} hits");
    }
}

#[test]
fn a_pixel_is_hit_where_the_picture_shows_something() {
    for (name, camera) in cameras() {
        for skin in ["posed", "bind"] {
            let request = request(json!({"camera": camera, "show": {"skin": skin}}));
            let image = draw(&SERVICE, &request).image;
            let (mut shown, mut differing) = (0, 0);
            for (x, y, pixel) in image.iter().filter(|(x, y, _)| x % 3 == 0 && y % 3 == 0) {
                let middle = [x as f64 + 0.5, y as f64 + 0.5];
                let is_hit =
                    !picked(&request, middle, json!({"targets": ["skin"]}))["hit"].is_null();
                shown += usize::from(pixel[3] > 0);
                differing += usize::from(is_hit != (pixel[3] > 0));
            }
            // Where an outline passes a middle within a 256th of a pixel, either answer is right.
            assert!(
                shown > 50 && differing <= 2,
                "{name}, {skin}: {differing} of {shown}"
            );
        }
    }
}

#[test]
fn bones_are_hit_where_they_are_drawn() {
    for (name, camera) in cameras() {
        let request =
            request(json!({"camera": camera, "show": {"skin": "none", "skeleton": "cylinders"}}));
        let image = draw(&SERVICE, &request).image;
        let (mut shown, mut missed, mut beside) = (0, 0, 0);
        for (x, y, pixel) in image.iter() {
            let middle = [x as f64 + 0.5, y as f64 + 0.5];
            let hit = picked(&request, middle, json!({}))["hit"].clone();
            if pixel[3] > 0 {
                // What is drawn has six sides, and fits into the round one that is picked.
                shown += 1;
                missed += usize::from(hit["kind"] != "bone");
            } else {
                beside += usize::from(!hit.is_null());
            }
        }
        assert!(
            shown > 100 && missed <= 2,
            "{name}: {missed} of {shown} missed"
        );
        // By which a circle is wider than a hexagon in it.
        assert!(beside < shown / 2, "{name}: {beside} hits beside {shown}");
    }
}

#[test]
fn a_bone_is_named_by_its_joint_and_by_how_far_along_it_was_hit() {
    let files = json!([{"name": "arm.skel", "text": "balljoint shoulder { balljoint elbow { offset 4 0 0 balljoint wrist { offset 0 2 0 } } }"}]);
    ask_ok(&SERVICE, "rig.load", json!({"name": "arm", "files": files}));
    // Ten pixels a unit, the world's origin in the middle.
    let request = json!({"rig": "arm", "size": [100, 100],
        "camera": {"kind": "look_at", "eye": [0, 0, 50], "target": [0, 0, 0], "height": 10}});
    for (pixel, joint, along) in [
        ([60.0, 50.0], "shoulder", 0.25),
        ([80.0, 50.0], "shoulder", 0.75),
        ([90.0, 35.0], "elbow", 0.75),
    ] {
        let hit = picked(&request, pixel, json!({"bone_radius": 0.25}))["hit"].clone();
        assert_eq!(
            (&hit["kind"], &hit["joint"]),
            (&json!("bone"), &json!(joint)),
            "{hit}"
        );
        assert!(
            (hit["along"].as_f64().expect("a number") - along).abs() < 1e-9,
            "{hit}"
        );
        assert!(
            (hit["distance"].as_f64().expect("a number") - 49.75).abs() < 1e-9,
            "{hit}"
        );
        assert!(hit.get("mesh").is_none() && hit.get("triangle").is_none());
    }
    // Three tenths of a unit off the bone.
    let beside = [60.0, 47.0];
    assert!(picked(&request, beside, json!({"bone_radius": 0.25}))["hit"].is_null());
    assert_eq!(
        picked(&request, beside, json!({"bone_radius": 0.35}))["hit"]["joint"],
        "shoulder"
    );
    assert!(picked(&request, [60.0, 50.0], json!({"targets": ["skin"]}))["hit"].is_null());
}

#[test]
fn the_joint_of_the_skin_is_the_one_that_weighs_most() {
    let request = request(json!({}));
    let drawn = draw(&SERVICE, &request);
    let transforms = ask_ok(
        &SERVICE,
        "joint.transforms",
        json!({"rig": "figure", "pose": request["pose"]}),
    );
    let joints = transforms["joints"].as_array().expect("joints");
    let origin = |joint: &str| {
        let found = joints.iter().find(|it| it["name"] == joint);
        let matrix: [f64; 16] = numbers(&found.expect("the joint")["world_from_joint"]);
        [matrix[12], matrix[13], matrix[14]]
    };
    for (joint, child) in [
        ("forearm_l", "hand_l"),
        ("shin_r", "foot_r"),
        ("thigh_l", "shin_l"),
    ] {
        // Half way along the bone.
        let (from, to) = (origin(joint), origin(child));
        let point = [0, 1, 2].map(|i| (from[i] + to[i]) / 2.0);
        let pixel = drawn.pixel_by_clip(point);
        let hit = picked(&request, pixel, json!({"targets": ["skin"]}))["hit"].clone();
        assert_eq!(hit["joint"], joint, "{hit}");
    }
}

#[test]
fn what_is_not_shown_is_not_hit_but_bones_always_can_be() {
    let middle = [f64::from(SIDE) / 2.0; 2];
    let hidden = request(json!({"show": {"skin": "none"}}));
    assert_ne!(picked(&hidden, middle, json!({}))["hit"]["kind"], "skin");
    assert!(picked(&hidden, middle, json!({"targets": ["skin"]}))["hit"].is_null());
    let shown = request(json!({}));
    let [skin, bone] = ["skin", "bone"].map(|target| {
        picked(
            &shown,
            middle,
            json!({"targets": [target], "bone_radius": 0.05}),
        )
    });
    let distance = |picked: &Value| picked["hit"]["distance"].as_f64().expect("a hit");
    assert!(distance(&skin) < distance(&bone), "the bone is inside");
    assert_eq!(
        picked(&shown, middle, json!({"bone_radius": 0.05}))["hit"]["kind"],
        "skin"
    );
    // A bone thicker than the body comes first.
    assert_eq!(
        picked(&shown, middle, json!({"bone_radius": 0.5}))["hit"]["kind"],
        "bone"
    );
}

#[test]
fn a_pick_that_makes_no_sense_is_refused_by_field() {
    for (changes, path) in [
        (json!({"pixel": [-1, 5]}), "pixel"),
        (json!({"pixel": [5, 97]}), "pixel"),
        (json!({"pixel": [5]}), "pixel"),
        (json!({"pixel": ["a", 5]}), "pixel[0]"),
        (json!({"bone_radius": 0}), "bone_radius"),
        (json!({"bone_radius": -1}), "bone_radius"),
        (json!({"targets": ["hair"]}), "targets[0]"),
        (json!({"pixels": [1, 2]}), "pixels"),
        (
            json!({"camera": {"kind": "orbit", "distance": -1}}),
            "camera.distance",
        ),
    ] {
        let params = over(request(json!({"pixel": [5, 5]})), changes);
        let error = ask(&SERVICE, "scene.pick", params).expect_err("it makes no sense");
        assert_eq!(error.detail("path"), Some(&json!(path)), "{error}");
    }
    let missing = request(json!({}));
    assert_eq!(ask_kind(&SERVICE, "scene.pick", missing), "invalid_params");
    let nobody = json!({"rig": "nobody", "pixel": [1, 1]});
    assert_eq!(ask_kind(&SERVICE, "scene.pick", nobody), "rig_not_loaded");
}
