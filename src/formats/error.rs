//! Why files did not become a rig: one enum for all readers, and the one form of a fault inside a file.
//! Never lives here: what the wire calls these.

use crate::limits::LimitExceeded;
use std::io;

/// Why [`load`](super::load) gave no rig. `file` is always the name that the request used, never a path of the server's own.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The request lists no file.
    #[error("no files are given")]
    NoFiles,
    /// Two files have the same base name, by which other files refer to them.
    #[error("two of the files are named `{name}`")]
    SameName {
        /// What follows the last slash in both names.
        name: String,
    },
    /// Two of the files, sent or referred to, hold a skeleton.
    #[error("`{first}` and `{second}` are both skeletons, but a rig has at most one")]
    TwoSkeletons {
        /// The one that was met first.
        first: String,
        /// The one that was met after it.
        second: String,
    },
    /// There is nothing at a path of the request.
    #[error("file `{file}` was not found")]
    FileNotFound {
        /// The path as the request has it.
        file: String,
    },
    /// The [`Source`](super::Source) or the system refuses a path of the request, or a name ends in no file name or is too long.
    #[error("file `{file}` may not be opened: {reason}")]
    PathNotAllowed {
        /// The path or name as the request has it, shortened where it is too long.
        file: String,
        /// In words, to follow a colon.
        reason: &'static str,
    },
    /// What a file holds is wrong, or does not go together with the other files.
    #[error(transparent)]
    Invalid(#[from] FileFault),
    /// The files, or the rig that they hold, are larger than a ceiling allows.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
    /// Opening or reading a file of the request failed for any other reason.
    #[error("file `{file}` could not be read: {source}")]
    Io {
        /// The path as the request has it.
        file: String,
        /// The system's own error.
        source: io::Error,
    },
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
    /// What should stand there, in words that follow "expected".
    pub expected: String,
    /// What stands there instead, in words; text of the file is in back quotes.
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
