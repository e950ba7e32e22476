//! Does the program do what its help says, and fail in words?

use image::RgbaImage;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Once;

/// The command line's own tests need no more than one renderer.
const ADAPTER: [&str; 2] = ["--adapter", "cpu"];

fn rigd(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
    // An empty folder: nothing there is taken for the rig to work with.
    let output = command.args(arguments).current_dir(folder()).output();
    output.expect("the program runs")
}

fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cli");
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

/// Runs `rigd render` on a small picture of that name; what it printed.
fn render(name: &str, arguments: &[&str]) -> String {
    let drawn = ["render", "-o", name, "--size", "48x40"];
    let output = rigd(&[&drawn, arguments, &ADAPTER].concat());
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        text(&output.stderr)
    );
    text(&output.stdout)
}

fn picture(name: &str) -> RgbaImage {
    let picture = image::open(folder().join(name)).expect("a picture");
    picture.into_rgba8()
}

fn drawn(name: &str, arguments: &[&str]) -> RgbaImage {
    render(name, arguments);
    picture(name)
}

/// Of a GIF: the pixels and the delay of each frame in hundredths of a second.
fn gif_frames(name: &str) -> Vec<(Vec<u8>, u16)> {
    let file = std::fs::File::open(folder().join(name)).expect("a file");
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options
        .read_info(std::io::BufReader::new(file))
        .expect("a GIF");
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        frames.push((frame.buffer.to_vec(), frame.delay));
    }
    frames
}

/// Of an animated PNG.
fn apng_frames(name: &str) -> Vec<Vec<u8>> {
    let file = std::fs::File::open(folder().join(name)).expect("a file");
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().expect("a PNG");
    let control = reader.info().animation_control.expect("an animation");
    let mut frame = || {
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut pixels).expect("a frame");
        pixels
    };
    (0..control.num_frames).map(|_| frame()).collect()
}

/// Everything in the tests' folder whose name begins so, hidden or not.
fn left_over(stem: &str) -> Vec<String> {
    let names = std::fs::read_dir(folder()).expect("a folder");
    let names = names.map(|entry| entry.expect("an entry").file_name());
    names
        .map(|name| name.to_string_lossy().into_owned())
        .filter(|name| name.trim_start_matches('.').starts_with(stem))
        .collect()
}

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

#[test]
fn files_are_inspected_without_graphics() {
    let output = rigd(&["inspect", "--json"]);
    let described: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(described["joint_count"], 25);
    let tree = text(&rigd(&["inspect"]).stdout);
    for line in [
        "meshes\n└─ mesh_0: 5961 vertices, 9914 triangles, material skin, texture coordinates\n",
        "joints\n└─ pelvis\n   │   .tx .ty .tz = 0 0 0\n",
        "   ├─ spine\n   │  │   .rx = -2deg  in -20deg .. 40deg\n",
    ] {
        assert!(tree.contains(line), "{line}\nis not in\n{tree}");
    }
}

/// Command lines that print something, each in a way of its own.
const PRINTING: &[&[&str]] = &[
    &["openrpc"],
    &["doctor", "--adapter", "cpu"],
    &["inspect"],
    &["inspect", "--json"],
    &["--help"],
    &["render", "--help"],
    &["--version"],
    &[
        "render",
        "-o",
        "printing.png",
        "--size",
        "8",
        "--adapter",
        "cpu",
    ],
    &["render", "-o", "-", "--size", "8", "--adapter", "cpu"],
];

