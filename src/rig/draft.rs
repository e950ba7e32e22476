//! What readers fill: plain fields, and what can be wrong with them. Never lives here: the checks, which are in `build`.

use super::{
    Curve, DofKind, FileLight, LARGEST_COORDINATE, Limit, Material, Rotation, RotationOrder,
    Warnings,
};
use crate::limits::LimitExceeded;
use glam::{DAffine3, DQuat, DVec3, Vec2, Vec3, Vec4};
use std::sync::Arc;

/// A character as a reader found it: plain fields, nothing checked.
#[derive(Debug, Default)]
pub struct Draft {
    /// The file of the joints, and of every part that names none of its own. Errors of [`Draft::build`] name it.
    pub file: Option<Arc<str>>,
    /// In file order, parents before children.
    pub joints: Vec<JointDraft>,
    /// In load order, which [`MorphDraft::mesh`] counts by.
    pub meshes: Vec<MeshDraft>,
    /// What the influences of all meshes point at.
    pub bindings: Vec<BindingDraft>,
    /// What parts of meshes name by index; names may be empty or repeated.
    pub materials: Vec<Material>,
    /// Names of choices of materials; empty where the file gives none.
    pub variants: Vec<String>,
    /// Lights of the files; names may be empty or repeated.
    pub lights: Vec<FileLight>,
    /// In load order.
    pub morphs: Vec<MorphDraft>,
    /// In load order.
    pub clips: Vec<ClipDraft>,
    /// What the readers found odd; building adds to it.
    pub warnings: Warnings,
}

/// A joint as a file has it. Lengths in the rig's units, angles in radians.
#[derive(Debug, Clone)]
pub struct JointDraft {
    /// Empty where the file gives none.
    pub name: String,
    /// Index into [`Draft::joints`], before this joint's own; `None` of a root.
    pub parent: Option<usize>,
    /// From the parent's origin to this joint's, in the parent's frame.
    pub offset: DVec3,
    /// In which order its three angles are multiplied.
    pub rotation_order: RotationOrder,
    /// Its local rotation in the file's own pose. Angles outside of `rotation_limits` are clamped into them.
    pub rest_rotation: Rotation,
    /// Its local scale in the file's own pose, along the joint's own axes.
    pub rest_scale: DVec3,
    /// About x, y and z.
    pub rotation_limits: [Limit; 3],
    /// Whether it has translation DOFs besides the rotations.
    pub translates: bool,
    /// Whether it has scale DOFs besides the rotations.
    pub scales: bool,
    /// Two opposite corners, in any order.
    pub bounding_box: Option<[DVec3; 2]>,
}

impl Default for JointDraft {
    /// A root at the origin, unnamed, that turns freely.
    fn default() -> Self {
        Self {
            name: String::new(),
            parent: None,
            offset: DVec3::ZERO,
            rotation_order: RotationOrder::default(),
            rest_rotation: Rotation::NONE,
            rest_scale: DVec3::ONE,
            rotation_limits: [Limit::NONE; 3],
            translates: false,
            scales: false,
            bounding_box: None,
        }
    }
}

/// A joint and its bind pose.
#[derive(Debug, Clone)]
pub struct BindingDraft {
    /// Where the bind pose is from, if not from [`Draft::file`].
    pub file: Option<Arc<str>>,
    /// `None` binds to the world.
    pub joint: Option<usize>,
    /// Where the joint, or the world, stood when the mesh was bound to it.
    pub bind_pose: BindPose,
}

/// The transform of a joint when a mesh was bound to it, in the form that a file gives it in.
#[derive(Debug, Clone, Copy)]
pub enum BindPose {
    /// The joint's transform; its inverse is taken when the rig is built.
    BindFromJoint(DAffine3),
    /// The inverse bind matrix. One that flattens is fine.
    JointFromBind(DAffine3),
}

