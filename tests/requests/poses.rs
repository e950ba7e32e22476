//! Poses: where joints are, in which steps a pose is built up, limits, and what is stored.

use crate::support::ask_ok;
use crate::{F64, SERVICE, assert_near, load, numbers, world_from_joint};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

#[test]
fn joints_are_where_they_are_computed_to_be() {
    load(&SERVICE, "computed");
    let transforms = ask_ok(&SERVICE, "joint.transforms", json!({"rig": "computed"}));
    let names: Vec<_> = [0, 1]
        .map(|joint| {
            let joint = &transforms["joints"][joint];
            (joint["name"].clone(), joint["parent"].clone())
        })
        .to_vec();
    assert_eq!(
        names,
        [(json!("root"), Value::Null), (json!("tip"), json!("root"))]
    );
    let quarter = FRAC_PI_2;
    // Columns of Rz(90°): x goes to y, and y to -x.
    let turned_z = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    // Columns of Rz(90°)·Rx(90°): x to y, y to z, z to x. The other order would take x to z.
    let turned_zx = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    // Columns of Rz(90°)·Ry(90°): x to -z, y to -x, z to y.
    let turned_zy = [0.0, 0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let at = |turned: [f64; 12], origin: [f64; 3]| [turned.as_slice(), &origin, &[1.0]].concat();
    let (sin, cos) = 0.25f64.sin_cos();
    let rest_tip = [cos, sin, 0.0, 0.0, -sin, cos, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for (what, joint, dofs, wanted) in [
        (
            "the tip at rest",
            1,
            json!({}),
            at(rest_tip, [1.0, 3.0, 3.0]),
        ),
        (
            "the root moved",
            0,
            json!({"root.tx": 10, "root.rz": quarter}),
            at(turned_z, [11.0, 2.0, 3.0]),
        ),
        (
            "the tip carried along",
            1,
            json!({"root.tx": 10, "root.rz": quarter, "tip.rz": 0}),
            at(turned_z, [10.0, 2.0, 3.0]),
        ),
        (
            "the tip turned after the root",
            1,
            json!({"root.rz": quarter, "tip.rx": quarter, "tip.rz": 0}),
            at(turned_zx, [0.0, 2.0, 3.0]),
        ),
        (
            "x before z",
            0,
            json!({"root.rx": quarter, "root.rz": quarter}),
            at(turned_zx, [1.0, 2.0, 3.0]),
        ),
        (
            "y before z",
            0,
            json!({"root.ry": quarter, "root.rz": quarter}),
            at(turned_zy, [1.0, 2.0, 3.0]),
        ),
    ] {
        let found = world_from_joint("computed", joint, json!({ "dofs": dofs }));
        assert_near(&found, &wanted, F64, what);
    }
}

#[test]
fn a_pose_is_built_up_in_the_promised_steps() {
    load(&SERVICE, "steps");
    let half = FRAC_1_SQRT_2;
    let about_z = json!([0, 0, half, half]);
    let by = |pose: Value| world_from_joint("steps", 0, pose);
    let by_angle = by(json!({"dofs": {"root.rz": FRAC_PI_2}}));
    assert_near(
        &by(json!({"rotations": {"root": about_z}})),
        &by_angle,
        F64,
        "a quaternion is an angle",
    );
    let opposite = json!([0, 0, -half, -half]);
    assert_near(
        &by(json!({"rotations": {"root": opposite}})),
        &by_angle,
        F64,
        "and so is its opposite",
    );
    let nearly = json!([0, 0, half * 1.004, half * 1.004]);
    assert_near(
        &by(json!({"rotations": {"root": nearly}})),
        &by_angle,
        F64,
        "length is evened out",
    );
    // Angles come after quaternions, and leave the other axes as the quaternion had them.
    let mixed = by(json!({"rotations": {"root": about_z}, "dofs": {"root.rx": FRAC_PI_2}}));
    let angles = by(json!({"dofs": {"root.rz": FRAC_PI_2, "root.rx": FRAC_PI_2}}));
    assert_near(&mixed, &angles, 1e-12, "angles are laid over a quaternion");
    // Every value at once, in the order of the description.
    let all = by(json!({"dof_values": [10, 0, 0, 0, 0, FRAC_PI_2, 0, 0, 0]}));
    assert_near(&all[..12], &by_angle[..12], F64, "values in order");
    assert_eq!(all[12], 11.0);

    // The stored pose is what others start from, where they give the name.
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "steps", "pose": {"dofs": {"root.tx": 5}}}),
    );
    assert_eq!(by(json!({}))[12], 6.0);
    assert_eq!(by(json!({"base": "rest"}))[12], 1.0);
    assert_eq!(by(json!({"dofs": {"root.ty": 1}}))[12..15], [6.0, 3.0, 3.0]);
    // And so does the next change of the stored pose itself.
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "steps", "pose": {"dofs": {"root.ty": 1}}}),
    );
    assert_eq!(by(json!({}))[12..15], [6.0, 3.0, 3.0]);
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "steps", "pose": {"base": "rest", "dofs": {"root.tz": 1}}}),
    );
    assert_eq!(by(json!({}))[12..15], [1.0, 2.0, 4.0]);
}

