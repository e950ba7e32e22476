//! The rig that is there when no file is given: a figure of the project's own, written by `assets/figure`.

use crate::formats::{File, FileRef};
use std::path::Path;

macro_rules! assets {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_bytes!(concat!("../../assets/", $name)).as_slice())),*]
    };
}

/// The list of files comes first, for the rig has its name.
const FIGURE: [(&str, &[u8]); 7] = assets![
    "figure.rig",
    "figure.skel",
    "figure.skin",
    "figure.png",
    "smile.morph",
    "blink.morph",
    "walk.anim",
];

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
    figure()
}

/// The files of the built-in figure.
pub fn figure() -> Vec<FileRef> {
    let file = |(name, bytes): (&str, &[u8])| {
        FileRef::Inline(File {
            name: name.to_owned(),
            bytes: bytes.into(),
        })
    };
    FIGURE.map(file).into()
}
