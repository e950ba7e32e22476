//! The daemon as users run it: a process of its own, with the built-in figure loaded. Never lives here: what it is asked.

use std::io::{BufRead, BufReader, Lines};
use std::net::SocketAddr;
use std::process::{Child, ChildStdout, Command, Stdio};

/// Serves until it is dropped.
pub struct DaemonProcess {
    pub address: SocketAddr,
    child: Child,
    /// Open for as long as it may say something.
    _said: Lines<BufReader<ChildStdout>>,
}

impl DaemonProcess {
    pub fn start(adapter: &str) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_rigd"))
            .args(["serve", "--listen", "127.0.0.1:0", "--adapter", adapter])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("it can be started");
        let said = child.stdout.take().expect("it is piped");
        let mut lines = BufReader::new(said).lines();
        let line = lines.next().expect("it says where it listens");
        let line = line.expect("it is text");
        let address = line.rsplit(' ').next().expect("the last word");
        Self {
            address: address.parse().expect("an address"),
            child,
            _said: lines,
        }
    }

    /// Resident memory, in bytes.
    pub fn resident_bytes(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id()));
        let status = status.unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
        1024 * kilobytes.unwrap_or(0)
    }
}

impl Drop for DaemonProcess {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
