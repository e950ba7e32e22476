//! What the options of `render` do to a picture, and the units they are typed in.

use crate::{ADAPTER, drawn, folder, left_over, picture, render, rigd, text};

#[test]
fn a_picture_is_drawn_without_a_daemon() {
    let said = render("raised.png", &["--set", "upper_arm_l.rz=60deg"]);
    assert!(said.starts_with("raised.png (48x40, "), "{said}");
    let picture = picture("raised.png");
    assert_eq!((picture.width(), picture.height()), (48, 40));
    assert_eq!(left_over("raised.png"), ["raised.png"]);
}

#[test]
fn every_option_changes_the_picture() {
    let plain = drawn("plain.png", &[]);
    let options: &[&[&str]] = &[
        &["--set", "upper_arm_l.rz=60deg"],
        &["--rotate", "upper_arm_l=0,0,0.70710678,0.70710678"],
        &["--camera", "90deg,0"],
        &["--camera=-0.5,0.3,4"],
        &["--target", "0,2,0"],
        &["--fov", "20deg"],
        &["--eye", "0,1,3"],
        &["--ortho", "2"],
        &["--skin", "bind"],
        &["--skin", "none"],
        &["--skeleton", "wireframe", "--skin-opacity", "0.3"],
        &["--skeleton", "boxes"],
        &["--skeleton", "sticks", "--skin", "none"],
        &["--skeleton", "cylinders", "--skin", "none"],
        &["--skin-opacity", "0.5"],
        &["--flat"],
        &["--diffuse", "1,0,0"],
        &["--specular", "1,1,1"],
        &["--specular", "1,1,1", "--shininess", "3"],
        &["--background", "1,1,1"],
        &["--background", "0,0,0,0"],
        &["--light", "none"],
        &["--light", "dir:0.5,-1,-0.3"],
        &["--light", "dir:0.5,-1,-0.3:1,0,0"],
        &["--light", "dir:0.5,-1,-0.3:1,0,0:3"],
        &["--light", "point:0,1,3"],
        &["--light", "point:0,1,3:inverse_square"],
        &["--light", "point:0,1,3", "--light", "dir:0,1,0"],
        &["--ambient", "0,1,0"],
        &["--samples", "1"],
    ];
    let mut seen = vec![(&[][..], plain)];
    for arguments in options {
        let picture = drawn("option.png", arguments);
        let same = seen.iter().find(|(_, other)| *other == picture);
        assert!(
            same.is_none(),
            "{arguments:?} draws the same as {:?}",
            same.map(|(others, _)| others)
        );
        seen.push((arguments, picture));
    }
}

#[test]
fn skinning_limits_and_compression_are_passed_on() {
    let twist = ["--set", "forearm_l.rx=170deg", "--limits", "ignore"];
    let linear = drawn("twist.png", &twist);
    let dual = [&twist[..], &["--skinning", "dual_quaternion"]].concat();
    assert_ne!(linear, drawn("twist.png", &dual));
    assert_ne!(linear, drawn("twist.png", &twist[..2]), "it was clamped");

    let size = |how| {
        render("packed.png", &["--compression", how]);
        let file = std::fs::metadata(folder().join("packed.png"));
        (file.expect("a file").len(), picture("packed.png"))
    };
    let ((fast, quick), (best, small)) = (size("fast"), size("best"));
    assert!(best < fast, "{best} bytes against {fast}");
    assert_eq!(quick, small);
}

