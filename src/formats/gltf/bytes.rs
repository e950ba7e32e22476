//! Bytes of a document wherever they are kept. Never lives here: where they come from.

use std::ops::Deref;
use std::sync::Arc;

/// Bytes that lie in the document's own file, or others that were decoded or read for it.
#[derive(Debug, Clone)]
pub(super) enum Bytes<'a> {
    InFile(&'a [u8]),
    Shared(Arc<[u8]>),
}

impl Deref for Bytes<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::InFile(bytes) => bytes,
            Self::Shared(bytes) => bytes,
        }
    }
}
