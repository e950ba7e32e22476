//! Skeletons in small files: what is read, what is warned of, what is refused and where.

use super::read;
use crate::formats::text::lexer::Lexer;
use crate::limits::Limits;
use crate::rig::{JointDraft, Limit, Rotation, Warnings};
use glam::DVec3;

fn skel(text: &str) -> Result<(Vec<JointDraft>, Vec<String>), String> {
    let mut warnings = Warnings::default();
    read(
        Lexer::new("a.skel", text),
        &Limits::default(),
        &mut warnings,
    )
    .map(|joints| (joints, warnings.into_sentences()))
    .map_err(|error| error.to_string())
}

#[test]
fn a_tree_is_read_in_order_of_appearance() {
    //  root -- (empty) -- tip
    //     \--- leg{
    let text =
        "balljoint root {\n\toffset 1 2 3\rballjoint  {balljoint tip { }}\r\r\nballjoint leg{ } }";
    let (joints, warnings) = skel(text).expect("it is a skeleton");
    let tree: Vec<_> = joints
        .iter()
        .map(|joint| (joint.name.as_str(), joint.parent))
        .collect();
    assert_eq!(
        tree,
        [
            ("root", None),
            ("", Some(0)),
            ("tip", Some(1)),
            ("leg", Some(0))
        ]
    );
    assert_eq!(joints[0].offset, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        joints
            .iter()
            .map(|joint| joint.translates)
            .collect::<Vec<_>>(),
        [true, false, false, false]
    );
    assert_eq!(warnings, [""; 0]);
}

#[test]
fn properties_come_in_any_order_and_have_defaults() {
    let text =
        "joint a { pose .5 -1 +2e0 rotylimit -1 1 balljoint b { } boxmax 1 1 1 rotxlimit 0 0 }";
    let (joints, _) = skel(text).expect("it is a skeleton");
    assert_eq!(
        joints[0].rest_rotation,
        Rotation::Angles(DVec3::new(0.5, -1.0, 2.0))
    );
    let limits = [
        Limit { min: 0.0, max: 0.0 },
        Limit {
            min: -1.0,
            max: 1.0,
        },
        Limit::NONE,
    ];
    assert_eq!(joints[0].rotation_limits, limits);
    assert_eq!(
        joints[0].bounding_box,
        Some([DVec3::splat(-0.1), DVec3::ONE])
    );
    assert_eq!(joints[1].rotation_limits, [Limit::NONE; 3]);
    assert_eq!(
        joints[1].bounding_box,
        Some([DVec3::splat(-0.1), DVec3::splat(0.1)])
    );
}

#[test]
fn what_is_odd_in_a_skeleton_is_worked_with() {
    for (text, joints, warning) in [
        (
            "balljoint a {\n pos 0 0 1.57\n offset 1 0 0 }",
            1,
            "a.skel:2:2: skipped `pos`, which is not known here; did you mean `pose`?",
        ),
        (
            "balljoint a { offset 1 0 0 7 }",
            1,
            "a.skel:1:28: skipped `7`, which is not known here",
        ),
        (
            "balljoint a { mesh x { balljoint no { } } offset 1 0 0 }",
            1,
            "a.skel:1:15: skipped `mesh`, which is not known here",
        ),
        (
            "skeleton v2 balljoint a { offset 1 0 0 }",
            1,
            "a.skel:1:1: skipped `skeleton`, which is not known here",
        ),
        (
            "balljoint a { orient 1 0 0 0 1 0 0 0 1 offset 1 0 0 joint b { orient 1 } }",
            2,
            "a.skel:1:15: `orient` is not used",
        ),
        (
            "balljoint a { offset 2 2 2 pose 0 0 0 boxmin 0 0 0 boxmax 0 0 0 offset 1 0 0 joint b { offset 2 2 2 } }",
            2,
            "a.skel:1:65: `offset` stands twice in a joint; the last one counts",
        ),
        (
            "BallJoint a { offset 1 0 0 }",
            1,
            "a.skel:1:1: `BallJoint` is taken for `balljoint`",
        ),
        (
            "balljoint a { offset 1 0 0 } }\n}",
            1,
            "a.skel:1:30: what follows the root joint is not used",
        ),
    ] {
        let (found, warnings) = skel(text).expect(text);
        assert_eq!((found.len(), found[0].offset), (joints, DVec3::X), "{text}");
        assert_eq!(warnings, [warning], "{text}");
    }
}

