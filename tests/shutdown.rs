//! Does a server that is told to stop answer everybody who had asked, and then go?

mod support;

use rigd::server::Timeouts;
use rigd::service::Service;
use serde_json::{Value, json};
use std::io::{self, BufRead, BufReader, Read};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};
use support::server::{PATIENCE, TestServer, Wire, assert_is_png, picture, png};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// More than a connection may have in flight, so that some are still unread when the stop comes.
const MANY: usize = 100;

#[test]
fn requests_that_had_arrived_are_answered_with_their_results() {
    let mut server = TestServer::start(&SERVICE);
    let mut wires = [server.connect(), server.connect()];
    for wire in &mut wires {
        for id in 0..MANY {
            wire.request(id, "frame.render", picture(32));
        }
    }
    for wire in &mut wires {
        assert_is_png(&png(&wire.result(0)), 32);
    }
    server.stop();
    for wire in &mut wires {
        for id in 1..MANY {
            assert_is_png(&png(&wire.result(id)), 32);
        }
        wire.assert_end();
    }
    server.wait().expect("a stop is no failure");
}

#[test]
fn once_the_grace_time_is_over_what_is_left_is_told_so() {
    let timeouts = Timeouts {
        grace: Duration::ZERO,
        ..Timeouts::default()
    };
    let mut server = TestServer::start_with(&SERVICE, timeouts);
    let mut wire = server.connect();
    for id in 0..MANY {
        wire.request(id, "frame.render", picture(256));
    }
    wire.result(0);
    server.stop();
    let mut refused = 0;
    for id in 1..MANY {
        let mut reply = wire.reply();
        assert_eq!(reply["id"], id, "every request is answered in its place");
        if reply.get("error").is_some() {
            let wanted = json!({"kind": "shutting_down", "retryable": true});
            assert_eq!(reply["error"]["data"].take(), wanted);
            refused += 1;
        }
    }
    wire.assert_end();
    assert!(refused > 0, "all of them were drawn");
    server.wait().expect("a stop is no failure");
}

#[test]
fn a_client_that_goes_on_asking_does_not_keep_the_server() {
    let timeouts = Timeouts {
        grace: Duration::from_millis(200),
        ..Timeouts::default()
    };
    let mut server = TestServer::start_with(&SERVICE, timeouts);
    let mut wire = server.connect();
    let mut writer = wire.writer();
    wire.assert_alive();
    let asking = std::thread::spawn(move || {
        use std::io::Write;
        let line = support::server::request(1, "server.ping", json!({}));
        while writer.write_all(line.as_bytes()).is_ok() {}
    });
    let reading = std::thread::spawn(move || {
        let mut rest = Vec::new();
        // It may end in a reset: this client was told to stop by the end of the replies, and did not.
        let _ = wire.reader().read_to_end(&mut rest);
    });
    std::thread::sleep(Duration::from_millis(50));
    server.stop();
    server.wait().expect("a stop is no failure");
    asking.join().expect("writing goes wrong quietly");
    reading.join().expect("reading goes wrong quietly");
}

#[test]
fn a_client_that_does_not_read_does_not_keep_the_server() {
    let timeouts = Timeouts {
        grace: Duration::from_millis(200),
        ..Timeouts::default()
    };
    let mut server = TestServer::start_with(&SERVICE, timeouts);
    let mut wire = server.connect();
    // Some 22 MB each as text: more than the buffers between the two take.
    let mut large = picture(2048);
    large["image"] = json!("rgba8");
    for id in 0..3 {
        wire.request(id, "frame.render", large.clone());
    }
    // The first of them is on its way.
    wire.bytes(1);
    server.stop();
    server.wait().expect("a stop is no failure");
}

#[test]
fn idle_connections_are_closed_without_waiting_for_the_grace_time() {
    let timeouts = Timeouts {
        grace: 10 * PATIENCE,
        ..Timeouts::default()
    };
    let server = TestServer::start_with(&SERVICE, timeouts);
    let mut idle: Vec<Wire> = (0..8).map(|_| server.connect()).collect();
    for wire in &mut idle {
        wire.assert_alive();
    }
    // One of them stops in the middle of a line, another in the middle of raw bytes.
    idle[0].send("{\"jsonrpc\":");
    idle[1].send("{\"jsonrpc\":\"2.0\",\"attach_bytes\":9}\nx");
    server.stop();
    for wire in &mut idle {
        wire.assert_end();
    }
}

