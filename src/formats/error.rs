//! Why files did not become a rig: one enum for all readers, and the one form of a fault inside a file.
//! Never lives here: what the wire calls these.

use crate::limits::LimitExceeded;
use std::io;

/// Why [`load`](super::load) gave no rig. `file` is always the name that the request used, never a path of the server's own.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    #[error("no files are given")]
    NoFiles,
    #[error("two of the files are named `{name}`")]
    SameName { name: String },
    #[error("`{first}` and `{second}` are both skeletons, but a rig has at most one")]
    TwoSkeletons { first: String, second: String },
    #[error("file `{file}` was not found")]
    FileNotFound { file: String },
    #[error("file `{file}` may not be opened: {reason}")]
    PathNotAllowed { file: String, reason: &'static str },
    #[error(transparent)]
    Invalid(#[from] FileFault),
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    #[error("file `{file}` could not be read: {source}")]
    Io { file: String, source: io::Error },
}

/// What is wrong in a file, and where: `wasp.skel:41:9: expected a number after `rotxlimit`, but found `abc``.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}:{line}:{column}: expected {expected}, but found {found}")]
pub struct FileFault {
    /// The name that the request used.
    pub file: String,
    /// From 1; a fault of the file as a whole stands at 1:1.
    pub line: usize,
    /// From 1, in characters; a tab is one.
    pub column: usize,
    pub expected: String,
    pub found: String,
}

impl FileFault {
    /// A fault of the file as a whole.
    pub(super) fn whole(
        file: &str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> FileFault {
        let (expected, found) = (expected.into(), found.into());
        FileFault {
            file: file.to_owned(),
            line: 1,
            column: 1,
            expected,
            found,
        }
    }
}

/// A piece of a file between back quotes, short and on one line whatever it is.
pub(super) fn quoted(text: &str) -> String {
    /// Enough to recognise a word by; a file may hold one of many megabytes.
    const SHOWN: usize = 40;
    let mut shown = String::new();
    for c in text.chars().take(SHOWN) {
        if c.is_control() {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    let whole = text.chars().nth(SHOWN).is_none();
    format!("`{shown}{}`", if whole { "" } else { "…" })
}