#[test]
fn what_is_wrong_in_a_skeleton_is_told_where_it_is() {
    for (text, wanted) in [
        (
            "",
            "1:1: expected `balljoint`, but found the end of the file",
        ),
        (
            " \n",
            "2:1: expected `balljoint`, but found the end of the file",
        ),
        (
            "hello world",
            "1:1: expected `balljoint`, but found `hello`",
        ),
        (
            "balljoint",
            "1:10: expected a name or `{` after `balljoint`, but found the end of the file",
        ),
        (
            "balljoint }",
            "1:11: expected a name or `{` after `balljoint`, but found `}`",
        ),
        (
            "balljoint a b {",
            "1:13: expected `{` after `balljoint a`, but found `b`",
        ),
        (
            "balljoint a {\n",
            "2:1: expected `}` to end the `balljoint` at 1:1, but found the end of the file",
        ),
        (
            "balljoint a {\n joint b {\n }",
            "3:3: expected `}` to end the `balljoint` at 1:1, but found the end of the file",
        ),
        (
            "balljoint a { rotxlimit abc 1 }",
            "1:25: expected a number after `rotxlimit`, but found `abc`",
        ),
        (
            "balljoint a { pose 1 2 }",
            "1:24: expected a number after `pose`, but found `}`",
        ),
        (
            "balljoint a { pose 1 2 nan }",
            "1:24: expected a number after `pose`, but found `nan`",
        ),
        (
            "balljoint a { offset 1e10 0 0 }",
            "1:22: expected a number of at most 1e9 in size after `offset`, but found `1e10`",
        ),
        (
            "balljoint a { rotzlimit 2 -1 }",
            "1:25: expected the smaller value first after `rotzlimit`, but found 2 and -1",
        ),
        (
            "balljoint a { rotzlimit nan 1 }",
            "1:25: expected a number after `rotzlimit`, but found `nan`",
        ),
        (
            "balljoint a { rotzlimit 2e9 inf }",
            "1:25: expected a range with an angle of at most 1e9 in size after `rotzlimit`, but found 2000000000 and inf",
        ),
        (
            "balljoint a { } balljoint b { }",
            "1:17: expected the end of the file after the one root joint, but found `balljoint`",
        ),
        (
            "balljoint a { } } joint b { }",
            "1:19: expected the end of the file after the one root joint, but found `joint`",
        ),
        (
            "balljoint a { x { { } ",
            "1:23: expected `}` for the `{` at 1:17, but found the end of the file",
        ),
    ] {
        assert_eq!(
            skel(text).map(|_| ()),
            Err(format!("a.skel:{wanted}")),
            "{text:?}"
        );
    }
}

#[test]
fn names_are_free_words_of_a_bounded_length() {
    for name in ["pose", "Ärmel.L", "1", "a#2", &"x".repeat(256)] {
        let (joints, _) = skel(&format!("balljoint {name} {{ }}")).expect(name);
        assert_eq!(joints[0].name, name);
    }
    let (joints, _) = skel("balljoint \"left {arm\"{ }").expect("it is a skeleton");
    assert_eq!(joints[0].name, "left {arm");
    let wanted = "a.skel:1:11: expected a name of at most 256 bytes after `balljoint`, but found one of 257 bytes";
    let found = skel(&format!("balljoint {} {{ }}", "x".repeat(257)));
    assert_eq!(found.map(|_| ()), Err(wanted.to_owned()));
}

#[test]
fn a_keyword_in_another_case_ends_what_is_skipped() {
    let (joints, warnings) = skel("balljoint a { mass 3 Offset 1 0 0 }").expect("it is a skeleton");
    assert_eq!(joints[0].offset, DVec3::X);
    assert_eq!(
        warnings,
        [
            "a.skel:1:15: skipped `mass`, which is not known here",
            "a.skel:1:22: `Offset` is taken for `offset`"
        ]
    );
}

#[test]
fn ends_of_limits_may_be_larger_than_any_angle() {
    let (min, max) = (f64::NEG_INFINITY, f64::INFINITY);
    for (text, limit) in [
        (
            "-1e10 1e10",
            Limit {
                min: -1e10,
                max: 1e10,
            },
        ),
        (
            "-3.4e38 .5",
            Limit {
                min: -3.4e38,
                max: 0.5,
            },
        ),
        ("0 inf", Limit { min: 0.0, max }),
        ("-INF 1e999", Limit { min, max }),
    ] {
        let (joints, warnings) = skel(&format!("balljoint a {{ rotylimit {text} }}")).expect(text);
        assert_eq!(joints[0].rotation_limits[1], limit, "{text}");
        assert_eq!(warnings, [""; 0], "{text}");
    }
}

#[test]
fn angles_that_look_like_degrees_are_asked_about_once() {
    let one = "balljoint a { offset 90 90 90 rotxlimit -90 90 }";
    let (_, warnings) = skel(one).expect("it is a skeleton");
    let wanted = "a.skel:1:31: `rotxlimit` goes past a full turn here; angles are in radians, were degrees meant?";
    assert_eq!(warnings, [wanted]);
    let many = "balljoint a { pose 0 -45 0\n rotxlimit 0 1 rotylimit 0 170 rotzlimit -360 360 }";
    let (_, warnings) = skel(many).expect("it is a skeleton");
    let wanted = "a.skel:1:15: `pose` goes past a full turn here, and in 2 places more; \
        angles are in radians, were degrees meant?";
    assert_eq!(warnings, [wanted]);
    // A full turn in few digits, and ways to say that there is no limit.
    for text in [
        "pose 6.2832 -6.3 0",
        "rotxlimit -1000 1000",
        "rotxlimit -100000 100000",
        "rotxlimit -1e10 1e10",
        "rotxlimit -inf inf",
    ] {
        let (_, warnings) = skel(&format!("balljoint a {{ {text} }}")).expect(text);
        assert_eq!(warnings, [""; 0], "{text}");
    }
}
