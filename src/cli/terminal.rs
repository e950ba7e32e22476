//! Writing to standard output and standard error, which may be a terminal, a pipe that closes, or a full disk.
//! Never lives here: what is said.

use anyhow::Context;
use std::io::{ErrorKind, Write, stderr, stdout};

/// Text as a terminal may have it: names come from files, and may hold what a terminal would obey.
pub(super) fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() && c != '\n' {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Writes a line to standard output.
///
/// # Errors
/// As [`write()`].
pub(super) fn print(line: &str) -> anyhow::Result<()> {
    print_to_reader(line).map(|_| ())
}

/// As [`print()`]; whether anybody still reads.
///
/// # Errors
/// As [`write()`].
pub(super) fn print_to_reader(line: &str) -> anyhow::Result<bool> {
    let written = stdout().write_all(format!("{line}\n").as_bytes());
    is_read(written.and_then(|()| flush()))
}

/// Writes to standard output, and does not wait for a line end.
///
/// # Errors
/// Where it cannot be written. A reader that has seen enough and closed its end is no failure.
pub(super) fn write(bytes: &[u8]) -> anyhow::Result<()> {
    settle(stdout().write_all(bytes).and_then(|()| flush()))
}

pub(super) fn flush() -> std::io::Result<()> {
    stdout().flush()
}

/// What is made of the outcome of writing to standard output.
///
/// # Errors
/// As [`write()`].
pub(super) fn settle(written: std::io::Result<()>) -> anyhow::Result<()> {
    is_read(written).map(|_| ())
}

/// Whether the reader is still there.
fn is_read(written: std::io::Result<()>) -> anyhow::Result<bool> {
    match written {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(error).context("cannot write to standard output"),
    }
}

/// Writes a line to standard error. Where that fails there is nobody left to tell.
pub(super) fn note(line: &str) {
    let _ = writeln!(stderr(), "{}", printable(line));
}

/// Warnings, and how many were told.
#[derive(Debug, Default)]
pub(super) struct Warnings {
    count: usize,
}

impl Warnings {
    pub(super) fn tell(&mut self, warning: &str) {
        note(&format!("warning: {warning}"));
        self.count += 1;
    }

    /// Counts those that the output tells of itself.
    pub(super) fn count(&mut self, told: usize) {
        self.count += told;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }
}
