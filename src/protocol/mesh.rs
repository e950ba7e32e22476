//! `mesh.*`: skinned vertices, and how they hang together.
//! Never lives here: the arrays themselves; they travel as blobs.

use super::blob::{ArrayTransport, Blob};
use super::frame::{Skinning, Timings};
use super::pose::{Clamped, Pose};
use super::rig::{Bounds, MeshPart};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Asks for vertices, in world space, in the order of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerticesParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
    /// A pose for this request alone. Without it, as if it were `{}`.
    #[serde(default)]
    pub pose: Pose,
    /// By which rule a vertex follows several joints. Without it, `linear`.
    #[serde(default)]
    pub skinning: Skinning,
    /// Whether the vertices follow the pose.
    #[serde(default)]
    pub state: VertexState,
    /// What to send of each vertex.
    #[serde(default = "all_attributes")]
    pub attributes: Vec<Attribute>,
    /// Name of the only mesh to send. Without it, all of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    /// A part of one mesh. A rig with several meshes needs `mesh` beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<Range>,
    /// How the arrays travel. Without it, `json`.
    #[serde(default)]
    pub transport: ArrayTransport,
}

fn all_attributes() -> Vec<Attribute> {
    vec![Attribute::Positions, Attribute::Normals]
}

/// Whether vertices follow the pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VertexState {
    /// They do.
    #[default]
    Posed,
    /// They are where they were modelled, whatever the pose.
    Bind,
}

/// What there is of a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Attribute {
    /// Points in world space, in the rig's units.
    Positions,
    /// Directions in world space, of unit length.
    Normals,
}

/// Some vertices of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// Index of the first one.
    pub start: u64,
    /// How many.
    pub count: u64,
}

/// Skinned vertices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Vertices {
    /// In the order of `rig.describe`; only the one that the request's `mesh` names, where it names one.
    pub meshes: Vec<MeshVertices>,
    /// Of the vertices in this answer.
    pub bounds: Bounds,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
    /// What this answer took, in milliseconds.
    #[serde(default)]
    pub timings_ms: Timings,
}

/// Vertices of one mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshVertices {
    /// As `rig.describe` has it.
    pub name: String,
    /// Vertices in this answer: those of the mesh, or of the `range` of it.
    pub vertex_count: u64,
    /// Where asked for: float32 of shape `[vertex_count, 3]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positions: Option<Blob>,
    /// Where asked for: float32 of shape `[vertex_count, 3]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normals: Option<Blob>,
}

/// Asks for what stays the same in every pose.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TopologyParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
    /// How the arrays travel. Without it, `json`.
    #[serde(default)]
    pub transport: ArrayTransport,
}

/// What stays the same in every pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Topology {
    /// All of them, in the order of `rig.describe`.
    pub meshes: Vec<MeshTopology>,
}

/// How the vertices of one mesh hang together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshTopology {
    /// As `rig.describe` has it.
    pub name: String,
    /// Vertices of the mesh, which `triangles` index from 0 in the order of `mesh.vertices`.
    pub vertex_count: u64,
    /// Rows of `triangles`.
    pub triangle_count: u64,
    /// That of the first part; null where the file names none.
    pub material: Option<String>,
    /// Its triangles by what they are made of, one part after another.
    pub parts: Vec<MeshPart>,
    /// Indices of vertices, wound as in the file: uint32 of shape `[triangle_count, 3]`.
    pub triangles: Blob,
    /// Where the file has any, and but one for each vertex: float32 of shape `[vertex_count, 2]`; v is 0 at the bottom of the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texcoords: Option<Blob>,
    /// In their place where a vertex has several, those of each triangle's corners: float32 of shape `[triangle_count, 3, 2]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corner_texcoords: Option<Blob>,
}
