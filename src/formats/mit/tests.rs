//! Skeletons and attachments on small files, and all three readers on the course's own where they are at hand.

use super::attach::{self, bindings};
use super::skel;
use crate::formats::contribution::{KnownMesh, KnownSkeleton, Weights};
use crate::formats::text::lexer::Lexer;
use crate::formats::{FileRef, Source, load};
use crate::limits::Limits;
use crate::rig::{BindPose, BindingDraft, JointDraft, Limit, Rotation, RotationOrder, Warnings};
use glam::DVec3;

fn skel(text: &str) -> Result<(Vec<JointDraft>, Vec<String>), String> {
    let mut warnings = Warnings::default();
    skel::read(
        Lexer::new("a.skel", text),
        &Limits::default(),
        &mut warnings,
    )
    .map(|joints| (joints, warnings.into_sentences()))
    .map_err(|error| error.to_string())
}

fn attach_with(joint_count: usize, text: &str, limits: &Limits) -> Result<Weights, String> {
    let mesh = KnownMesh {
        file: "a.obj",
        vertex_count: 3,
    };
    let skeleton = KnownSkeleton {
        file: "a.skel",
        joints: &vec![JointDraft::default(); joint_count],
    };
    let lexer = Lexer::new("a.attach", text);
    attach::read(lexer, mesh, skeleton, limits).map_err(|error| error.to_string())
}

fn attach(text: &str) -> Result<Weights, String> {
    attach_with(3, text, &Limits::default())
}

#[test]
fn a_line_is_a_joint() {
    // 0 -- 1 -- 3
    //   \-- 2
    let text = "\u{c} 0.5 -.75 1e-1 -1 \t\r\n\n0 0 0 0\r\r\n 1 2 3 0\tarm.L\r-1 0 0 1";
    let (joints, warnings) = skel(text).expect("it is a skeleton");
    let tree: Vec<_> = joints
        .iter()
        .map(|joint| (joint.name.as_str(), joint.parent, joint.offset))
        .collect();
    assert_eq!(
        tree,
        [
            ("", None, DVec3::new(0.5, -0.75, 0.1)),
            ("", Some(0), DVec3::ZERO),
            ("arm.L", Some(0), DVec3::new(1.0, 2.0, 3.0)),
            ("", Some(1), DVec3::NEG_X),
        ]
    );
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn joints_turn_freely_about_z_first_and_only_the_root_moves() {
    let (joints, _) = skel("1 2 3 -1\n0 0 0 0\n0 0 0 1\n").expect("it is a skeleton");
    let translates: Vec<_> = joints.iter().map(|joint| joint.translates).collect();
    assert_eq!(translates, [true, false, false]);
    for joint in joints {
        assert_eq!(joint.rotation_order, RotationOrder::Xyz);
        assert_eq!(joint.rest_rotation, Rotation::NONE);
        assert_eq!(joint.rotation_limits, [Limit::NONE; 3]);
        assert_eq!(joint.bounding_box, None);
    }
}

#[test]
fn bind_poses_are_where_the_joints_are_when_nothing_is_turned() {
    let (joints, _) = skel("1 2 3 -1\n10 0 0 0\n0 10 0 0\n0 0 10 1\n").expect("it is a skeleton");
    let found: Vec<_> = bindings(&joints)
        .iter()
        .map(|binding| (binding.joint, bind_pose(binding).translation))
        .collect();
    let wanted = [
        [1.0, 2.0, 3.0],
        [11.0, 2.0, 3.0],
        [1.0, 12.0, 3.0],
        [11.0, 2.0, 13.0],
    ];
    let wanted: Vec<_> = (0..4)
        .map(|joint| (Some(joint), wanted[joint].into()))
        .collect();
    assert_eq!(found, wanted);
    for binding in bindings(&joints) {
        assert_eq!(bind_pose(&binding).matrix3, glam::DMat3::IDENTITY);
    }
}

#[test]
fn what_follows_a_name_is_worth_a_warning() {
    let (joints, warnings) =
        skel("0 0 0 -1 the root of it\n1 0 0 0 arm\n").expect("it is a skeleton");
    let names: Vec<_> = joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["the", "arm"]);
    assert_eq!(
        warnings,
        ["a.skel:1:14: what follows the name of a joint is not used"]
    );
}