/// A mesh as a file has it, in bind space.
#[derive(Debug, Default)]
pub struct MeshDraft {
    /// If it is not [`Draft::file`].
    pub file: Option<Arc<str>>,
    /// Empty where the file gives none.
    pub name: String,
    /// One per vertex of the file, in the rig's units.
    pub positions: Vec<Vec3>,
    /// Vertices that are drawn beside those that have positions, for what one place of a surface has several of: of each, which vertex
    /// it is a copy of. They are numbered behind those, and have normals, texture coordinates and colors of their own.
    pub copies: Vec<u32>,
    /// Of any length; computed (area-weighted, smooth) where the file gives none.
    pub normals: Option<Vec<Vec3>>,
    /// `v` is 0 at the bottom of a picture.
    pub texcoords: Option<Vec<Vec2>>,
    /// Linear RGB and opacity, which multiply the material's.
    pub colors: Option<Vec<Vec4>>,
    /// Number of influences of each vertex; empty leaves every vertex where it was modelled.
    pub influence_counts: Vec<u32>,
    /// `(index into Draft::bindings, weight)` of every vertex, one vertex after another.
    pub influences: Vec<(u32, f64)>,
    /// Of vertices and copies.
    pub triangles: Vec<[u32; 3]>,
    /// Of all triangles, one part after another. Empty: a single part without a material.
    pub parts: Vec<PartDraft>,
    /// What is made of something else in a variant; of several of one part and variant the first counts.
    pub in_variants: Vec<PartInVariant>,
}

/// What a part of a mesh is made of in one of the file's variants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartInVariant {
    /// Index into [`MeshDraft::parts`].
    pub part: usize,
    /// Index into [`Draft::variants`].
    pub variant: usize,
    /// Index into [`Draft::materials`].
    pub material: usize,
}

/// Triangles of a mesh that are made of one material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartDraft {
    /// Triangles of the mesh that follow those of the parts before it.
    pub triangle_count: usize,
    /// Index into [`Draft::materials`].
    pub material: Option<usize>,
    /// Lit by each triangle's own normal.
    pub is_flat: bool,
}

/// A sparse morph target of one mesh.
#[derive(Debug, Default)]
pub struct MorphDraft {
    /// If it is not [`Draft::file`].
    pub file: Option<Arc<str>>,
    /// Empty where the file gives none.
    pub name: String,
    /// Index into [`Draft::meshes`].
    pub mesh: usize,
    /// Whether `positions` and `normals` hold what is reached at weight 1, or what is added to get there.
    pub form: MorphForm,
    /// `(vertex, where it is at weight 1, or how far from where it was)` in bind space, as `form` says; each vertex at most once, those left out stay.
    pub positions: Vec<(u32, Vec3)>,
    /// `(vertex, its normal at weight 1, or what is added to it)`, as [`MorphDraft::positions`].
    pub normals: Vec<(u32, Vec3)>,
    /// Weight in the file's own pose.
    pub rest: f64,
}

/// What a morph target lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MorphForm {
    /// Where vertices come to lie.
    #[default]
    Targets,
    /// By how much they differ from the mesh's own.
    Displacements,
}

/// An animation: curves that set DOFs. It needs no skeleton before the rig is built.
#[derive(Debug, Default)]
pub struct ClipDraft {
    /// If it is not [`Draft::file`].
    pub file: Option<Arc<str>>,
    /// Empty where the file gives none.
    pub name: String,
    /// From when to when it is meant to be played, in seconds.
    pub range: [f64; 2],
    /// What it sets, each DOF or rotation by a curve of its own.
    pub channels: Vec<ChannelDraft>,
}

/// A curve and what it sets.
#[derive(Debug)]
pub enum ChannelDraft {
    /// Sets one DOF.
    Dof {
        /// Which DOF of the rig.
        target: ChannelTarget,
        /// In the DOF's unit.
        curve: Curve<f64>,
    },
    /// The whole rotation of a joint.
    Rotation {
        /// Index into [`Draft::joints`].
        joint: usize,
        /// Of the local rotation; with [`Interpolation::Linear`](super::Interpolation::Linear) its values are of unit length.
        curve: Curve<DQuat>,
    },
}

/// The DOF that a channel sets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChannelTarget {
    /// One that the rig has.
    Dof(DofKind),
    /// By [`Dof::name`](super::Dof::name). A channel whose name no DOF of the rig has is left out with a warning.
    Named(String),
}

