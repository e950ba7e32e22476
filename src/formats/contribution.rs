//! What one file contributes to a rig, and what it may have to know of files read before it.
//! Never lives here: reading files, and putting their contributions together.

use super::error::{FileFault, quoted};
use super::format::Format;
use crate::rig::{BindingDraft, ClipDraft, JointDraft, Material, MeshDraft};

/// A mesh with what it refers to.
#[derive(Debug, Default)]
pub(super) struct MeshPart {
    /// Materials of its parts are indices into `materials`, those of its influences into `bindings`.
    pub mesh: MeshDraft,
    pub materials: Vec<Material>,
    pub bindings: Vec<BindingDraft>,
}

/// The influences of a mesh from a file of their own.
#[derive(Debug, Default)]
pub(super) struct Weights {
    /// As in [`MeshDraft`].
    pub influence_counts: Vec<u32>,
    /// As in [`MeshDraft`], but with indices into `bindings`.
    pub influences: Vec<(u32, f64)>,
    pub bindings: Vec<BindingDraft>,
}

/// A clip that was read without a skeleton.
#[derive(Debug)]
pub(super) struct LooseClip {
    pub clip: ClipDraft,
    /// Where the file says how many channels it has (`file:line:column`), if there is to be one for each DOF of the skeleton. What fits the
    /// skeleton is used, with a warning.
    pub channels_counted_at: Option<String>,
}

/// A file that a list names.
#[derive(Debug)]
pub(super) struct ListEntry {
    /// What it is to be.
    pub format: &'static Format,
    pub file: String,
    /// Where the list names it.
    pub line: usize,
    pub column: usize,
}

impl ListEntry {
    /// What is due at the entry: a file of its format.
    pub(super) fn expected(&self) -> String {
        format!("{} to be {}", quoted(&self.file), self.format.what)
    }

    /// A fault at the entry's place in the list called `list`.
    pub(super) fn fault(
        &self,
        list: &str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> FileFault {
        FileFault {
            line: self.line,
            column: self.column,
            ..FileFault::whole(list, expected, found)
        }
    }
}

/// The skeleton of the rig, for a file that is read with it.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownSkeleton<'a> {
    pub file: &'a str,
    pub joints: &'a [JointDraft],
}

/// The mesh that a file is for.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownMesh<'a> {
    pub file: &'a str,
    pub vertex_count: usize,
}
