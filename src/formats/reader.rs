//! A row of the table of readers. Never lives here: the rows.

use super::context::Context;
use super::contribution::{KnownMesh, KnownSkeleton, ListEntry, LooseClip, MeshPart, Weights};
use super::error::LoadError;
use super::files::Gathered;
use super::format::Format;
use crate::rig::{Draft, JointDraft, MorphDraft};

#[derive(Debug)]
pub(super) struct Reader {
    pub format: &'static Format,
    pub contribution: Contribution,
}

/// What a file of a format is to a rig, and the function that reads it. Files are read in this order, so that a reader is given what it
/// depends on.
#[derive(Debug)]
pub(super) enum Contribution {
    /// The names of other files of the rig. One in a request.
    List(Read<Vec<ListEntry>>),
    /// All of a rig. No other rig file stands beside it.
    Whole(Read<Draft>),
    /// One in a rig.
    Skeleton(Read<Vec<JointDraft>>),
    Mesh(MeshReader),
    /// One in a rig.
    Weights(WeightsReader),
    Morph(MorphReader),
    /// An animation. It is read without a skeleton and bound to the one of the rig.
    Clip(Read<LooseClip>),
}

pub(super) type Read<T> = fn(&Gathered, &mut Context) -> Result<T, LoadError>;

#[derive(Debug, Clone, Copy)]
pub(super) enum MeshReader {
    /// The file binds its mesh to the skeleton, if there is one.
    Bound(fn(&Gathered, &mut Context, Option<KnownSkeleton>) -> Result<MeshPart, LoadError>),
    /// The file says nothing of joints. Where there is a skeleton there have to be weights.
    Unbound(Read<MeshPart>),
}

/// Of a file that binds the one mesh of a format to a skeleton of a format.
#[derive(Debug, Clone, Copy)]
pub(super) struct WeightsReader {
    pub mesh: &'static Format,
    pub skeleton: &'static Format,
    pub read: fn(&Gathered, &mut Context, KnownMesh, KnownSkeleton) -> Result<Weights, LoadError>,
}

/// Of a morph target of the one mesh of a format.
#[derive(Debug, Clone, Copy)]
pub(super) struct MorphReader {
    pub mesh: &'static Format,
    pub read: fn(&Gathered, &mut Context, KnownMesh) -> Result<MorphDraft, LoadError>,
}
