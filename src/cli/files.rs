//! Files that take their name when they are whole, and the names of several that were asked for as one.
//! Never lives here: what is in them.

use super::terminal;
use anyhow::{Context, bail};
use std::fs::{self, File};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

/// As `--output` names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Destination {
    File(PathBuf),
    /// For `-`.
    StandardOutput,
}

impl Destination {
    /// # Errors
    /// Where it is no name that a file can have, or that of a folder.
    pub(super) fn of(path: &Path) -> anyhow::Result<Self> {
        if path == Path::new("-") {
            return Ok(Self::StandardOutput);
        }
        if !ends_in_name(path) || path.is_dir() {
            let path = path.display();
            bail!("--output: expected the name of a file, but found the folder `{path}`");
        }
        Ok(Self::File(path.to_owned()))
    }
}

/// Not so `out/`, `out/.` and `/`, of which a path makes the same as of `out` or nothing.
fn ends_in_name(path: &Path) -> bool {
    let whole = path.as_os_str().as_encoded_bytes();
    path.file_name()
        .is_some_and(|name| whole.ends_with(name.as_encoded_bytes()))
}

/// Writes what is no text to standard output.
///
/// # Errors
/// Where that is a terminal, which would make nothing of it, or cannot be written.
pub(super) fn write_to_stdout(content: &[u8]) -> anyhow::Result<()> {
    if std::io::stdout().is_terminal() {
        bail!("standard output is a terminal: name a file, or send it on to one");
    }
    terminal::write(content)
}

/// One of several files in place of `path`: `walk_0007.png` for `walk.png` and 7. With four digits, or as many as the last of `count` needs.
pub(super) fn numbered(path: &Path, number: usize, count: usize) -> PathBuf {
    let digits = count.saturating_sub(1).to_string().len().max(4);
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("_{number:0digits$}"));
    if let Some(ending) = path.extension() {
        name.push(".");
        name.push(ending);
    }
    path.with_file_name(name)
}

/// Writes a file that is there as a whole or not at all.
pub(super) fn write(path: &Path, content: &[u8]) -> anyhow::Result<()> {
    let written = || {
        let (unfinished, mut file) = Unfinished::create(path)?;
        file.write_all(content)?;
        unfinished.name()
    };
    written().with_context(|| format!("cannot write {}", path.display()))
}

/// A file beside the one that it is to become. Dropped before it got its name, it is removed.
pub(super) struct Unfinished {
    /// `None` for what is no file but e.g. a pipe, which is written to as it is.
    part: Option<PathBuf>,
    target: PathBuf,
}

impl Unfinished {
    pub(super) fn create(path: &Path) -> std::io::Result<(Self, File)> {
        // A link is not replaced, but what it leads to.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if fs::metadata(&target).is_ok_and(|found| !found.is_file()) {
            let file = File::options().write(true).open(&target)?;
            return Ok((Self { part: None, target }, file));
        }
        // Not made of the file's own name, which may be as long as names can be.
        let part = target.with_file_name(format!(".rigd-{}.part", std::process::id()));
        let file = File::create(&part)?;
        let part = Some(part);
        Ok((Self { part, target }, file))
    }

    pub(super) fn name(mut self) -> std::io::Result<()> {
        if let Some(part) = &self.part {
            fs::rename(part, &self.target)?;
        }
        self.part = None;
        Ok(())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Some(part) = &self.part {
            // Whoever stopped has said why; that this is left over is the lesser trouble.
            let _ = fs::remove_file(part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_files_are_numbered_with_four_digits_or_as_many_as_it_takes() {
        for (path, number, count, name) in [
            ("out/walk.one.png", 0, 1, "out/walk.one_0000.png"),
            ("out/walk.one.png", 9_999, 10_000, "out/walk.one_9999.png"),
            ("out/walk.one.png", 7, 10_001, "out/walk.one_00007.png"),
            ("walk", 12_345, 0, "walk_12345"),
        ] {
            assert_eq!(numbered(path.as_ref(), number, count), Path::new(name));
        }
    }

    #[test]
    fn a_destination_is_a_file_or_standard_output() {
        for path in ["picture", "picture.png", "../picture", ".picture"] {
            let file = Destination::File(path.into());
            assert_eq!(Destination::of(path.as_ref()).unwrap(), file);
        }
        let piped = Destination::of("-".as_ref()).unwrap();
        assert_eq!(piped, Destination::StandardOutput);
        for path in ["", "out/", "out.png/", "out/.", ".", "..", "/", "src"] {
            let error = Destination::of(path.as_ref()).unwrap_err().to_string();
            assert!(error.ends_with(&format!("`{path}`")), "{error}");
        }
    }
}