#[test]
fn a_number_behind_a_joint_is_worth_one_warning_for_all() {
    let one = "0 0 0 -1\n1 0 0 0 7 arm\n1 0 0 1 hand";
    let (joints, warnings) = skel(one).expect("it is a skeleton");
    let names: Vec<_> = joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["", "", "hand"]);
    let wanted = "a.skel:2:9: a number behind a joint is not used, nor what follows it";
    assert_eq!(warnings, [wanted]);
    let (joints, warnings) = skel("0 0 0 -1 0\n1 0 0 0 1\n1 0 0 1 2").expect("it is a skeleton");
    assert!(joints.iter().all(|joint| joint.name.is_empty()));
    let wanted = "a.skel:1:10: a number behind a joint is not used, nor what follows it, and so in 2 lines more";
    assert_eq!(warnings, [wanted]);
}

#[test]
fn names_of_joints_have_a_bounded_length() {
    let named = |bytes| skel(&format!("0 0 0 -1 {}", "x".repeat(bytes)));
    let (joints, _) = named(256).expect("it is a skeleton");
    assert_eq!(joints[0].name.len(), 256);
    let (joints, warnings) = skel("0 0 0 -1 \"the root\"").expect("it is a skeleton");
    assert_eq!((joints[0].name.as_str(), warnings.len()), ("the root", 0));
    let wanted = "a.skel:1:10: expected a name of at most 256 bytes after joint 0, but found one of 257 bytes";
    assert_eq!(named(257).map(|_| ()), Err(wanted.to_owned()));
}

#[test]
fn what_is_wrong_in_a_line_of_a_skeleton_is_told_where_it_is() {
    for (text, wanted) in [
        (
            "",
            "1:1: expected a joint: `x y z parent`, but found the end of the file",
        ),
        (
            " \r\n \n ",
            "3:2: expected a joint: `x y z parent`, but found the end of the file",
        ),
        (
            "joint root",
            "1:1: expected a number in joint 0, but found `joint`",
        ),
        (
            "0 0\n 0 -1",
            "1:4: expected a number in joint 0, but found the end of the line",
        ),
        (
            "0 0",
            "1:4: expected a number in joint 0, but found the end of the file",
        ),
        (
            "0 0 0 -1\n0 0 inf 0",
            "2:5: expected a number in joint 1, but found `inf`",
        ),
        (
            "0 0 0 -1\n0 1e10 0 0",
            "2:3: expected a number of at most 1e9 in size in joint 1, but found `1e10`",
        ),
        (
            "0 0 0",
            "1:6: expected the parent -1 in joint 0, which is the root, but found the end of the file",
        ),
        (
            "0 0 0 0\n",
            "1:7: expected the parent -1 in joint 0, which is the root, but found `0`",
        ),
        (
            "0 0 0 -1\n0 0 0 \r\n",
            "2:7: expected the parent 0 in joint 1, but found the end of the line",
        ),
        (
            "0 0 0 -1\n0 0 0 0\n\n1 0 0 -1\n",
            "4:7: expected a parent from 0 to 1 in joint 2, but found `-1`",
        ),
        (
            "0 0 0 -1\n0 0 0 1\n",
            "2:7: expected the parent 0 in joint 1, but found `1`",
        ),
        (
            "0 0 0 -1\n0 0 0 99999999999999999999\n",
            "2:7: expected the parent 0 in joint 1, but found `99999999999999999999`",
        ),
        (
            "0 0 0 -1\n0 0 0 0.0\n",
            "2:7: expected the parent 0 in joint 1, but found `0.0`",
        ),
    ] {
        let found = skel(text).map(|_| ());
        assert_eq!(found, Err(format!("a.skel:{wanted}")), "{text:?}");
    }
}

#[test]
fn a_skeleton_stops_at_the_first_joint_too_many() {
    let limits = Limits {
        joints: 2,
        ..Limits::default()
    };
    let read = |text| {
        let joints = skel::read(Lexer::new("a", text), &limits, &mut Warnings::default());
        joints
            .map(|joints| joints.len())
            .map_err(|error| error.to_string())
    };
    assert_eq!(read("0 0 0 -1\n0 0 0 0"), Ok(2));
    let wanted = "3 exceeds the limit `joints` of 2";
    assert_eq!(
        read("0 0 0 -1\n0 0 0 0\nnever read"),
        Err(wanted.to_owned())
    );
}

#[test]
fn columns_are_joints_from_the_second_on_and_zeroes_are_left_out() {
    for text in [
        "0.25 .75 \n0 -0.000\n0 2e-45\n",
        "\n\r\n.25\t0.75\r\r\n0 0\r0 2e-45",
    ] {
        let found = attach(text).expect(text);
        assert_eq!(found.influence_counts, [2, 0, 1], "{text:?}");
        let wanted = [(1, 0.25), (2, 0.75), (2, 2e-45)];
        assert_eq!(found.influences, wanted, "{text:?}");
        assert_eq!(found.bindings.len(), 3);
    }
}

