//! Command lines that fail, each with its words and its exit code.

use crate::{folder, rigd, text};

#[test]
fn what_cannot_be_done_is_said_with_a_failing_exit_code() {
    let bad = folder().join("bad.skel");
    std::fs::write(&bad, "balljoint hip { offset 0 abc 0 }").expect("a file");
    std::fs::write(folder().join("odd\u{9b}31m.skel"), "balljoint { ").expect("a file");
    for (arguments, code, wanted) in [
        (
            &["render", "-o", "x.png", "missing.skel"][..],
            1,
            "`missing.skel` was not found",
        ),
        (
            &["inspect", "bad.skel"],
            1,
            "bad.skel:1:26: expected a number",
        ),
        (&["inspect", "odd\u{9b}31m.skel"], 1, "\\u{9b}31m.skel"),
        (
            &["render", "-o", "x.png", "--set", "head.rx"],
            2,
            "expected DOF=VALUE",
        ),
        (
            &["render", "-o", "x.png", "--set", "pelvis.tx=10m"],
            2,
            "expected a number, or an angle such as 30deg, but found `10m`",
        ),
        (
            &["render", "-o", "x.png", "--camera", "30deg,20deg,-1"],
            2,
            "expected a distance from 1e-12 to 1e12, but found `-1`",
        ),
        (
            &["render", "-o", "x.png", "--target", "1e13,0,0"],
            2,
            "'--target <X,Y,Z>': expected coordinates within ±1e12, but found `1e13,0,0`",
        ),
        (
            &["render", "-o", "x.png", "--eye", "1e13,0,0"],
            2,
            "'--eye <X,Y,Z>': expected coordinates within ±1e12, but found `1e13,0,0`",
        ),
        (
            &["render", "-o", "x.png", "--target", "1e12,0,0"],
            1,
            "--target, and the eye that goes by it: expected an eye within ±1e12",
        ),
        (
            &[
                "render",
                "-o",
                "x.png",
                "--eye=1e12,0,0",
                "--target=-1e12,0,0",
            ],
            1,
            "--eye, its distance: expected a number from 1e-12 to 1e12",
        ),
        (
            &["render", "-o", "x.png", "--set", "head.rX=1"],
            1,
            "--set head.rX: the rig has no such DOF; did you mean `head.rx`?",
        ),
        (
            &["render", "-o", "x.png", "--size", "0x5"],
            1,
            "--size: expected two positive numbers",
        ),
        (
            &["render", "-o", "nowhere/x.png"],
            1,
            "cannot write nowhere/x.png",
        ),
        (
            &["serve", "--root", "nowhere"],
            1,
            "cannot open the root folder nowhere",
        ),
        (
            &["serve", "--adapter", "no such thing"],
            1,
            "no adapter matches",
        ),
        (
            &["serve", "--listen", "127.0.0.1:http"],
            1,
            "cannot listen on 127.0.0.1:http",
        ),
        (&["--listen", "7443"], 2, "expected HOST:PORT"),
        (&["rendr", "-o", "x.png"], 2, "did you mean `rigd render`?"),
        (
            &["render", "-o", "-", "--turntable", "2"],
            1,
            "a sequence needs a file",
        ),
        (
            &[
                "render", "-o", "x.png", "--eye", "1,2,3", "--target", "1,2,3",
            ],
            1,
            "--eye: expected a point at a distance from the target",
        ),
        (
            &["call", "server.info", "--connect", "127.0.0.1:1"],
            1,
            "start one with `rigd serve`",
        ),
        (
            &["call", "server.info", "{"],
            1,
            "the parameters are not JSON",
        ),
        (&["render"], 2, "--output"),
        (
            &["render", "-o", "x.jpg"],
            1,
            "ends in .png, .gif or .apng, or - for a PNG to standard output, but found `x.jpg`",
        ),
        (&["render", "-o", "x.png", "--time", "1"], 2, "--clip"),
        (
            &["render", "-o", "x.gif", "--turntable", "0"],
            2,
            "0 is not in 1..",
        ),
        (
            &["render", "-o", "x.gif", "--turntable", "2", "--fps", "0"],
            2,
            "expected 0.01 to 1000 frames a second",
        ),
        (
            &["render", "-o", "x.gif", "--turntable", "2", "--fps", "NaN"],
            2,
            "but found `NaN`",
        ),
        (
            &["render", "-o", "x.gif", "--turntable", "2", "--fps", "60"],
            1,
            "a GIF shows at most 50 frames a second, but 60 are wanted",
        ),
        (
            &["render", "-o", "x.png", "--fps", "24"],
            1,
            "--fps is for a sequence",
        ),
        (
            &[
                "render", "-o", "x.gif", "--clip", "walk", "--time", "1", "--fps", "24",
            ],
            1,
            "--clip without --time",
        ),
        (
            &["render", "-o", "x.png", "--light", "sun:0,1,0"],
            2,
            "expected dir:X,Y,Z[:R,G,B][:INTENSITY] or point:",
        ),
        (
            &[
                "render",
                "-o",
                "x.png",
                "--light",
                "none",
                "--light",
                "dir:0,1,0",
            ],
            1,
            "goes with no other light",
        ),
        (
            &["render", "-o", "x.png", "--light", "dir:0,0,0"],
            1,
            "--light number 1, its direction: expected a direction other than zero",
        ),
        (
            &["render", "-o", "x.png", "--morph", "frown=1"],
            1,
            "--morph frown: the rig has no such morph target; it has `smile`",
        ),
        (
            &["render", "-o", "x.gif", "--clip", "dance"],
            1,
            "--clip dance: the rig has no such clip",
        ),
        (
            &["render", "-o", "x.png", "--rotate", "head=0,0,0,2"],
            1,
            "--rotate head: expected a unit quaternion",
        ),
        (
            &[
                "render",
                "-o",
                "x.png",
                "--limits",
                "reject",
                "--set",
                "head.rx=3",
            ],
            1,
            "--set head.rx: expected an angle from",
        ),
        (
            &["render", "-o", "x.png", "--samples", "2"],
            2,
            "[possible values: 1, 4]",
        ),
    ] {
        let output = rigd(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(wanted), "{arguments:?}: {said}");
    }
}