impl ChannelDraft {
    pub(super) fn key_count(&self) -> usize {
        match self {
            Self::Dof { curve, .. } => curve.keys.len(),
            Self::Rotation { curve, .. } => curve.keys.len(),
        }
    }
}

/// Why a draft is not a rig.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct RigError {
    /// The file of the part at fault; `None` where the draft names none.
    pub file: Option<Arc<str>>,
    /// What is wrong in that file.
    pub problem: RigProblem,
}

/// What is wrong with a draft.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RigProblem {
    /// There is nothing to pose or to draw.
    #[error("the rig has neither joints nor meshes")]
    Empty,
    /// A joint's parent is the joint itself or one that stands after it.
    #[error("joint {joint} names parent {parent}, but parents stand before their children")]
    ParentNotBefore {
        /// Index of the joint.
        joint: usize,
        /// Index of the parent that it names.
        parent: usize,
    },
    /// A number is infinite, not a number, or too large.
    #[error("{what} is not a finite number below {LARGEST_COORDINATE:e}")]
    NotFinite {
        /// The number and whose it is, as in "a weight of mesh `body`".
        what: String,
    },
    /// A light whose numbers no light can have.
    #[error(
        "light `{light}`: expected a color from 0 to 1, an intensity from 0 to {:e} and 0 <= inner angle < outer angle <= π/2",
        FileLight::MOST_INTENSITY
    )]
    LightOutOfRange {
        /// Its name.
        light: String,
    },
    /// A range of an angle that holds no value.
    #[error(
        "joint {joint} has a limit from {min} to {max}: the smallest value is above the largest"
    )]
    LimitReversed {
        /// Index of the joint.
        joint: usize,
        /// The lower end, in radians.
        min: f64,
        /// The upper end, in radians.
        max: f64,
    },
    /// A [`BindPose::BindFromJoint`] has no inverse, or one with numbers beyond [`LARGEST_COORDINATE`].
    #[error("binding {binding} has a matrix that cannot be inverted")]
    SingularBinding {
        /// Index into [`Draft::bindings`].
        binding: usize,
    },
    /// A list of a mesh is not as long as it has to be, or its counts do not sum to the length of what they count.
    #[error("mesh {mesh} has {vertices} vertices but {found} {what}")]
    CountsDiffer {
        /// Index into [`Draft::meshes`].
        mesh: usize,
        /// How many the mesh has, with copies where the list has to hold those too.
        vertices: usize,
        /// What is counted, in words that follow the number found.
        what: &'static str,
        /// How many there are.
        found: usize,
    },
    /// An index is not below the number of what it counts.
    #[error("{what} names {target} {found}, but there are {count}")]
    OutOfRange {
        /// `triangle 3 of mesh 1`.
        what: String,
        /// What the index counts, as `vertex`.
        target: &'static str,
        /// The index.
        found: usize,
        /// How many there are, so that the largest index is one less.
        count: usize,
    },
    /// A channel names a [`DofKind`] or a joint that the rig does not have.
    #[error("clip {clip} moves a DOF that the rig does not have")]
    NoSuchDof {
        /// Index into [`Draft::clips`].
        clip: usize,
    },
    /// The times of a curve's keys do not strictly increase.
    #[error("clip {clip} has a curve whose keys are not in the order of their times")]
    KeysOutOfOrder {
        /// Index into [`Draft::clips`].
        clip: usize,
    },
    /// A morph target has two positions, or two normals, of one vertex.
    #[error("morph target {morph} lists vertex {vertex} twice")]
    VertexTwice {
        /// Index into [`Draft::morphs`].
        morph: usize,
        /// Index into the positions of its mesh.
        vertex: u32,
    },
    /// The rig is larger than a ceiling allows.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
}

impl RigProblem {
    /// Names the file of the part that has the problem.
    pub(super) fn of(self, file: Option<&Arc<str>>) -> RigError {
        RigError {
            file: file.cloned(),
            problem: self,
        }
    }
}

impl From<RigProblem> for RigError {
    /// A problem of a part that names no file of its own.
    fn from(problem: RigProblem) -> Self {
        problem.of(None)
    }
}

impl From<LimitExceeded> for RigError {
    fn from(exceeded: LimitExceeded) -> Self {
        RigProblem::from(exceeded).into()
    }
}
