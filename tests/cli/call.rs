//! `call` and `serve`: a daemon, what is asked of it, and what is saved of its replies.

use crate::{ADAPTER, folder, left_over, picture, rigd, text};
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::process::{Command, Output, Stdio};

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
