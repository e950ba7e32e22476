//! Numbers that other programs have found for real files: what the oracle and the service have to agree with. Never lives here: rigs of the
//! tests' own.

use crate::subject::{LINEAR, SERVICE, Subject, real};
use crate::support::oracle::compare::bounds;
use crate::support::oracle::matrix::{Vector, difference, length, origin};
use crate::support::oracle::{self, AngleOrder, Pose};
use crate::support::{SAMPLE_ANIM, ask_ok};
use serde_json::{Value, json};

/// Half a step of the last decimal, and what float32 adds.
fn half_step(decimals: i32) -> f64 {
    1.1 / 2.0 * 10f64.powi(-decimals)
}

fn assert_printed<const N: usize>(what: &str, found: [f64; N], wanted: [f64; N], decimals: i32) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        let off = (found - wanted).abs();
        assert!(
            off < half_step(decimals),
            "{what}: {found}, wanted {wanted}"
        );
    }
}

fn three(value: &Value) -> Vector {
    serde_json::from_value(value.clone()).expect("three numbers")
}

fn walked(rig: &oracle::Rig, time: f64) -> (Pose, Vec<Vector>) {
    let pose = rig.sampled(&rig.clips[0], time);
    let positions = positions(rig, &pose);
    (pose, positions)
}

fn positions(rig: &oracle::Rig, pose: &Pose) -> Vec<Vector> {
    let skinned = rig.skin(pose, LINEAR);
    skinned.positions.into_iter().flatten().collect()
}

type Vertices = &'static [(usize, Vector)];

/// Joint, column of its matrix (0 is the x axis, 3 the origin) and what stands there at rest.
const JOINTS: [(&str, &str, usize, Vector); 7] = [
    ("test.skel", "knee_r", 3, [0.0995, -0.6, -0.009983]),
    ("wasp.skel", "knee_01_r", 3, [0.496202, -0.028606, 0.593412]),
    ("wasp.skel", "knee_01_r", 0, [0.492404, 0.642788, 0.586824]),
    ("wasp.skel", "wing_01_l", 0, [0.821394, -0.387628, 0.418398]),
    ("wasp.skel", "tail_04", 3, [0.0, -0.3, 1.5]),
    ("horse.skel", "head", 3, [0.0, 0.616839, 0.513019]),
    ("tree.skel", "branch_2_4", 3, [-2.120476, 5.122165, 0.0]),
];

#[test]
fn joints_at_rest_agree_with_numbers_from_another_program() {
    for (skel, joint, column, wanted) in JOINTS {
        let Some(subject) = Subject::real(&[&format!("cse169/{skel}")]) else {
            return;
        };
        let result = ask_ok(&SERVICE, "joint.transforms", json!({"rig": subject.name}));
        let joints = result["joints"].as_array().expect("joints");
        let found = joints.iter().find(|it| it["name"] == joint).expect(joint);
        let matrix = found["world_from_joint"].as_array().expect("a matrix");
        let found = three(&json!(matrix[4 * column..4 * column + 3]));
        let what = format!("{joint} of {skel}");
        assert_printed(&what, found, wanted, 6);

        let index = subject.oracle.joints.iter().position(|it| it.name == joint);
        let matrix = subject.oracle.world_from_joint(&subject.oracle.rest())[index.expect(joint)];
        let found = [0, 1, 2].map(|row| matrix[row][column]);
        assert_printed(&what, found, wanted, 6);
    }
}

#[test]
fn vertices_at_rest_agree_with_numbers_from_another_program() {
    let tube: Vertices = &[(0, [0.47477, -0.186, 0.0]), (239, [0.087, 0.5, -0.05])];
    let wasp: Vertices = &[(0, [0.12623, -0.21983, -0.77655])];
    for (name, vertices, min, max) in [
        ("tube", tube, [-0.14161, -0.3543, -0.1], [0.47477, 0.5, 0.1]),
        (
            "wasp",
            wasp,
            [-1.14926, -0.96239, -0.84758],
            [1.1497, 0.61106, 2.00612],
        ),
    ] {
        let file = |ending: &str| format!("cse169/{name}.{ending}");
        let Some(subject) = Subject::real(&[&file("skel"), &file("skin")]) else {
            return;
        };
        let result = ask_ok(&SERVICE, "mesh.vertices", json!({"rig": subject.name}));
        let found = result["meshes"][0]["positions"]["data"].as_array();
        let found = found.expect("numbers");
        let by_oracle = positions(&subject.oracle, &subject.oracle.rest());
        for &(vertex, wanted) in vertices {
            let what = format!("vertex {vertex} of {name}");
            let found = three(&json!(found[3 * vertex..3 * vertex + 3]));
            assert_printed(&what, found, wanted, 5);
            assert_printed(&what, by_oracle[vertex], wanted, 5);
        }
        let found = ["min", "max"].map(|corner| three(&result["bounds"][corner]));
        for [found_min, found_max] in [found, bounds(by_oracle.into_iter())] {
            assert_printed(&format!("bounds of {name}"), found_min, min, 5);
            assert_printed(&format!("bounds of {name}"), found_max, max, 5);
        }
    }
}

