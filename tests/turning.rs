//! Does turning a bone do what a hand on it would? `pose.rotate`, `pose.roll`, and rotations that never pass through angles.

mod support;

use glam::{DMat3, DMat4, DQuat, DVec3};
use rigd::service::Service;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::{Arc, LazyLock};
use support::pictures::over;
use support::{ask, ask_kind, ask_ok, case};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// ```text
/// hip - knee - foot     and `twin`, which stands where the knee does
/// ```
/// The knee is a hinge about z that opens to 2 radians.
const LEG: &str = "balljoint hip { offset 1 2 3 pose 0.3 -0.4 0.5
    balljoint knee { offset 0 -2 0 rotxlimit 0 0 rotylimit 0 0 rotzlimit 0 2 pose 0 0 0.25
        balljoint foot { offset 0.5 -1.5 0.25 }
        balljoint twin { } } }";

/// Each test has a leg of its own: the stored pose is what they change.
fn leg(name: &str) -> &str {
    let files = json!([{"name": format!("{name}.skel"), "text": LEG}]);
    ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}));
    name
}

fn turn(method: &str, rig: &str, changes: Value) -> Value {
    ask_ok(&SERVICE, method, over(json!({"rig": rig}), changes))
}

fn rotate(rig: &str, changes: Value) -> Value {
    turn("pose.rotate", rig, changes)
}

fn world_from_joint(rig: &str) -> Vec<DMat4> {
    let transforms = ask_ok(&SERVICE, "joint.transforms", json!({"rig": rig}));
    let joints = transforms["joints"].as_array().expect("joints").clone();
    let matrix = |joint: Value| {
        let numbers = serde_json::from_value(joint["world_from_joint"].clone());
        DMat4::from_cols_array(&numbers.expect("16 numbers"))
    };
    joints.into_iter().map(matrix).collect()
}

fn local_rotation(rig: &str, joint: &str) -> DQuat {
    let pose = ask_ok(&SERVICE, "pose.get", json!({"rig": rig}));
    let numbers = serde_json::from_value(pose["joints"][joint]["rotation"].clone());
    DQuat::from_array(numbers.expect("4 numbers"))
}

/// Exact to what a hundred products in f64 lose, and numbers printed in full keep.
fn assert_same(found: DMat4, wanted: DMat4, what: &str) {
    assert!(found.abs_diff_eq(wanted, 1e-9), "{what}: {found} {wanted}");
}

#[test]
fn a_turn_in_world_space_moves_the_joint_and_all_below_it_about_its_origin() {
    let rig = leg("turned_in_world");
    let before = world_from_joint(rig);
    let axis = DVec3::new(1.0, -2.0, 0.5);
    rotate(
        rig,
        json!({"joint": "hip", "axis": [1, -2, 0.5], "angle": 0.7, "space": "world"}),
    );
    let turned = DMat4::from_axis_angle(axis.normalize_or(DVec3::X), 0.7);
    let hip = DMat4::from_translation(before[0].w_axis.truncate());
    let about_hip = hip * turned * hip.inverse();
    for (joint, (before, after)) in before.iter().zip(world_from_joint(rig)).enumerate() {
        assert_same(after, about_hip * *before, &format!("joint {joint}"));
    }
}

#[test]
fn a_turn_in_the_joints_own_space_comes_before_its_rotation() {
    let rig = leg("turned_in_itself");
    let before = world_from_joint(rig);
    // The space that is taken where none is named.
    rotate(
        rig,
        json!({"joint": "foot", "axis": [0, 3, 0], "angle": -0.4}),
    );
    let after = world_from_joint(rig);
    assert_same(
        after[2],
        before[2] * DMat4::from_rotation_y(-0.4),
        "the foot",
    );
    for other in [0, 1, 3] {
        assert_same(after[other], before[other], "a joint that is not below it");
    }
}

