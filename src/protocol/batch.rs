//! `frame.batch` and `mesh.batch`: many pictures or many poses in one request.
//! Never lives here: what one picture or one mesh is.

use super::Id;
use super::blob::{ArrayTransport, Blob, PictureTransport};
use super::camera::{Camera, Lights};
use super::frame::{
    Compression, Cull, Frame, FrameParams, ImageFormat, Material, Output, Samples, Show, Skinning,
    Timings, frame_request,
};
use super::mesh::{MeshVertices, Range, VertexState};
use super::pose::{Clamped, DofValues, Pose};
use super::rig::Bounds;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

frame_request! {
    /// Asks for many pictures: a frame request, and what is different in each picture.
    FrameBatchParams {
        /// One for each picture. What it gives stands in place of the same field of the common part.
        frames: Vec<FrameChange>,
        /// Whether to send each picture as soon as it and those before it are ready, as a notification `frame.ready`.
        #[serde(default)]
        stream: bool,
    }
}

/// What is different in one picture of a batch: any field of a frame request.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FrameChange {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose: Option<Box<Pose>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skinning: Option<Skinning>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub show: Option<Box<Show>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<Box<Camera>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lights: Option<Lights>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<Box<Material>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub background: Option<[f64; 4]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cull: Option<Cull>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[u32; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<Samples>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outputs: Option<Vec<Output>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub image: Option<ImageFormat>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compression: Option<Compression>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transport: Option<PictureTransport>,
}

impl FrameChange {
    /// The whole request for this picture, laid over the common part.
    pub fn over(&self, common: &FrameBatchParams) -> FrameParams {
        fn laid<T: Clone>(change: Option<&T>, common: T) -> T {
            change.cloned().unwrap_or(common)
        }
        let common = common.frame();
        FrameParams {
            rig: laid(self.rig.as_ref(), common.rig),
            pose: laid(self.pose.as_deref(), common.pose),
            skinning: laid(self.skinning.as_ref(), common.skinning),
            show: laid(self.show.as_deref(), common.show),
            camera: laid(self.camera.as_deref(), common.camera),
            lights: self.lights.clone().or(common.lights),
            ambient: self.ambient.or(common.ambient),
            material: laid(self.material.as_deref(), common.material),
            background: self.background.or(common.background),
            cull: laid(self.cull.as_ref(), common.cull),
            size: laid(self.size.as_ref(), common.size),
            samples: laid(self.samples.as_ref(), common.samples),
            outputs: laid(self.outputs.as_ref(), common.outputs),
            image: laid(self.image.as_ref(), common.image),
            compression: laid(self.compression.as_ref(), common.compression),
            transport: laid(self.transport.as_ref(), common.transport),
        }
    }
}

/// The pictures of a batch, or how many were sent ahead.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrameBatch {
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
    pub timings_ms: Timings,
}

/// The poses of a batch, or how many were sent ahead.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshBatch {
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
    pub item: MeshItem,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    #[test]
    fn a_change_can_have_every_field_of_a_frame_request() {
        let fields = |schema: schemars::Schema| -> Vec<String> {
            let properties = schema.get("properties").and_then(Value::as_object).cloned();
            properties.unwrap().keys().cloned().collect()
        };
        let of_change = fields(schemars::schema_for!(FrameChange));
        assert_eq!(of_change, fields(schemars::schema_for!(FrameParams)));
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
