//! `scene.pick`: what is seen at a pixel. Never lives here: how it is found.

use super::frame::{Timings, frame_fields, frame_request};
use super::pose::Clamped;
use super::{blob, camera, frame, pose};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

frame_fields! { frame_request! {
    /// Asks what a picture would show at one of its pixels: a frame request, and the pixel.
    PickParams {
        /// From the top left corner of the picture; the middle of the first pixel is at `[0.5, 0.5]`.
        pixel: [f64; 2],
        /// What can be hit. Skin that `show` leaves out cannot be; bones can be whether they are drawn or not.
        #[serde(default = "all_targets")]
        targets: Vec<PickTarget>,
        /// Radius of every bone, in the rig's units. Without it, as thick as bones are drawn.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bone_radius: Option<f64>,
    }
} }

fn all_targets() -> Vec<PickTarget> {
    vec![PickTarget::Bone, PickTarget::Skin]
}

/// What a pixel can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PickTarget {
    /// Cylinders from each joint to its children.
    Bone,
    /// Triangles of the skin, where they are drawn.
    Skin,
}

/// What is seen at a pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Picked {
    /// The ray that was followed, given also where it hits nothing.
    pub ray: Ray,
    /// Null where the ray hits nothing.
    pub hit: Option<Hit>,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
    /// What this answer took, in milliseconds; `encode` is 0.
    #[serde(default)]
    pub timings_ms: Timings,
}

/// The line of sight of the pixel, in world space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ray {
    /// The eye; for an orthographic camera the point of its plane that the pixel looks from.
    pub origin: [f64; 3],
    /// Unit length.
    pub direction: [f64; 3],
}

/// The nearest thing that the ray hits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Hit {
    /// Which other fields there are: `along` with `bone`; `mesh`, `triangle`, `barycentric` and `normal` with `skin`.
    pub kind: PickTarget,
    /// From the ray's origin, in the rig's units.
    pub distance: f64,
    /// In world space.
    pub position: [f64; 3],
    /// The joint that the bone belongs to, or the one that weighs most at this place of the skin; null where the skin follows none.
    pub joint: Option<String>,
    /// How far along the bone, from 0 at its joint to 1 at the child.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<f64>,
    /// Of the skin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
    /// Index in the order of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub triangle: Option<u64>,
    /// Shares of the triangle's corners, which sum to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub barycentric: Option<[f64; 3]>,
    /// Unit length, turned toward the eye.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
}