#[test]
fn the_oracle_evaluates_every_tangent_and_extrapolation_as_another_program() {
    let Some(made) = real(&["cse169/sample.anim"]) else {
        return;
    };
    let rig = made.oracle();
    let channels = &rig.clips[0].channels;
    for (time, wanted) in SAMPLE_ANIM {
        let found = [0, 1, 2].map(|channel: usize| channels[channel].at(time));
        assert_printed(&format!("sample.anim at {time}"), found, wanted, 6);
    }
}

const WALKING: [&str; 3] = [
    "cse169/wasp_walk/wasp.skel",
    "cse169/wasp_walk/wasp.skin",
    "cse169/wasp_walk/wasp_walk.anim",
];

#[test]
fn the_oracle_lets_the_wasp_walk_as_another_program() {
    let Some(made) = real(&WALKING) else {
        return;
    };
    let rig = made.oracle();
    for (time, z) in [
        (-0.5, 0.675),
        (0.0, 0.45),
        (0.7, 0.135),
        (1.3, -0.135),
        (3.0, -0.9),
        (5.25, -1.9125),
    ] {
        let (pose, _) = walked(&rig, time);
        assert_printed(
            &format!("root at {time}"),
            pose.displacement,
            [0.0, 0.95, z],
            6,
        );
    }
    let (pose, positions) = walked(&rig, 1.3);
    let wanted = [-0.02648, 0.71404, 2.09406];
    assert_printed("joint 7 at 1.3", pose.angles[7], wanted, 5);
    assert_walked(positions[0], bounds(positions.into_iter()));
}

/// Vertex 0 and the bounds at 1.3 seconds.
fn assert_walked(first: Vector, [min, max]: [Vector; 2]) {
    assert_printed("vertex 0 at 1.3", first, [0.12623, 0.74966, -0.92227], 5);
    assert_printed("bounds at 1.3", min, [-1.1223, -0.0186, -0.9934], 4);
    assert_printed("bounds at 1.3", max, [1.1246, 1.9196, 1.8269], 4);
}

#[test]
fn the_wasp_walks_as_another_program_lets_it() {
    let Some(subject) = Subject::real(&WALKING) else {
        return;
    };
    let pose = json!({"base": "rest", "clip": {"name": "wasp_walk", "time": 1.3}});
    let found = subject.answered(&pose, LINEAR);
    let positions: Vec<Vector> = found.iter().map(|it| it[0].map(f64::from)).collect();
    assert_walked(positions[0], bounds(positions.iter().copied()));
}

const HEAD: [&str; 3] = [
    "cse169/head/head_tex.skin",
    "cse169/head/head1.morph",
    "cse169/head/head2.morph",
];

fn sum(positions: impl Iterator<Item = Vector>) -> Vector {
    positions.fold([0.0; 3], |sum, p| [0, 1, 2].map(|i| sum[i] + p[i]))
}

#[test]
fn morphs_move_a_head_as_another_program() {
    let Some(subject) = Subject::real(&HEAD) else {
        return;
    };
    for (weights, wanted) in [
        ([0.0, 0.0], [-3168.4926, 2333.3238, 0.0]),
        ([0.5, 1.0], [-3168.5062, 2350.8472, -2.4787]),
    ] {
        let mut pose = subject.oracle.rest();
        pose.morphs = weights.to_vec();
        let what = format!("sum of positions at {weights:?}");
        let found = positions(&subject.oracle, &pose).into_iter();
        assert_printed(&what, sum(found), wanted, 4);

        let [first, second] = weights;
        let dofs = json!({"morph.head1": first, "morph.head2": second});
        let wire = json!({"base": "rest", "dofs": dofs});
        let found = subject.answered(&wire, LINEAR);
        let found = found.iter().map(|it| it[0].map(f64::from));
        // Three thousand numbers of up to 6, each rounded to float32.
        assert_printed(&what, sum(found), wanted, 3);
    }
}

#[test]
fn the_oracle_takes_a_mesh_of_mit_where_another_program_takes_it() {
    let files = ["skel", "obj", "attach"].map(|ending| format!("mit6837/Model1.{ending}"));
    let Some(made) = real(&files.each_ref().map(String::as_str)) else {
        return;
    };
    let mut rig = made.oracle();
    let farthest = |rig: &oracle::Rig, angles: Vector| {
        let mut pose = rig.rest();
        pose.angles[5] = angles;
        let steps = positions(rig, &pose);
        let steps = steps.into_iter().zip(&rig.positions);
        let steps = steps.map(|(to, &from)| length(difference(to, from)));
        steps.fold(0.0, f64::max)
    };
    assert_eq!(rig.angle_order, AngleOrder::ZFirst);
    assert!(farthest(&rig, [0.0; 3]) < 1e-15);
    let turned = [0.3, 0.5, -0.4];
    assert_printed("z first", [farthest(&rig, turned)], [0.155125], 6);
    rig.angle_order = AngleOrder::XFirst;
    assert_printed("x first", [farthest(&rig, turned)], [0.270343], 6);
    // The root stands in the world, and so does everything else.
    let root = origin(&rig.world_from_joint(&rig.rest())[0]);
    assert_eq!(root, rig.joints[0].offset);
}
