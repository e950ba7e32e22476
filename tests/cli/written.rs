//! The files that `render` writes: pictures, sequences and animations, what is left of one that failed, and where they go.

use crate::{
    ADAPTER, apng_frames, drawn, folder, gif_frames, left_over, picture, render, rigd, text,
};
#[cfg(unix)]
use std::process::Command;

#[test]
fn a_turntable_goes_once_around_in_every_kind_of_file() {
    let still = drawn("still.png", &[]);
    let turn = ["--turntable", "4", "--background", "0,0,0,0"];

    let said = render("turn.png", &turn);
    assert!(
        said.starts_with("turn_0000.png to turn_0003.png (4 frames of 48x40, "),
        "{said}"
    );
    assert!(!folder().join("turn.png").exists());
    let numbered: Vec<_> = (0..4)
        .map(|i| picture(&format!("turn_{i:04}.png")))
        .collect();
    let quarter = ["--camera", "120deg,20deg", "--background", "0,0,0,0"];
    assert_eq!(numbered[1], drawn("quarter.png", &quarter));
    assert_ne!(numbered[0], numbered[2]);

    render("turn.apng", &turn);
    let exact: Vec<_> = numbered
        .iter()
        .map(|frame| frame.as_raw().clone())
        .collect();
    assert_eq!(apng_frames("turn.apng"), exact);

    let said = render("turn.gif", &[&turn[..], &["--fps", "7"]].concat());
    assert!(said.contains("4 frames of 48x40 at 7 a second"), "{said}");
    let frames = gif_frames("turn.gif");
    let delays: Vec<_> = frames.iter().map(|(_, delay)| *delay).collect();
    assert_eq!(delays, [14, 15, 14, 14]);
    for ((pixels, _), exact) in frames.iter().zip(&exact) {
        for (is, was) in pixels.chunks(4).zip(exact.chunks(4)) {
            assert_eq!(is[3] == 255, was[3] >= 128, "alpha {}", was[3]);
        }
    }

    // From where the camera is without a turntable.
    let said = render("start.png", &["--turntable", "1"]);
    assert!(
        said.starts_with("start_0000.png (a single frame of 48x40, "),
        "{said}"
    );
    assert_eq!(picture("start_0000.png"), still);
}

#[test]
fn an_animation_of_one_frame_is_one() {
    let still = drawn("single.png", &[]);
    render("single.apng", &[]);
    assert_eq!(apng_frames("single.apng"), [still.into_raw()]);
    let said = render("single.GIF", &[]);
    assert!(
        said.starts_with("single.GIF (a single frame of 48x40, "),
        "{said}"
    );
    assert!(
        said.ends_with("; --turntable, or --clip without --time, draws more)\n"),
        "{said}"
    );
    assert_eq!(gif_frames("single.GIF").len(), 1);
    let said = render("rare.gif", &["--clip", "walk", "--fps", "0.01"]);
    let wanted = "; the clip has room for no more at --fps 0.01)\n";
    assert!(said.ends_with(wanted), "{said}");
}

#[test]
fn nothing_is_left_of_a_file_that_failed() {
    let kept = b"what was there before";
    let failing = [
        // Found at the first frame.
        (&["--set", "head.rX=1"][..], "failed.gif"),
        (&["--set", "head.rX=1"], "failed.png"),
        // An eye too far away, in the second one.
        (
            &[
                "--turntable",
                "2",
                "--target",
                "1e12,0,0",
                "--camera",
                "-90deg,0,5",
            ],
            "failed.apng",
        ),
    ];
    for (arguments, name) in failing {
        std::fs::write(folder().join(name), kept).expect("a file");
        let output = rigd(&[&["render", "-o", name], arguments, &ADAPTER].concat());
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let now = std::fs::read(folder().join(name)).expect("still there");
        assert_eq!(now, kept, "{name}");
        assert_eq!(left_over(name), [name]);
    }
}

#[test]
fn a_folder_in_the_way_is_an_error() {
    std::fs::create_dir_all(folder().join("taken.gif")).expect("a folder");
    let drawing = ["render", "--turntable", "2", "-o", "taken.gif"];
    let output = rigd(&[&drawing, &ADAPTER[..]].concat());
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("found the folder `taken.gif`"), "{said}");
    assert_eq!(left_over("taken"), ["taken.gif"]);
}

#[cfg(unix)]
#[test]
fn a_link_stays_and_what_it_leads_to_is_written() {
    let link = folder().join("link.png");
    // There may be none of an earlier run.
    let _ = std::fs::remove_file(&link);
    std::os::unix::fs::symlink("linked.png", &link).expect("a link");
    std::fs::write(folder().join("linked.png"), "old").expect("a file");
    render("link.png", &[]);
    let metadata = std::fs::symlink_metadata(&link).expect("a link");
    assert!(metadata.is_symlink());
    assert_eq!(picture("linked.png").dimensions(), (48, 40));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_of_every_kind_of_file() {
    for name in ["full.png", "full.gif", "full.apng"] {
        let link = folder().join(name);
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink("/dev/full", &link).expect("a link");
        let drawing = ["render", "-o", name, "--size", "16"];
        let output = rigd(&[&drawing[..], &ADAPTER].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        let wanted = format!("cannot write {name}: No space left");
        assert!(said.contains(&wanted), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn names_that_are_no_text_are_told_or_written() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let run = |arguments: &[&OsStr]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
        let command = command.args(arguments).args(ADAPTER);
        let output = command.current_dir(folder()).output();
        output.expect("the program runs")
    };
    let [render, size, turn] = ["render", "--size=8", "--turntable=2"].map(OsStr::new);
    let output = run(&[
        render,
        OsStr::from_bytes(b"\xff.skel"),
        OsStr::new("-ox.png"),
    ]);
    let wanted = "error: expected UTF-8, but found the argument `\u{fffd}.skel`\n";
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(text(&output.stderr), wanted);
    let output = run(&[render, size, turn, OsStr::from_bytes(b"-onotext\xff.png")]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for name in [&b"notext\xff_0000.png"[..], b"notext\xff_0001.png"] {
        assert!(folder().join(OsStr::from_bytes(name)).is_file());
    }
}

#[test]
fn one_picture_goes_to_standard_output_and_nothing_else_does() {
    render("piped.png", &[]);
    let drawing = ["render", "-o", "-", "--size", "48x40"];
    let output = rigd(&[&drawing[..], &ADAPTER].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let file = std::fs::read(folder().join("piped.png")).expect("a file");
    assert!(output.stdout == file);
    assert!(left_over("-").is_empty());
}
