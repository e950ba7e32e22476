//! Do the README's examples do what it says, and is its picture what the program draws?

#[path = "../examples/contact_sheet/src/main.rs"]
#[allow(dead_code, reason = "its main writes the picture")]
mod contact_sheet;
mod support;

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use support::server::TestServer;

const README: &str = include_str!("../README.md");
const MAKEFILE: &str = include_str!("../Makefile");
const OPERATIONS: &str = include_str!("../docs/operations.md");

/// The code of a document's fenced blocks in this language.
fn blocks<'a>(document: &'a str, language: &str) -> Vec<&'a str> {
    let fenced = document.split("\n```").skip(1).step_by(2);
    fenced
        .filter_map(|block| block.split_once('\n'))
        .filter(|(named, _)| *named == language)
        .map(|(_, code)| code)
        .collect()
}

/// The README's only block in this language, with the port of a server that is really there.
fn example(language: &str, port: u16) -> String {
    let blocks = blocks(README, language);
    let [code] = blocks.as_slice() else {
        panic!("{} blocks in {language}, and one is run", blocks.len());
    };
    assert!(code.contains("7443"), "the example names the usual port");
    code.replace("7443", &port.to_string())
}

/// An empty folder for an example.
fn folder(name: &str) -> PathBuf {
    let folder = support::places::output(name);
    let _ = std::fs::remove_dir_all(&folder);
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
    assert!(output.status.success(), "failed: {code}");
    String::from_utf8(output.stdout).expect("text")
}

/// Where a document's console blocks are typed, one after another: a folder with the repository's `assets`, and `rigd` on the path.
struct Terminal {
    folder: PathBuf,
    daemon: Option<Daemon>,
}

/// Ends with the value.
struct Daemon {
    process: Child,
    address: String,
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Terminal {
    fn new(name: &str) -> Self {
        let folder = folder(name);
        let assets = support::places::repository("assets");
        std::os::unix::fs::symlink(assets, folder.join("assets")).expect("a link");
        let daemon = None;
        Self { folder, daemon }
    }

    /// Does what the lines after `$ ` say. Lines below one are the first that it prints; `…` stands for any rest of a line.
    fn type_in(&mut self, block: &str) {
        assert!(block.starts_with("$ "), "{block}");
        for entry in format!("\n{block}").split("\n$ ").skip(1) {
            let mut lines = entry.lines();
            let line = lines.next().expect("a line");
            let command = line.split("  #").next().expect("a command").trim_end();
            let printed = self.enter(command);
            let mut printed = printed.lines();
            for wanted in lines {
                let found = printed.next().unwrap_or("nothing");
                match wanted.split_once('…') {
                    Some((wanted, _)) => assert!(found.starts_with(wanted), "{command}: {found}"),
                    None => assert_eq!(found, wanted, "{command}"),
                }
            }
        }
    }

    /// What it prints; of a daemon, that it is there.
    fn enter(&mut self, command: &str) -> String {
        if let Some(target) = command.strip_prefix("make ") {
            assert!(MAKEFILE.contains(&format!("\n{target}:")), "{command}");
            return String::new();
        }
        if command == "cargo install --path ." {
            return String::new();
        }
        assert!(command.starts_with("rigd"), "who would run {command}?");
        if command == "rigd" || command.starts_with("rigd serve") {
            return self.start(command);
        }
        let connected = self.daemon.as_ref().map(|daemon| {
            command.replace(
                "rigd call",
                &format!("rigd call --connect {}", daemon.address),
            )
        });
        run(
            &["sh", "-e"],
            &on_path(connected.as_deref().unwrap_or(command)),
            &self.folder,
        )
    }

    /// In place of the daemon before, on a port of its own; the two lines that it starts with, as if it had the usual one.
    fn start(&mut self, command: &str) -> String {
        self.daemon = None;
        let command = command.replace("--listen 127.0.0.1:7443", "") + " --listen 127.0.0.1:0";
        let mut process = Command::new("sh")
            .args(["-c", &on_path(&format!("exec {command}"))])
            .current_dir(&self.folder)
            .stdout(Stdio::piped())
            .spawn()
            .expect("a shell");
        let printed = BufReader::new(process.stdout.take().expect("a pipe")).lines();
        let mut lines = printed.take(2).map(|line| line.expect("text"));
        let listening = lines.next().unwrap_or_else(|| panic!("{command}"));
        let (_, address) = listening.rsplit_once(' ').expect("an address");
        let printed = format!(
            "{}\n{}\n",
            listening.replace(address, "127.0.0.1:7443"),
            lines.next().expect("a rig")
        );
        let address = address.to_owned();
        self.daemon = Some(Daemon { process, address });
        printed
    }
}

/// As a line of a shell that finds `rigd`.
fn on_path(command: &str) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_rigd"));
    let folder = program.parent().expect("a folder");
    format!("PATH='{}':$PATH; {command}\n", folder.display())
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
fn every_command_works_as_written() {
    for (name, document) in [("readme", README), ("operations", OPERATIONS)] {
        let mut terminal = Terminal::new(&format!("{name}-console"));
        let blocks = blocks(document, "console");
        assert!(!blocks.is_empty(), "{name}");
        blocks.iter().for_each(|block| terminal.type_in(block));
    }
    let drawn = support::places::output("readme-console");
    assert_eq!(size_of(&drawn.join("arm.png")), (256, 256));
    for name in ["drake.png", "bear.png"] {
        let drawn = image::open(drawn.join(name)).expect("a picture");
        assert_shown(name, &drawn.into_rgba8());
    }
}

#[test]
fn there_is_no_block_that_no_test_runs() {
    for document in [README, OPERATIONS] {
        let all = document.matches("\n```").count() / 2;
        let run = ["console", "sh", "python"].map(|language| blocks(document, language).len());
        assert_eq!(run.iter().sum::<usize>(), all);
    }
    assert_eq!(
        blocks(OPERATIONS, "sh").len() + blocks(OPERATIONS, "python").len(),
        0
    );
}

#[test]
fn the_picture_is_what_the_example_draws() {
    let server = TestServer::start(&support::service());
    let drawn = contact_sheet::sheet(&server.address.to_string()).expect("a sheet");
    assert_shown("sheet.png", &drawn);
}

/// Whether this is the picture that the README shows.
fn assert_shown(name: &str, drawn: &image::RgbaImage) {
    let path = support::places::repository("docs/images").join(name);
    let shown = image::open(path).expect("the picture").into_rgba8();
    assert_eq!(drawn.dimensions(), shown.dimensions(), "{name}");
    let differs = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 8)
    };
    let differing = drawn.pixels().zip(shown.pixels()).filter(differs).count();
    // Drivers differ at silhouettes, and nowhere else by this much.
    let most = shown.pixels().len() / 500;
    assert!(
        differing <= most,
        "{differing} pixels of {name} differ: run `make demo`, then cp out/{name} docs/images/"
    );
}
