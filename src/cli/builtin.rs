//! The rig that is there when no file is given: a figure of the project's own, written by `assets/figure.rs`.

use crate::formats::{File, FileRef};
use std::path::Path;

const NAME: &str = "figure";
const SKEL: &[u8] = include_bytes!("../../assets/figure.skel");
const SKIN: &[u8] = include_bytes!("../../assets/figure.skin");

/// The files to work with: those named, else test.skel and test.skin of the current folder, else the built-in figure.
pub(super) fn files_or_default(named: &[String]) -> Vec<FileRef> {
    if !named.is_empty() {
        return named.iter().cloned().map(FileRef::Path).collect();
    }
    let tests = ["test.skel", "test.skin"]
        .into_iter()
        .filter(|name| Path::new(name).is_file());
    let tests: Vec<_> = tests.map(|name| FileRef::Path(name.to_owned())).collect();
    if !tests.is_empty() {
        return tests;
    }
    [("skel", SKEL), ("skin", SKIN)]
        .map(|(extension, bytes)| {
            FileRef::Inline(File {
                name: format!("{NAME}.{extension}"),
                bytes: bytes.into(),
            })
        })
        .into()
}
