//! Poses of several clips at once.

use crate::support::ask_kind;
use crate::support::gltf::Gltf;
use crate::{
    NEAR, SERVICE, assert_near, joint, linear_part, load, rotation_columns, triangle, turn_z,
};
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Clips `a` and `b`, each standing still: `a` at x = 2 without rotation, `b` at y = 4 and a quarter about z.
fn two_clips() -> Gltf {
    let mut gltf = triangle();
    for (clip, place, turn) in [
        ("a", [2.0, 0.0, 0.0], turn_z(0.0)),
        ("b", [0.0, 4.0, 0.0], turn_z(FRAC_PI_2)),
    ] {
        let input = gltf.floats("SCALAR", &[0.0]);
        let (places, turns) = (gltf.floats("VEC3", &place), gltf.floats("VEC4", &turn));
        for (path, output) in [("translation", places), ("rotation", turns)] {
            gltf.channel(
                clip,
                json!({"node": 0, "path": path}),
                json!({"input": input, "output": output}),
            );
        }
    }
    gltf
}

#[test]
fn clips_are_blended_by_their_weights() {
    load("blended", &two_clips());
    let part = |name: &str, weight: f64| json!({"name": name, "time": 0, "weight": weight});
    for (clips, wanted, angle) in [
        (json!([part("a", 1.0)]), [2.0, 0.0], 0.0),
        (
            json!([part("a", 0.5), part("b", 0.5)]),
            [1.0, 2.0],
            FRAC_PI_4,
        ),
        // The base pose, at the origin without rotation, makes up the rest.
        (json!([part("b", 0.5)]), [0.0, 2.0], FRAC_PI_4),
        (json!([part("a", 0.25), part("b", 0.0)]), [0.5, 0.0], 0.0),
        (json!([]), [0.0, 0.0], 0.0),
        // More than all is all.
        (json!([part("b", 3.0)]), [0.0, 4.0], FRAC_PI_2),
        (
            json!([part("a", 2.0), part("b", 2.0)]),
            [1.0, 2.0],
            FRAC_PI_4,
        ),
    ] {
        let found = joint("blended", "stand", json!({ "clips": clips }));
        let what = clips.to_string();
        assert_near(&found[12..15], &[wanted[0], wanted[1], 0.0], NEAR, &what);
        assert_near(
            &linear_part(&found),
            &rotation_columns(turn_z(angle)),
            NEAR,
            &what,
        );
    }
    // Of translations this holds for uneven weights as well.
    let uneven = joint(
        "blended",
        "stand",
        json!({"clips": [part("a", 3.0), part("b", 1.0)]}),
    );
    assert_near(&uneven[12..15], &[1.5, 1.0, 0.0], NEAR, "uneven");
}

#[test]
fn blends_that_make_no_sense_are_refused() {
    load("refused", &two_clips());
    let part = |weight: f64| json!({"name": "a", "time": 0, "weight": weight});
    for pose in [
        json!({"clip": {"name": "a", "time": 0}, "clips": [part(1.0)]}),
        json!({"clips": [part(-1.0)]}),
        json!({"clips": [{"name": "nobody", "time": 0, "weight": 1}]}),
        json!({"clips": [{"name": "a", "weight": 1}]}),
        json!({"clips": {}}),
    ] {
        let params = json!({"rig": "refused", "pose": pose});
        assert_eq!(
            ask_kind(&SERVICE, "joint.transforms", params),
            "invalid_params",
            "{pose}"
        );
    }
}