#[test]
fn a_pipe_that_closes_ends_what_prints_without_a_word() {
    for arguments in PRINTING {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let command = command.args(*arguments).current_dir(folder());
        let output = command.stdout(writer).output().expect("the program runs");
        assert!(output.status.success(), "{arguments:?}");
        assert_eq!(text(&output.stderr), "", "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_on_a_full_disk_is_an_error() {
    let full = || std::fs::File::options().write(true).open("/dev/full");
    let serving: &[&str] = &["serve", "--listen", "127.0.0.1:0", "--adapter", "cpu"];
    for arguments in PRINTING.iter().chain([&serving]) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
        let command = command.args(*arguments).current_dir(folder());
        let command = command.stdout(full().expect("a device"));
        let output = command.output().expect("the program runs");
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
        let wanted = "rigd: cannot write to standard output: No space left";
        assert!(said.starts_with(wanted), "{arguments:?}: {said}");
    }
    // Nor is that of errors one.
    let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
    let command = command.args(["inspect", "missing.skel"]);
    let status = command.stderr(full().expect("a device")).status();
    assert_eq!(status.expect("the program runs").code(), Some(1));
}

#[test]
fn graphics_libraries_have_nothing_to_say_about_displays() {
    for arguments in [
        &["doctor"][..],
        &["render", "-o", "quiet.png", "--size", "8"],
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
        let command = command.args(arguments).current_dir(folder());
        let unset = ["XDG_RUNTIME_DIR", "WAYLAND_DISPLAY", "NODEVICE_SELECT"];
        let command = unset
            .iter()
            .fold(command, |command, name| command.env_remove(name));
        let output = command.output().expect("the program runs");
        assert_eq!(text(&output.stderr), "", "{arguments:?}");
        assert!(output.status.success());
    }
}

#[test]
fn warnings_are_an_exit_code_where_that_is_asked_for() {
    let odd = "balljoint hip { wobble 3 }";
    std::fs::write(folder().join("odd.skel"), odd).expect("a file");
    let render = [
        "render",
        "-o",
        "strict.png",
        "--size",
        "8",
        "--adapter",
        "cpu",
    ];
    let strict = [&render[..], &["--strict"]].concat();
    for (arguments, code) in [
        (&["inspect", "odd.skel"][..], 0),
        (&["inspect", "odd.skel", "--strict"], 3),
        (&["inspect", "odd.skel", "--strict", "--json"], 3),
        (&["inspect", "--strict"], 0),
        (&[&render[..], &["odd.skel"]].concat(), 0),
        (&[&strict[..], &["odd.skel"]].concat(), 3),
        (&[&strict[..], &["--set", "head.rx=200deg"]].concat(), 3),
        (&[&strict[..], &["--camera", "30,20"]].concat(), 3),
        (
            &[&strict[..], &["--morph=smile=1", "--set=morph.smile=0"]].concat(),
            3,
        ),
        (&[&strict[..], &["--set", "head.rx=1deg"]].concat(), 0),
    ] {
        let output = rigd(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
    }
    assert_eq!(picture("strict.png").dimensions(), (8, 8));
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

/// A square of two triangles on one joint, a morph target that moves one corner to the middle, and a clip that turns the joint. Written
/// once, since tests run side by side.
fn write_animated_rig() {
    static WRITTEN: Once = Once::new();
    WRITTEN.call_once(write_card);
}

fn write_card() {
    let skel = "balljoint root { }";
    let skin = "\
positions 4 { -1 -1 0  1 -1 0  1 1 0  -1 1 0 }
normals 4 { 0 0 1  0 0 1  0 0 1  0 0 1 }
skinweights 4 { 1 0 1  1 0 1  1 0 1  1 0 1 }
triangles 2 { 0 1 2  0 2 3 }
bindings 1 { matrix { 1 0 0  0 1 0  0 0 1  0 0 0 } }";
    let morph = "positions 1 { 2 0 0 0 } normals 1 { 2 0 0 1 }";
    let still = "channel { extrapolate constant constant keys 0 { } }\n".repeat(5);
    let anim = format!(
        "animation {{ range 0.5 1 numchannels 6 {still} \
         channel {{ extrapolate linear linear keys 2 {{ 0 0 linear linear  1 1.5 linear linear }} }} }}"
    );
    for (name, content) in [
        ("card.skel", skel),
        ("card.skin", skin),
        ("corner.morph", morph),
        ("turn.anim", &anim),
    ] {
        std::fs::write(folder().join(name), content).expect("a file");
    }
}

const CARD: [&str; 4] = ["card.skel", "card.skin", "corner.morph", "turn.anim"];

fn card(name: &str, arguments: &[&str]) -> String {
    render(name, &[&CARD, arguments].concat())
}

#[test]
fn a_morph_target_is_set_by_its_name() {
    write_animated_rig();
    card("morph0.png", &["--morph", "corner=0"]);
    card("morph1.png", &["--morph", "corner=1"]);
    card("morph_dof.png", &["--set", "morph.corner=1"]);
    assert_ne!(picture("morph0.png"), picture("morph1.png"));
    assert_eq!(picture("morph1.png"), picture("morph_dof.png"));
}

#[test]
fn a_clip_is_a_picture_at_its_start_or_at_a_time() {
    write_animated_rig();
    let said = card("clip.png", &["--clip", "turn"]);
    assert!(said.starts_with("clip.png ("), "{said}");
    card("clip_start.png", &["--clip", "turn", "--time", "0.5"]);
    card("clip_later.png", &["--clip", "turn", "--time", "0.8"]);
    assert_eq!(picture("clip.png"), picture("clip_start.png"));
    assert_ne!(picture("clip.png"), picture("clip_later.png"));
}

/// A camera that does not go by what a clip comes to.
const FIXED: [&str; 4] = ["--target", "0,0,0", "--camera", "30deg,20deg,4"];

#[test]
fn a_clip_that_leads_away_stays_in_the_picture() {
    // The figure walks nearly a meter.
    let walk = ["--clip", "walk", "--fps", "10", "--background", "0,0,0,0"];
    render("away.apng", &walk);
    for frame in apng_frames("away.apng") {
        let (width, height) = (48, 40);
        let alpha = |x: usize, y: usize| frame[4 * (width * y + x) + 3];
        let sides = (0..height).flat_map(|y| [(0, y), (width - 1, y)]);
        let edge = (0..width)
            .flat_map(|x| [(x, 0), (x, height - 1)])
            .chain(sides);
        assert!(edge.into_iter().all(|(x, y)| alpha(x, y) == 0));
        assert!(frame.iter().skip(3).step_by(4).any(|&alpha| alpha > 0));
    }
}

#[test]
fn a_clip_is_played_from_its_start_to_its_end() {
    write_animated_rig();
    // Half a second at 8 a second: 0.5, 0.625, 0.75, 0.875.
    card(
        "play.apng",
        &[&["--clip", "turn", "--fps", "8"], &FIXED[..]].concat(),
    );
    let frames = apng_frames("play.apng");
    assert_eq!(frames.len(), 4);
    card(
        "played.png",
        &[&["--clip", "turn", "--time", "0.875"], &FIXED[..]].concat(),
    );
    assert_eq!(frames[3], picture("played.png").into_raw());

    card(
        "play.png",
        &[&["--clip", "turn", "--fps", "8"], &FIXED[..]].concat(),
    );
    assert_eq!(picture("play_0003.png"), picture("played.png"));
    card("play.gif", &["--clip", "turn"]);
    assert_eq!(gif_frames("play.gif").len(), 12, "24 a second");
}

#[test]
fn a_turntable_plays_a_clip_unless_a_time_is_given() {
    write_animated_rig();
    let turn = [
        &["--clip", "turn", "--fps", "8", "--turntable", "2"],
        &FIXED[..],
    ]
    .concat();
    card("both.apng", &turn);
    card(
        "second.png",
        &[
            "--clip",
            "turn",
            "--time",
            "0.625",
            "--target",
            "0,0,0",
            "--camera",
            "210deg,20deg,4",
        ],
    );
    assert_eq!(
        apng_frames("both.apng")[1],
        picture("second.png").into_raw()
    );
    card("held.apng", &[&turn[..], &["--time", "0.5"]].concat());
    let (held, both) = (apng_frames("held.apng"), apng_frames("both.apng"));
    assert_eq!(held[0], both[0]);
    assert_ne!(held[1], both[1]);
}

#[test]
fn morphs_and_clips_are_listed() {
    write_animated_rig();
    let output = rigd(&[&["inspect"], &CARD[..]].concat());
    let tree = text(&output.stdout);
    for line in [
        "morphs\n└─ morph.corner: 1 vertex of mesh ",
        "clips\n└─ turn: 0.5 s to 1 s, ",
    ] {
        assert!(
            tree.contains(line),
            "{line}\nis not in\n{tree}{}",
            text(&output.stderr)
        );
    }
}

/// That of the protocol's examples: it has two variants, and a spot light on its joint `arm`.
fn write_wall() {
    let examples = include_str!("../api/examples/looks.jsonl");
    let first = examples.lines().next().expect("the rig is loaded first");
    let first: serde_json::Value = serde_json::from_str(first).expect("JSON");
    let file = &first["request"]["params"]["files"][0]["text"];
    let file = file.as_str().expect("a file of text");
    std::fs::write(folder().join("wall.gltf"), file).expect("a file");
}

#[test]
fn a_variant_and_the_lights_of_a_file_are_chosen_and_listed() {
    write_wall();
    let own = drawn("wall.png", &["wall.gltf"]);
    let summer = drawn("summer.png", &["wall.gltf", "--variant", "summer"]);
    let winter = drawn("winter.png", &["wall.gltf", "--variant", "winter"]);
    let lit = drawn("lit.png", &["wall.gltf", "--light", "file"]);
    let moved = drawn(
        "moved.png",
        &["wall.gltf", "--light", "file", "--set", "arm.tx=0.5"],
    );
    let all = [own, summer, winter, lit, moved];
    for (index, picture) in all.iter().enumerate() {
        assert!(
            !all[..index].contains(picture),
            "picture {index} is like another"
        );
    }
    let wrong = ["render", "wall.gltf", "-o", "x.png", "--variant", "wintre"];
    let output = rigd(&[&wrong[..], &ADAPTER].concat());
    let said = text(&output.stderr);
    assert!(
        !output.status.success() && said.contains("did you mean `winter`?"),
        "{said}"
    );
    let both = [
        "render",
        "wall.gltf",
        "-o",
        "x.png",
        "--light",
        "file",
        "--light",
        "dir:0,-1,0",
    ];
    let output = rigd(&[&both[..], &ADAPTER].concat());
    let said = text(&output.stderr);
    assert!(
        !output.status.success() && said.contains("goes with no other light"),
        "{said}"
    );
    let tree = text(&rigd(&["inspect", "wall.gltf"]).stdout);
    for line in [
        "variants\n├─ summer\n└─ winter\n",
        "lights\n└─ lamp: spot, 9 cd, on arm\n",
    ] {
        assert!(tree.contains(line), "{line}\nis not in\n{tree}");
    }
}

#[test]
fn without_a_gpu_and_a_driver_it_draws_all_the_same_and_says_why() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
    // Where the Vulkan loader is not to find anything.
    let command = command
        .args(["doctor", "--threads", "1"])
        .env("VK_DRIVER_FILES", "/nonexistent");
    let output = command.output().expect("the program runs");
    let said = text(&output.stdout);
    assert!(output.status.success(), "{said}");
    if cfg!(target_os = "linux") {
        assert!(
            said.contains("Drew 512x512 with rigd's own renderer"),
            "{said}"
        );
        assert!(said.contains("1 thread): no GPU was found."), "{said}");
    }
}

#[test]
fn what_draws_can_be_chosen_and_what_is_not_there_is_refused() {
    for (arguments, wanted) in [
        (["--adapter", "cpu"], Ok("asked for")),
        (["--adapter", "own renderer"], Ok("asked for")),
        (
            ["--adapter", "no such thing"],
            Err("no adapter matches `no such thing`; there are: "),
        ),
        (
            ["--adapter=cpu", "--require-gpu"],
            Err("a real GPU is required"),
        ),
        (["--threads", "0"], Err("invalid value '0'")),
        (["--threads", "100000"], Err("invalid value '100000'")),
    ] {
        let output = rigd(&[&["doctor"], &arguments[..]].concat());
        let (said, complained) = (text(&output.stdout), text(&output.stderr));
        match wanted {
            Ok(why) => assert!(said.contains(why), "{arguments:?}: {said} {complained}"),
            Err(why) => {
                assert!(!output.status.success());
                assert!(complained.contains(why), "{arguments:?}: {complained}");
            }
        }
    }
}

/// A daemon, stopped when dropped, and where it listens.
struct Daemon(std::process::Child, String);

impl Daemon {
    fn start() -> Self {
        let mut daemon = Command::new(env!("CARGO_BIN_EXE_rigd"));
        let daemon = daemon
            .args(["serve", "--listen", "127.0.0.1:0"])
            .args(ADAPTER);
        let mut daemon = daemon.stdout(Stdio::piped()).spawn().expect("it starts");
        let mut said = BufReader::new(daemon.stdout.take().expect("it is piped"));
        let mut line = String::new();
        said.read_line(&mut line).expect("a line");
        let address = line.trim_end().rsplit(' ').next().expect("an address");
        let address = address.to_owned();
        Self(daemon, address)
    }

    fn call(&self, method: &str, params: &str, output: &str) -> Output {
        rigd(&["call", method, params, "--connect", &self.1, "-o", output])
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.0.kill().expect("it runs");
        self.0.wait().expect("it ends");
    }
}

#[test]
fn a_stream_is_called_for_and_each_picture_saved() {
    let daemon = Daemon::start();
    let params = r#"{"rig": "figure", "size": [24, 32], "stream": true, "frames": [{}, {"camera": {"kind": "orbit", "azimuth": 2}}]}"#;
    for transport in ["base64", "attach"] {
        let params = params.replace(
            "\"stream\"",
            &format!("\"transport\": \"{transport}\", \"stream\""),
        );
        let name = format!("{transport}.png");
        let output = daemon.call("frame.batch", &params, &name);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let said = text(&output.stdout);
        let items: Vec<&str> = said.lines().take(2).collect();
        assert!(
            items.iter().all(|item| item.contains("frame.ready")),
            "{said}"
        );
        assert!(
            said.trim_end().ends_with("{\n  \"frame_count\": 2\n}"),
            "{said}"
        );
        let saved = [0, 1].map(|index| picture(&format!("{transport}_000{index}.png")));
        assert!(saved.iter().all(|picture| picture.dimensions() == (24, 32)));
        assert!(saved[0] != saved[1]);
    }
}

#[test]
fn every_picture_and_array_of_a_result_is_saved() {
    let daemon = Daemon::start();
    // The file of each array that was printed has the bytes that the array says.
    let check = |printed: &serde_json::Value, file: &str| {
        assert_eq!(printed["file"], file);
        for gone in ["data", "encoding", "offset"] {
            assert_eq!(printed.get(gone), None);
        }
        let bytes = std::fs::read(folder().join(file)).expect("a file").len() as u64;
        let shape = printed["shape"].as_array().expect("a shape");
        let numbers = shape
            .iter()
            .map(|length| length.as_u64().expect("a length"));
        assert_eq!(bytes, 4 * numbers.product::<u64>());
    };
    let two_meshes = r#"{"name": "twins", "files": [
        {"name": "a.skel", "text": "balljoint root { }"},
        {"name": "a.skin", "text": "positions 3 { 0 0 0 1 0 0 0 1 0 } triangles 1 { 0 1 2 } skinweights 3 { 1 0 1 1 0 1 1 0 1 } bindings 1 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } }"},
        {"name": "b.skin", "text": "positions 4 { 0 0 0 1 0 0 0 1 0 0 0 1 } triangles 1 { 0 1 2 } skinweights 4 { 1 0 1 1 0 1 1 0 1 1 0 1 } bindings 1 { matrix { 1 0 0 0 1 0 0 0 1 0 0 0 } }"}]}"#;
    let address = daemon.1.as_str();
    let loaded = rigd(&["call", "rig.load", two_meshes, "--connect", address]);
    assert!(loaded.status.success(), "{}", text(&loaded.stdout));
    for transport in ["json", "base64", "attach"] {
        let params = format!(r#"{{"rig": "twins", "transport": "{transport}"}}"#);
        let output = daemon.call("mesh.vertices", &params, "all.f32");
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let meshes = &result["meshes"];
        check(&meshes[0]["normals"], "all_0000.f32");
        check(&meshes[0]["positions"], "all_0001.f32");
        check(&meshes[1]["normals"], "all_0002.f32");
        check(&meshes[1]["positions"], "all_0003.f32");
        let listed = "all_0003.f32 (meshes[1].positions, 48 bytes)\n";
        assert!(text(&output.stderr).ends_with(listed));
    }
    let one = r#"{"rig": "twins", "mesh": "mesh_1", "attributes": ["positions"]}"#;
    let output = daemon.call("mesh.vertices", one, "one.f32");
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    check(&result["meshes"][0]["positions"], "one.f32");

    let poses = r#"{"rig": "figure", "poses": [{}, {}], "stream": true, "transport": "attach"}"#;
    let output = daemon.call("mesh.batch", poses, "pose.f32");
    let said = text(&output.stderr);
    assert!(output.status.success(), "{said}");
    let places: Vec<_> = said
        .lines()
        .filter_map(|line| line.split(['(', ')']).nth(1))
        .collect();
    assert_eq!(places[0], "item 0, item.meshes[0].normals, 71532 bytes");
    assert_eq!(places[3], "item 1, item.meshes[0].positions, 71532 bytes");
    let mut saved = left_over("pose");
    saved.sort_unstable();
    let wanted = ["0000_0000", "0000_0001", "0001_0000", "0001_0001"];
    assert_eq!(saved, wanted.map(|number| format!("pose_{number}.f32")));

    let picture = r#"{"rig": "figure", "size": [8, 8]}"#;
    let output = daemon.call("frame.render", picture, "-");
    assert!(output.status.success());
    image::load_from_memory(&output.stdout).expect("a PNG and nothing else");
    assert!(text(&output.stderr).contains("\"world_from_camera\""));
}

#[test]
fn a_stream_that_nobody_reads_any_more_is_not_waited_for() {
    let server = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = server.local_addr().expect("it is bound").to_string();
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let mut call = Command::new(env!("CARGO_BIN_EXE_rigd"));
    let call = call.args([
        "call",
        "frame.batch",
        r#"{"stream": true}"#,
        "--connect",
        &address,
    ]);
    let mut call = call.stdout(writer).spawn().expect("it starts");
    let (mut connection, _) = server.accept().expect("it connects");
    let item = r#"{"jsonrpc": "2.0", "method": "frame.ready", "params": {"index": 0}}"#;
    writeln!(connection, "{item}").expect("it reads");
    let mut received = Vec::new();
    let patience = std::time::Duration::from_secs(60);
    connection.set_read_timeout(Some(patience)).expect("a time");
    // Its request, and then the end of the connection, which comes before any reply.
    let end = connection.read_to_end(&mut received);
    let ended = end.is_ok() || end.is_err_and(|error| error.kind() == ErrorKind::ConnectionReset);
    assert!(ended, "it waits for more");
    assert!(call.wait().expect("it ends").success());
}

#[test]
fn what_is_not_saved_is_told() {
    let daemon = Daemon::start();
    let both = r#"{"rig": "figure", "transport": "attach"}"#;
    for (method, params, output, code, wanted) in [
        (
            "mesh.vertices",
            both,
            "-",
            1,
            "standard output takes one: name a file",
        ),
        (
            "server.ping",
            "{}",
            "none.f32",
            1,
            "no picture and no array to save",
        ),
        (
            "mesh.vertices",
            both,
            "nowhere/x",
            1,
            "cannot write nowhere/x_0000",
        ),
        (
            "mesh.vertices",
            both,
            "beside/",
            1,
            "--output: expected the name of a file, but found the folder `beside/`",
        ),
        ("mesh.vertices", both, "/", 1, "but found the folder `/`"),
        ("mesh.vertices", both, ".", 1, "but found the folder `.`"),
        (
            "frame.batch",
            r#"{"rig": "figure", "frames": [{}], "stream": true}"#,
            "-",
            1,
            "a stream needs a file's name",
        ),
    ] {
        let output = daemon.call(method, params, output);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{said}");
        assert!(said.contains(wanted), "{said}");
    }
    assert!(left_over("beside").is_empty());
    let address = daemon.1.as_str();
    let output = rigd(&["call", "mesh.vertices", both, "--connect", address]);
    let said = text(&output.stderr);
    assert!(output.status.success());
    assert!(
        said.starts_with("warning: 143064 attached bytes are left out"),
        "{said}"
    );
}

#[test]
fn a_daemon_outlives_whoever_read_its_first_words() {
    let free = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = free.local_addr().expect("it is bound").to_string();
    drop(free);
    let mut daemon = Command::new(env!("CARGO_BIN_EXE_rigd"));
    let daemon = daemon.args(["serve", "--listen", &address]).args(ADAPTER);
    let mut daemon = daemon.stdout(Stdio::piped()).spawn().expect("it starts");
    drop(daemon.stdout.take());
    let end = std::time::Instant::now() + std::time::Duration::from_secs(120);
    while !rigd(&["call", "server.ping", "--connect", &address])
        .status
        .success()
    {
        assert!(daemon.try_wait().expect("a child").is_none(), "it ended");
        assert!(std::time::Instant::now() < end, "it does not answer");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    daemon.kill().expect("it still runs");
    daemon.wait().expect("it ends");
}