#[test]
fn an_eye_is_a_camera_typed_in_another_way() {
    let target = ["--target", "0.5,1,-0.25"];
    // At a distance of 5, an azimuth of atan2(3, 4) and no inclination.
    let eye = [&["--eye", "3.5,1,3.75"], &target[..]].concat();
    let camera = [&["--camera", "0.6435011087932844,0,5"], &target[..]].concat();
    assert!(drawn("eye.png", &eye) == drawn("eye.png", &camera));
    // Straight down, and without perspective from any distance the same.
    let down = drawn(
        "down.png",
        &["--eye", "0,9,0", "--target", "0,0,0", "--ortho", "2"],
    );
    let further = [
        "--camera",
        "0,90deg,20",
        "--target",
        "0,0,0",
        "--ortho",
        "2",
    ];
    assert!(down == drawn("down.png", &further));
    // A quarter of a turn on.
    render("around.png", &[&eye[..], &["--turntable", "4"]].concat());
    let second = [
        "--camera",
        "2.214297435588181,0,5",
        "--target",
        "0.5,1,-0.25",
    ];
    assert!(picture("around_0001.png") == drawn("second.png", &second));
}

#[test]
fn angles_are_told_in_the_unit_that_was_typed() {
    for (arguments, wanted) in [
        (
            &["--fov", "200deg"][..],
            "'--fov <ANGLE>': expected an angle from 0.01deg to 179.99deg",
        ),
        (&["--fov", "45"], "for degrees type 45deg"),
        (&["--fov", "200"], "to 3.1414rad, but found `200`\n"),
        (
            &["--camera", "30,20"],
            "warning: --camera: 30 is taken for radians, more than a full turn; for degrees type 30deg",
        ),
        (
            &["--set", "spine.rx=30"],
            "warning: --set spine.rx: 30 is taken for radians",
        ),
        (
            &["--set", "spine.rx=200deg"],
            "warning: spine.rx of 200deg is past its limit; used 40deg",
        ),
        (
            &["--set", "spine.rx=2"],
            "warning: spine.rx of 2rad is past its limit; used 0.6981rad",
        ),
        (
            &["--set", "spine.rx=200°", "--limits", "reject"],
            "--set spine.rx: expected an angle from -20deg to 39.99deg, its limits, but found 200deg",
        ),
        (
            &["--set", "spine.rx=40deg", "--limits", "reject"],
            "from -20deg to 39.99deg, its limits, but found 40deg",
        ),
        (
            &["--set", "pelvis.tx=30deg"],
            "--set pelvis.tx: expected a length in the rig's units, but found the angle 30deg",
        ),
    ] {
        let drawing = ["render", "-o", "unit.png", "--size", "8"];
        let output = rigd(&[&drawing, arguments, &ADAPTER[..]].concat());
        let said = text(&output.stderr);
        assert!(said.contains(wanted), "{arguments:?}: {said}");
    }
    // What `inspect` prints can be typed.
    render("unit.png", &["--set", "spine.rx=-2deg", "--strict"]);
}

#[test]
fn a_rig_without_morph_targets_says_so() {
    let skel = "balljoint hip { balljoint knee { offset 0 1 0 } }";
    std::fs::write(folder().join("legs.skel"), skel).expect("a file");
    let output = rigd(&["render", "-o", "x.png", "legs.skel", "--morph", "smile=1"]);
    let wanted = "rigd: --morph smile: the rig has no such morph target; it has none\n";
    assert_eq!(text(&output.stderr), wanted);
}

#[test]
fn a_joint_that_is_called_like_a_morph_target_is_none() {
    let skel = "balljoint morph.x { balljoint knee { offset 0 1 0 } }";
    std::fs::write(folder().join("namesake.skel"), skel).expect("a file");
    for (morph, wanted) in [
        (
            "x.rx=0.5",
            "--morph x.rx: expected a morph target, but morph.x.rx is a DOF of a joint; for that type --set morph.x.rx=0.5\n",
        ),
        (
            "smile=1",
            "--morph smile: the rig has no such morph target; it has none\n",
        ),
    ] {
        let drawing = ["render", "-o", "x.png", "namesake.skel", "--morph", morph];
        let output = rigd(&[&drawing[..], &ADAPTER].concat());
        let said = text(&output.stderr);
        assert_eq!(said, format!("rigd: {wanted}"));
    }
}