#[test]
fn nobody_new_is_let_in_while_the_last_are_answered() {
    let mut server = TestServer::start(&SERVICE);
    let mut wire = server.connect();
    for id in 0..MANY {
        wire.request(id, "frame.render", picture(256));
    }
    wire.result(0);
    server.stop();
    // The stop is heard at once, but not before this thread goes on.
    until_nobody_is_let_in(server.address);
    assert!(
        server.is_running(),
        "it was done too soon for this test to tell"
    );
    for id in 1..MANY {
        wire.result(id);
    }
    wire.assert_end();
    server.wait().expect("a stop is no failure");
    assert!(TcpStream::connect(server.address).is_err());
}

fn until_nobody_is_let_in(address: SocketAddr) {
    let end = Instant::now() + PATIENCE;
    // A full backlog is no refusal: whoever comes is left waiting.
    let attempt = || TcpStream::connect_timeout(&address, Duration::from_millis(100));
    while attempt().map_err(|error| error.kind()).err() != Some(io::ErrorKind::ConnectionRefused) {
        assert!(Instant::now() < end, "it lets anybody in");
        std::thread::yield_now();
    }
}

#[test]
fn whoever_connected_before_the_stop_is_answered() {
    let mut server = TestServer::start(&SERVICE);
    for _ in 0..20 {
        let mut wire = server.connect();
        wire.request(1, "server.ping", json!({}));
        server.stop();
        assert_eq!(wire.result(1), json!({}));
        wire.assert_end();
        // A server waits a while for its clients to close, too.
        drop(wire);
        server.wait().expect("a stop is no failure");
        server = TestServer::start(&SERVICE);
    }
}

/// The program itself, killed when a test fails.
struct Daemon {
    child: Child,
    stdout: BufReader<ChildStdout>,
    address: SocketAddr,
}

impl Daemon {
    fn start() -> Self {
        let adapter = support::adapters::adapter();
        let mut child = Command::new(env!("CARGO_BIN_EXE_rigd"))
            .args(["serve", "--listen", "127.0.0.1:0", "--adapter", &adapter])
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut stdout = BufReader::new(child.stdout.take().expect("it is piped"));
        let mut line = String::new();
        stdout.read_line(&mut line).expect("a line");
        let address = line.trim_end().rsplit(' ').next().unwrap_or_default();
        let address = address
            .parse()
            .unwrap_or_else(|_| panic!("no address in {line:?}"));
        Self {
            child,
            stdout,
            address,
        }
    }

    fn signal(&self, name: &str) {
        let status = Command::new("kill")
            .args(["-s", name, &self.child.id().to_string()])
            .status()
            .expect("there is a `kill`");
        assert!(status.success());
    }

    fn wait(&mut self) -> ExitStatus {
        let end = Instant::now() + PATIENCE;
        loop {
            if let Some(status) = self.child.try_wait().expect("it is our child") {
                return status;
            }
            assert!(Instant::now() < end, "it does not go");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
#[cfg(unix)]
fn a_signal_ends_the_program_after_the_pictures_in_hand() {
    for signal in ["TERM", "INT"] {
        let mut daemon = Daemon::start();
        let mut wire = Wire::connect(daemon.address);
        // The rig that it serves when none is named.
        wire.request("rigs", "rig.list", json!({}));
        let rig: Value = wire.result("rigs")["rigs"][0]["name"].take();
        let picture = json!({"rig": rig, "size": [256, 256]});
        for id in 0..20 {
            wire.request(id, "frame.render", picture.clone());
        }
        assert_is_png(&png(&wire.result(0)), 256);
        daemon.signal(signal);
        for id in 1..20 {
            assert_is_png(&png(&wire.result(id)), 256);
        }
        wire.assert_end();
        drop(wire);
        let status = daemon.wait();
        assert_eq!(status.code(), Some(0), "SIG{signal}: {status}");
        let mut rest = String::new();
        daemon
            .stdout
            .read_to_string(&mut rest)
            .expect("nothing but text");
        assert_eq!(rest.lines().count(), 1, "{rest}");
    }
}

#[test]
#[cfg(unix)]
fn a_second_signal_does_not_wait() {
    let mut daemon = Daemon::start();
    let mut wire = Wire::connect(daemon.address);
    wire.request("rigs", "rig.list", json!({}));
    let rig: Value = wire.result("rigs")["rigs"][0]["name"].take();
    for id in 0..30 {
        wire.request(
            id,
            "frame.render",
            json!({"rig": rig, "size": [4096, 4096], "compression": "best"}),
        );
    }
    wire.result(0);
    daemon.signal("INT");
    // Two signals that arrive at once are one: the first was heard once nobody is let in any more.
    until_nobody_is_let_in(daemon.address);
    daemon.signal("INT");
    assert_eq!(daemon.wait().code(), Some(130));
}
