//! Where tests find the repository's files and where they write. Never lives here: what is in them.

use std::path::{Path, PathBuf};

/// A file of the repository: of the folder that `RIGD_REPOSITORY` names, for tests that run on another machine than they were built on,
/// or of the one that this was built in.
pub fn repository(path: &str) -> PathBuf {
    moved()
        .unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")))
        .join(path)
}

/// A folder for what a test writes.
pub fn output(path: &str) -> PathBuf {
    let folder = moved().map(|folder| folder.join("out"));
    folder
        .unwrap_or_else(|| Path::new(env!("CARGO_TARGET_TMPDIR")).to_owned())
        .join(path)
}

fn moved() -> Option<PathBuf> {
    std::env::var_os("RIGD_REPOSITORY").map(PathBuf::from)
}
