//! Do the README's examples do what it says, and is its picture what the program draws?

#[path = "../examples/contact_sheet.rs"]
#[allow(dead_code, reason = "its main writes the picture")]
mod contact_sheet;
mod support;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use support::server::TestServer;

const README: &str = include_str!("../README.md");

/// The code under `<!-- test: NAME -->`, with the port of a server that is really there.
fn example(name: &str, port: u16) -> String {
    let marked = README
        .split(&format!("<!-- test: {name} -->\n```"))
        .nth(1)
        .expect("the README has the example");
    let (_, code) = marked.split_once('\n').expect("a language");
    let code = code.split("\n```").next().expect("an end");
    assert!(code.contains("7443"), "the example names the usual port");
    code.replace("7443", &port.to_string())
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder for the example");
    folder
}

/// Runs `code` by `program`, as a user would paste it; what it printed.
fn run(program: &[&str], code: &str, folder: &Path) -> String {
    let mut child = Command::new(program[0])
        .args(&program[1..])
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| {
            panic!(
                "{} is needed (`make setup` installs it): {error}",
                program[0]
            )
        });
    child
        .stdin
        .take()
        .expect("a pipe")
        .write_all(code.as_bytes())
        .expect("the program reads");
    let output = child.wait_with_output().expect("the program ends");
    assert!(output.status.success(), "{} failed", program[0]);
    String::from_utf8(output.stdout).expect("text")
}

fn size_of(png: &Path) -> (u32, u32) {
    let picture = image::open(png).unwrap_or_else(|error| panic!("{}: {error}", png.display()));
    (picture.width(), picture.height())
}

#[test]
fn the_session_with_nc_works_as_written() {
    let server = TestServer::start(&support::service());
    let folder = folder("readme-sh");
    let printed = run(
        &["sh", "-e"],
        &example("sh", server.address.port()),
        &folder,
    );
    assert!(printed.contains("\"driver\""), "{printed}");
    let vertices: Vec<f64> =
        serde_json::from_str(printed.lines().last().expect("vertices")).expect("a list");
    assert_eq!(vertices.len(), 9);
    assert_eq!(size_of(&folder.join("arm.png")), (256, 256));
}

#[test]
fn the_python_client_works_as_written_and_is_short() {
    let server = TestServer::start(&support::service());
    let code = example("python", server.address.port());
    assert!(
        code.lines().count() <= 30,
        "it has {} lines",
        code.lines().count()
    );
    let folder = folder("readme-python");
    let printed = run(&["python3", "-"], &code, &folder);
    assert!(printed.starts_with("3840 2160 "), "{printed}");
    assert_eq!(size_of(&folder.join("knee.png")), (3840, 2160));
}

#[test]
fn the_picture_is_what_the_example_draws() {
    let server = TestServer::start(&support::service());
    let drawn = contact_sheet::sheet(&server.address.to_string()).expect("a sheet");
    let shown = image::open(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/docs/images/sheet.png"
    ));
    let shown = shown.expect("the picture").into_rgba8();
    assert_eq!(drawn.dimensions(), shown.dimensions());
    let differs = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 8)
    };
    let differing = drawn.pixels().zip(shown.pixels()).filter(differs).count();
    // Drivers differ at silhouettes, and nowhere else by this much.
    let most = shown.pixels().len() / 500;
    assert!(
        differing <= most,
        "{differing} pixels differ: run `make demo`, then cp out/sheet.png docs/images/"
    );
}