#[test]
fn a_roll_turns_about_the_bone_and_leaves_its_end_where_it_is() {
    let rig = leg("roll");
    let before = world_from_joint(rig);
    turn("pose.roll", rig, json!({"joint": "hip", "angle": 1.1}));
    let after = world_from_joint(rig);
    // The knee stays, the foot goes around it.
    assert!(after[1].w_axis.abs_diff_eq(before[1].w_axis, 1e-9));
    assert!(after[2].w_axis.distance(before[2].w_axis) > 0.1);
    let along = (before[1].w_axis - before[0].w_axis)
        .truncate()
        .normalize_or(DVec3::X);
    let turned = DMat3::from_mat4(after[0]) * DMat3::from_mat4(before[0]).inverse();
    let wanted = DMat3::from_axis_angle(along, 1.1);
    assert!(turned.abs_diff_eq(wanted, 1e-9), "{turned}");
    // A joint without children at a distance goes on along the line from its parent.
    turn("pose.roll", rig, json!({"joint": "foot", "angle": 0.3}));
    let again = world_from_joint(rig);
    let along = (after[2].w_axis - after[1].w_axis)
        .truncate()
        .normalize_or(DVec3::X);
    let turned = DMat3::from_mat4(again[2]) * DMat3::from_mat4(after[2]).inverse();
    assert!(turned.abs_diff_eq(DMat3::from_axis_angle(along, 0.3), 1e-9));
}

#[test]
fn a_full_turn_in_360_steps_comes_back_to_the_start() {
    for space in ["world", "joint"] {
        let name = format!("around_in_{space}");
        let rig = leg(&name);
        let before = world_from_joint(rig);
        let step = TAU / 360.0;
        for count in 1..=360 {
            let axis = json!([0.2, 1, -0.7]);
            rotate(
                rig,
                json!({"joint": "hip", "axis": axis, "angle": step, "space": space}),
            );
            let is_far = !world_from_joint(rig)[2].abs_diff_eq(before[2], 0.1);
            assert!(
                is_far || !(10..=350).contains(&count),
                "{space}: step {count}"
            );
        }
        for (joint, (before, after)) in before.iter().zip(world_from_joint(rig)).enumerate() {
            assert!(after.abs_diff_eq(*before, 1e-4), "{space}, joint {joint}");
        }
        let half = ask_ok(&SERVICE, "pose.get", json!({"rig": rig}))["dofs"]["hip.rx"].clone();
        assert!(
            (half.as_f64().expect("a number") - 0.3).abs() < 1e-4,
            "{half}"
        );
    }
}

#[test]
fn what_was_turned_reads_back_as_quaternion_and_as_angles_of_the_same_rotation() {
    let rig = leg("read_back");
    rotate(
        rig,
        json!({"joint": "hip", "axis": [1, 1, 0], "angle": 2.0, "space": "world"}),
    );
    let pose = ask_ok(&SERVICE, "pose.get", json!({"rig": rig}));
    let angle = |axis: &str| {
        pose["dofs"][format!("hip.{axis}")]
            .as_f64()
            .expect("a number")
    };
    let by_angles = DQuat::from_rotation_z(angle("rz"))
        * DQuat::from_rotation_y(angle("ry"))
        * DQuat::from_rotation_x(angle("rx"));
    let quaternion = local_rotation(rig, "hip");
    assert!(by_angles.angle_between(quaternion) < 1e-6);
    // Setting what was read back changes nothing.
    let before = world_from_joint(rig);
    let dofs = pose["dofs"].clone();
    ask_ok(
        &SERVICE,
        "pose.set",
        json!({"rig": rig, "pose": {"dofs": dofs}}),
    );
    for (before, after) in before.iter().zip(world_from_joint(rig)) {
        assert!(after.abs_diff_eq(*before, 1e-6));
    }
}

#[test]
fn limits_hold_and_are_reported() {
    let rig = leg("limits");
    let result = rotate(
        rig,
        json!({"joint": "knee", "axis": [0, 0, 1], "angle": 3.0}),
    );
    let clamped = result["clamped"].as_array().expect("a list");
    assert_eq!(clamped.len(), 1, "{clamped:?}");
    assert_eq!(clamped[0]["dof"], "knee.rz");
    let number = |field: &str| clamped[0][field].as_f64().expect("a number");
    assert!((number("asked") - 3.25).abs() < 1e-9 || (number("asked") - (3.25 - TAU)).abs() < 1e-9);
    assert_eq!(number("used"), 2.0);
    assert!(local_rotation(rig, "knee").angle_between(DQuat::from_rotation_z(2.0)) < 1e-6);

    let before = world_from_joint(rig);
    let past =
        json!({"rig": rig, "joint": "knee", "axis": [0, 0, 1], "angle": 0.5, "limits": "reject"});
    let refused = ask(&SERVICE, "pose.rotate", past).expect_err("it is past the limit");
    assert_eq!(refused.detail("path"), Some(&json!("angle")), "{refused}");
    assert_eq!(world_from_joint(rig), before, "nothing half-done stays");

    let free = json!({"joint": "knee", "axis": [0, 0, 1], "angle": 0.5, "limits": "ignore"});
    assert_eq!(rotate(rig, free)["clamped"], json!([]));
    assert!(local_rotation(rig, "knee").angle_between(DQuat::from_rotation_z(2.5)) < 1e-6);
}

