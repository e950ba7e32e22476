//! Does the program do what its help says, and fail in words?

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const ADAPTER: [&str; 2] = ["--adapter", "llvmpipe"];

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

#[test]
fn a_picture_is_drawn_without_a_daemon() {
    let arguments = [
        "render",
        "-o",
        "raised.png",
        "--size",
        "64x48",
        "--set",
        "upper_arm_l.rz=60deg",
    ];
    let output = rigd(&[&arguments[..], &ADAPTER].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let picture = image::open(folder().join("raised.png")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (64, 48));
}

#[test]
fn files_are_inspected_without_graphics() {
    let output = rigd(&["inspect", "--json"]);
    let described: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(described["joint_count"], 25);
    let tree = text(&rigd(&["inspect"]).stdout);
    assert!(
        tree.contains("forearm_l") && tree.contains("mesh mesh_0"),
        "{tree}"
    );
}

#[test]
fn the_description_can_be_printed_into_a_pipe_that_closes() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rigd"));
    let mut child = command
        .arg("openrpc")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    // Longer than a pipe holds, and nobody reads it.
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{}", text(&output.stderr));
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
            &["render", "-o", "x.png", "--set", "head.rX=1"],
            1,
            "did you mean `head.rx`?",
        ),
        (
            &["render", "-o", "x.png", "--size", "0x5"],
            1,
            "size: expected two positive numbers",
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
    ] {
        let output = rigd(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(wanted), "{arguments:?}: {said}");
    }
}
