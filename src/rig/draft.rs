//! What readers fill: plain fields, and what can be wrong with them. Never lives here: the checks, which are in `build`.

use super::{Curve, DofKind, LARGEST_COORDINATE, Limit, Material, RotationOrder, Warnings};
use crate::limits::LimitExceeded;
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// A character as a reader found it: plain fields, nothing checked.
#[derive(Debug, Default)]
pub struct Draft {
    /// In file order, parents before children.
    pub joints: Vec<JointDraft>,
    pub meshes: Vec<MeshDraft>,
    /// What the influences of all meshes point at.
    pub bindings: Vec<BindingDraft>,
    pub materials: Vec<Material>,
    /// In load order.
    pub morphs: Vec<MorphDraft>,
    pub clips: Vec<ClipDraft>,
    pub warnings: Warnings,
}

#[derive(Debug, Clone)]
pub struct JointDraft {
    /// Empty where the file gives none.
    pub name: String,
    pub parent: Option<usize>,
    pub offset: DVec3,
    pub rotation_order: RotationOrder,
    pub rest_angles: DVec3,
    pub rotation_limits: [Limit; 3],
    pub translates: bool,
    /// Two opposite corners, in any order.
    pub bounding_box: Option<[DVec3; 2]>,
}

/// A joint as it stood when a mesh was bound to it.
#[derive(Debug, Clone, Copy)]
pub struct BindingDraft {
    /// `None` binds to the world.
    pub joint: Option<usize>,
    /// The joint's transform at bind time; its inverse is taken here.
    pub bind_from_joint: DAffine3,
}

#[derive(Debug, Default)]
pub struct MeshDraft {
    /// Empty where the file gives none.
    pub name: String,
    pub positions: Vec<Vec3>,
    /// Of any length; computed (area-weighted, smooth) where the file gives none.
    pub normals: Option<Vec<Vec3>>,
    pub texcoords: Option<Vec<Vec2>>,
    /// Number of influences of each vertex; empty leaves every vertex where it was modelled.
    pub influence_counts: Vec<u32>,
    /// `(index into Draft::bindings, weight)` of every vertex, one vertex after another.
    pub influences: Vec<(u32, f64)>,
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Draft::materials`].
    pub material: Option<usize>,
}

/// A sparse morph target of one mesh.
#[derive(Debug, Default)]
pub struct MorphDraft {
    /// Empty where the file gives none.
    pub name: String,
    /// Index into [`Draft::meshes`].
    pub mesh: usize,
    /// `(vertex, where it is at weight 1)` in bind space; each vertex at most once, those left out stay.
    pub positions: Vec<(u32, Vec3)>,
    /// `(vertex, its normal at weight 1)`, as [`MorphDraft::positions`].
    pub normals: Vec<(u32, Vec3)>,
    /// Weight in the file's own pose.
    pub rest: f64,
}

/// An animation: curves that set DOFs.
#[derive(Debug, Default)]
pub struct ClipDraft {
    /// Empty where the file gives none.
    pub name: String,
    /// From when to when it is meant to be played, in seconds.
    pub range: [f64; 2],
    pub channels: Vec<ChannelDraft>,
}

#[derive(Debug)]
pub struct ChannelDraft {
    /// One that the rig has.
    pub target: DofKind,
    pub curve: Curve,
}

/// Why a draft is not a rig.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RigError {
    #[error("the rig has neither joints nor meshes")]
    Empty,
    #[error("joint {joint} names parent {parent}, but parents stand before their children")]
    ParentNotBefore { joint: usize, parent: usize },
    #[error("joint {joint} is a second root, but a skeleton has one")]
    SecondRoot { joint: usize },
    #[error("{what} is not a finite number below {LARGEST_COORDINATE:e}")]
    NotFinite {
        what: String,
        /// Of which mesh it is, or which mesh is bound by it; `None` for one of the skeleton.
        mesh: Option<usize>,
    },
    #[error(
        "joint {joint} has a limit from {min} to {max}: the smallest value is above the largest"
    )]
    LimitReversed { joint: usize, min: f64, max: f64 },
    #[error("binding {binding} has a matrix that cannot be inverted")]
    SingularBinding { binding: usize },
    #[error("mesh {mesh} has {vertices} vertices but {found} {what}")]
    CountsDiffer {
        mesh: usize,
        vertices: usize,
        what: &'static str,
        found: usize,
    },
    #[error("{what} {index} of mesh {mesh} names {target} {found}, but there are {count}")]
    OutOfRange {
        mesh: usize,
        what: &'static str,
        index: usize,
        target: &'static str,
        found: usize,
        count: usize,
    },
    #[error("clip {clip} moves a DOF that the rig does not have")]
    NoSuchDof { clip: usize },
    #[error("clip {clip} has a curve whose keys are not in the order of their times")]
    KeysOutOfOrder { clip: usize },
    #[error("morph target {morph} lists vertex {vertex} twice")]
    VertexTwice { morph: usize, vertex: u32 },
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
}