#[test]
fn clamping_is_reported_in_every_reply_to_a_pose() {
    load(&SERVICE, "clamped");
    let limit = FRAC_PI_2;
    let wanted = json!([{"dof": "tip.rx", "asked": 2.0, "used": limit}]);
    let too_far = json!({"dofs": {"tip.rx": 2, "tip.ry": 2}});
    for method in [
        "joint.transforms",
        "mesh.vertices",
        "frame.render",
        "pose.set",
    ] {
        let reply = ask_ok(&SERVICE, method, json!({"rig": "clamped", "pose": too_far}));
        assert_eq!(reply["clamped"], wanted, "{method}");
    }
    let dofs = || ask_ok(&SERVICE, "pose.get", json!({"rig": "clamped"}))["dofs"].take();
    assert_eq!(dofs()["tip.rx"], json!(limit));
    // What is stored is inside, so it is not reported again.
    let reply = ask_ok(&SERVICE, "joint.transforms", json!({"rig": "clamped"}));
    assert_eq!(reply["clamped"], json!([]));

    let mut ignoring = too_far.clone();
    ignoring["limits"] = json!("ignore");
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": ignoring}),
    );
    assert_eq!(reply["clamped"], json!([]));
    assert_eq!(dofs()["tip.rx"], 2.0);
    ask_ok(&SERVICE, "pose.reset", json!({"rig": "clamped"}));
    assert_eq!(dofs()["tip.rx"], 0.0);
    assert_eq!(dofs()["tip.rz"], 0.25, "the file's own value, and not zero");

    // A quaternion that is past a limit in both its triples of angles comes back as the angle that was used.
    let turn = |angle: f64| json!({"rotations": {"tip": [(angle / 2.0).sin(), 0.0, 0.0, (angle / 2.0).cos()]}});
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": turn(1.7)}),
    );
    let clamped = &reply["clamped"][0];
    assert_eq!(
        (&clamped["dof"], &clamped["used"]),
        (&json!("tip.rx"), &json!(limit))
    );
    assert_near(
        &[clamped["asked"].as_f64().expect("a number")],
        &[1.7],
        1e-12,
        "as an angle",
    );
    // Half a turn about y and z and 2.5 - π about x is the same, and inside.
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": turn(2.5)}),
    );
    assert_eq!(reply["clamped"], json!([]));
    let reply = ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": "clamped", "pose": turn(1.0)}),
    );
    assert_eq!(reply["clamped"], json!([]));
    let stored = ask_ok(&SERVICE, "pose.get", json!({"rig": "clamped"}));
    let tip = &stored["joints"]["tip"];
    let rotation = turn(1.0)["rotations"]["tip"].take();
    assert_near(
        &numbers(&tip["rotation"]),
        &numbers(&rotation),
        F64,
        "the quaternion itself",
    );
    assert_eq!(tip["translation"], json!([0.0, 1.0, 0.0]));
    assert_eq!(tip["scale"], json!([1.0, 1.0, 1.0]));
    assert_near(
        &[stored["dofs"]["tip.rx"].as_f64().expect("a number")],
        &[1.0],
        1e-12,
        "and its angle",
    );
}

#[test]
fn an_inline_pose_changes_nothing_that_is_stored() {
    load(&SERVICE, "untouched");
    let stored = || ask_ok(&SERVICE, "pose.get", json!({"rig": "untouched"}));
    let before = stored();
    let pose = json!({"dofs": {"root.tx": 3, "tip.rx": 1}, "rotations": {"root": [0, 1, 0, 0]}});
    for method in ["joint.transforms", "mesh.vertices", "frame.render"] {
        ask_ok(&SERVICE, method, json!({"rig": "untouched", "pose": pose}));
        assert_eq!(stored(), before, "{method}");
    }
}