#[test]
fn what_is_wrong_in_attachments_is_told_where_it_is() {
    for (text, wanted) in [
        (
            "1 0\n1 \n1 0\n",
            "2:3: expected 2 weights in vertex 1, one for each joint of `a.skel` but the root, but found 1",
        ),
        (
            "1 0\n1 0\n1",
            "3:2: expected 2 weights in vertex 2, one for each joint of `a.skel` but the root, but found 1",
        ),
        (
            "1 0\n0 1 0 x 5\n1 0\n",
            "2:5: expected 2 weights in vertex 1, one for each joint of `a.skel` but the root, but found 5",
        ),
        (
            "1 0\n\n1 0\n",
            "4:1: expected 3 rows, one for each vertex of `a.obj`, but found the end of the file after 2",
        ),
        (
            "",
            "1:1: expected 3 rows, one for each vertex of `a.obj`, but found the end of the file after 0",
        ),
        (
            "1 0\n1 0\n1 0\n\n 1 0\n1\n",
            "5:2: expected 3 rows, one for each vertex of `a.obj`, but found 5 in all",
        ),
        (
            "1 0\nx 0\n",
            "2:1: expected a number in vertex 1, but found `x`",
        ),
        (
            "1 0\n1 nan\n",
            "2:3: expected a number in vertex 1, but found `nan`",
        ),
        (
            "1 0\n1 -1e-9\n",
            "2:3: expected a weight that is not negative in vertex 1, but found `-1e-9`",
        ),
    ] {
        let found = attach(text).map(drop);
        assert_eq!(found, Err(format!("a.attach:{wanted}")), "{text:?}");
    }
}

#[test]
fn a_root_alone_has_nothing_to_attach_to() {
    for joint_count in [0, 1] {
        let wanted = "a.attach:2:1: expected a skeleton with joints besides its root, but found `a.skel` without any";
        let found = attach_with(joint_count, "\n1 0", &Limits::default());
        assert_eq!(found.map(drop), Err(wanted.to_owned()));
    }
}

#[test]
fn attachments_stop_at_the_first_influence_too_many() {
    let limits = Limits {
        influences: 3,
        ..Limits::default()
    };
    let all = "1 1\n0 1\n0 0";
    assert!(attach_with(3, all, &limits).is_ok());
    let wanted = "4 exceeds the limit `influences` of 3";
    let found = attach_with(3, "1 1\n0 1\n1 never read", &limits);
    assert_eq!(found.map(drop), Err(wanted.to_owned()));
}

#[test]
fn the_courses_own_models_are_read_whole() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/rigs/mit6837");
    if !std::path::Path::new(folder).exists() {
        println!("skipped: {folder} is not here");
        return;
    }
    let limits = Limits::default();
    for (model, most_influences) in [("Model1", 13), ("Model3", 11)] {
        let path = |extension: &str| format!("{folder}/{model}.{extension}");
        let files = ["skel", "obj", "attach"].map(|it| FileRef::Path(path(it)));
        let rig = load(&files, &Source::local(), &limits)
            .expect("it is whole")
            .rig;
        let counts = [
            rig.skeleton().joints().len(),
            rig.vertex_count(),
            rig.triangle_count(),
        ];
        assert_eq!(counts, [18, 13_336, 26_668], "{model}");
        assert!(rig.meshes()[0].texcoords().is_none());
        assert_eq!(rig.warnings(), [""; 0]);

        // The rig has weights divided by their sum; the files have four decimals of each.
        let text = std::fs::read_to_string(path("attach")).expect("it was read before");
        let mesh = KnownMesh {
            file: "a.obj",
            vertex_count: counts[1],
        };
        let skeleton = KnownSkeleton {
            file: "a.skel",
            joints: &vec![JointDraft::default(); counts[0]],
        };
        let lexer = Lexer::new("a.attach", &text);
        let found = attach::read(lexer, mesh, skeleton, &limits).expect("it fits the mesh");
        let most = found.influence_counts.iter().max();
        assert_eq!(most, Some(&most_influences), "{model}");
        let mut influences = found.influences.iter();
        for &count in &found.influence_counts {
            let of_vertex = influences.by_ref().take(count as usize);
            let sum: f64 = of_vertex.map(|(_, weight)| weight).sum();
            assert!((sum - 1.0).abs() < 5e-4, "{model}: {sum}");
        }
        assert_eq!(influences.next(), None);
    }
}

fn bind_pose(binding: &BindingDraft) -> glam::DAffine3 {
    match binding.bind_pose {
        BindPose::BindFromJoint(bind_from_joint) => bind_from_joint,
        BindPose::JointFromBind(_) => panic!("the course gives no inverse bind matrices"),
    }
}
