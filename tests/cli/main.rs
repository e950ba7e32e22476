//! Does the program do what its help says, and fail in words? Modules for `render` and `call`; what goes for several subcommands is here,
//! and what is asked of `inspect` and `doctor`.

mod call;
mod contents;
mod options;
mod refused;
mod written;

use image::RgbaImage;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

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