#[test]
fn rotations_are_kept_also_where_angles_are_singular() {
    let rig = leg("singular");
    for off in [0.0, 1e-9, 1e-6, -1e-4] {
        for (x, z) in [(0.3, -1.1), (PI, 2.0), (-2.2, 0.0)] {
            let wanted = DQuat::from_rotation_z(z)
                * DQuat::from_rotation_y(FRAC_PI_2 + off)
                * DQuat::from_rotation_x(x);
            let pose = json!({"rotations": {"hip": wanted.to_array()}});
            ask_ok(&SERVICE, "pose.set", json!({"rig": rig, "pose": pose}));
            let found = local_rotation(rig, "hip");
            assert!(found.abs_diff_eq(wanted, 1e-6) || found.abs_diff_eq(-wanted, 1e-6));
            // A small turn on top of it is just that.
            rotate(
                rig,
                json!({"joint": "hip", "axis": [0, 1, 0], "angle": 1e-3}),
            );
            let turned = wanted * DQuat::from_rotation_y(1e-3);
            assert!(local_rotation(rig, "hip").angle_between(turned) < 1e-6);
        }
    }
}

#[test]
fn a_turn_that_makes_no_sense_is_refused_by_field() {
    let rig = leg("refused");
    let base = json!({"rig": rig, "joint": "hip", "axis": [0, 0, 1], "angle": 1.0});
    for (field, value, path) in [
        ("joint", json!("hipp"), "joint"),
        ("axis", json!([0, 0, 0]), "axis"),
        ("axis", json!([0, 1]), "axis"),
        ("angle", json!("much"), "angle"),
        ("space", json!("parent"), "space"),
    ] {
        let mut params = base.clone();
        params[field] = value;
        let error = ask(&SERVICE, "pose.rotate", params).expect_err("it makes no sense");
        assert_eq!(error.detail("path"), Some(&json!(path)), "{error}");
    }
    let unknown = json!({"rig": "nobody", "joint": "hip", "angle": 1.0});
    assert_eq!(ask_kind(&SERVICE, "pose.roll", unknown), "rig_not_loaded");
    let alone = json!([{"name": "dot.skel", "text": "balljoint dot { }"}]);
    ask_ok(&SERVICE, "rig.load", json!({"name": "dot", "files": alone}));
    let error = ask(
        &SERVICE,
        "pose.roll",
        json!({"rig": "dot", "joint": "dot", "angle": 1.0}),
    );
    let error = error.expect_err("there is no bone");
    assert!(error.to_string().contains("no bone"), "{error}");
}

/// A joint limited about one axis alone, whose roll lies within its limits only as the second of its triples of angles.
#[test]
fn a_pose_that_was_read_is_within_limits_and_sets_itself_again() {
    for angle in [-1.8257, 1.8257] {
        let rig = format!("roll by {angle}");
        let files = json!([case("course/roll_get.skel")]);
        ask_ok(&SERVICE, "rig.load", json!({"name": rig, "files": files}));
        let rolled = turn("pose.roll", &rig, json!({"joint": "b", "angle": angle}));
        assert_eq!(rolled["clamped"], json!([]));
        let placed = world_from_joint(&rig);
        let dofs = ask_ok(&SERVICE, "pose.get", json!({"rig": rig}))["dofs"].clone();
        let rx = dofs["b.rx"].as_f64().expect("an angle");
        assert!((-1.0..=1.0).contains(&rx), "{dofs}");
        let set = |pose: Value| ask_ok(&SERVICE, "pose.set", json!({"rig": rig, "pose": pose}));
        assert_eq!(set(json!({ "dofs": dofs }))["clamped"], json!([]));
        for (found, wanted) in world_from_joint(&rig).into_iter().zip(placed) {
            assert_same(found, wanted, &rig);
        }
        // One angle alone, of a rotation that is a quaternion.
        turn("pose.reset", &rig, json!({}));
        turn("pose.roll", &rig, json!({"joint": "b", "angle": angle}));
        assert_eq!(set(json!({"dofs": {"b.ry": 0.25}}))["clamped"], json!([]));
        let wanted = DQuat::from_rotation_y(0.25);
        assert!(local_rotation(&rig, "b").angle_between(wanted) < 1e-7);
    }
}
