//! `frame.batch` and `mesh.batch`: many pictures or many poses in one request.
//! Never lives here: what one picture or one mesh is.

use super::Id;
use super::blob::{ArrayTransport, Blob};
use super::frame::{Frame, Over, Skinning, Timings, frame_change, frame_fields, frame_request};
use super::mesh::{MeshVertices, Range, VertexState};
use super::pose::{Clamped, DofValues, Pose};
use super::rig::Bounds;
use super::{blob, camera, frame, pose};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

frame_fields! { frame_request! {
    /// Asks for many pictures: a frame request, and what is different in each picture.
    FrameBatchParams {
        /// One for each picture. What it gives stands in place of the same field of the common part.
        frames: Vec<FrameChange>,
        /// Whether to send each picture as soon as it and those before it are ready, as a notification `frame.ready`.
        #[serde(default)]
        stream: bool,
    }
} }

frame_fields! { frame_change! {
    /// What is different in one picture of a batch: any field of a frame request.
    FrameChange over FrameBatchParams
} }

/// The pictures of a batch, or how many were sent ahead.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrameBatch {
    /// One for each of the request's `frames`, streamed or not.
    pub frame_count: u64,
    /// In the order of the request; left out where they were streamed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames: Option<Vec<Frame>>,
}

/// A picture of a streamed batch: the parameters of the notification `frame.ready`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrameReady {
    /// The `id` of the request.
    pub request: Id,
    /// Which of its frames; they come one after another.
    pub index: u64,
    /// As `frame.render` answers it. An attached picture follows the notification's own line, and its `offset` counts from there.
    pub frame: Frame,
}

/// Asks for the vertices or joints of one rig in many poses: as `mesh.vertices`, with `poses` or `dof_values`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshBatchParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
    /// What `dof_values` are set upon; not beside `poses`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<Pose>,
    /// By which rule a vertex follows several joints. Without it, `linear`.
    #[serde(default)]
    pub skinning: Skinning,
    /// Whether the vertices follow the pose.
    #[serde(default)]
    pub state: VertexState,
    /// What to send of each pose.
    #[serde(default = "vertices")]
    pub attributes: Vec<BatchAttribute>,
    /// Name of the only mesh to send. Without it, all of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    /// A part of one mesh. A rig with several meshes needs `mesh` beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<Range>,
    /// How the arrays of all items travel. Without it, `json`.
    #[serde(default)]
    pub transport: ArrayTransport,
    /// One item for each. Either these or `dof_values`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poses: Option<Vec<Pose>>,
    /// One item for each row of an array of shape `[n, dof_count]`: every degree of freedom in the order of `rig.describe`, flat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dof_values: Option<DofValues>,
    /// Whether to send each item as soon as it and those before it are ready, as a notification `mesh.ready`.
    #[serde(default)]
    pub stream: bool,
}

fn vertices() -> Vec<BatchAttribute> {
    vec![BatchAttribute::Positions, BatchAttribute::Normals]
}

/// What there is of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BatchAttribute {
    /// Points of the skin in world space, in the rig's units.
    Positions,
    /// Directions of the skin in world space, of unit length.
    Normals,
    /// Where the joints are. Alone, no skin is worked out.
    Joints,
}

/// One pose of a batch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshItem {
    /// Empty where only joints were asked for.
    pub meshes: Vec<MeshVertices>,
    /// Of the vertices in this item.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// Where asked for: `world_from_joint` of each joint in file order, column-major, float32 of shape `[joint_count, 16]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Blob>,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
    /// What this item took, in milliseconds.
    pub timings_ms: Timings,
}

/// The poses of a batch, or how many were sent ahead.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshBatch {
    /// One for each of the request's `poses` or rows of `dof_values`, streamed or not.
    pub item_count: u64,
    /// In the order of the request; left out where they were streamed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub items: Option<Vec<MeshItem>>,
}

/// A pose of a streamed batch: the parameters of the notification `mesh.ready`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshReady {
    /// The `id` of the request.
    pub request: Id,
    /// Which of its poses; they come one after another.
    pub index: u64,
    /// As the reply has it where nothing is streamed. Attached arrays follow the notification's own line; their `offset` counts from there.
    pub item: MeshItem,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::frame::FrameParams;
    use serde_json::json;

    #[test]
    fn a_change_is_laid_over_the_common_part_field_by_field() {
        let whole = json!({
            "rig": "other", "pose": {"dofs": {"a.rx": 1.0}}, "skinning": "dual_quaternion", "show": {"skin_opacity": 0.5},
            "camera": {"kind": "orbit", "azimuth": 1.0}, "lights": [], "ambient": [0.5, 0.5, 0.5], "material": {"shininess": 3.0},
            "background": [0.0, 0.0, 0.0, 0.0], "cull": "never", "size": [3, 4], "samples": 1, "outputs": ["color", "color"], "image": "rgba8",
            "compression": "best", "transport": "attach",
        });
        let batch: FrameBatchParams =
            serde_json::from_value(json!({"rig": "one", "frames": [{}, whole.clone()]})).unwrap();
        let [unchanged, changed] = &batch.frames[..] else {
            panic!("there are two");
        };
        assert_eq!(unchanged.over(&batch), FrameParams::of("one"));
        let wanted: FrameParams = serde_json::from_value(whole).unwrap();
        assert_eq!(changed.over(&batch), wanted);
    }
}
