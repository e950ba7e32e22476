//! `pose.*` and `joint.transforms`, and the pose that any request may carry.
//! Never lives here: what a rig makes of the numbers.

use super::attach::Attach;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A pose, built up in steps: `base`, then `clip` or `clips`, then `rotations`, then `dofs` or `dof_values`; `limits` holds for each.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// What to start from. Without it, the stored pose where the rig is named, and the rest pose where it is given by digest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<PoseBase>,
    /// An animation at one moment: sets every degree of freedom that it has a channel for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip: Option<ClipAt>,
    /// Several animations at once, each with its share; not beside `clip`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clips: Vec<WeightedClip>,
    /// Local rotations by the joint's name: unit quaternions `[x, y, z, w]`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rotations: BTreeMap<String, [f64; 4]>,
    /// Values by the name of the degree of freedom, in radians or the rig's units; scales and weights have none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub dofs: BTreeMap<String, f64>,
    /// Every degree of freedom at once, in the order of `rig.describe`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dof_values: Option<DofValues>,
    /// What becomes of a value past its limits.
    #[serde(default)]
    pub limits: LimitPolicy,
}

/// An animation at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ClipAt {
    /// As `rig.describe` has it.
    pub name: String,
    /// In seconds, within ±1e9; also outside of the clip's range.
    pub time: f64,
}

/// An animation at one moment, and its share. What several of them set becomes their mean by weight, rotations by slerp one after
/// another; where the weights of those that set it come to less than 1, what the pose starts from makes up the rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeightedClip {
    /// As `rig.describe` has it.
    pub name: String,
    /// In seconds, within ±1e9; also outside of the clip's range.
    pub time: f64,
    /// From 0 to 1e9.
    #[serde(default = "whole")]
    pub weight: f64,
}

fn whole() -> f64 {
    1.0
}

/// What a pose starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PoseBase {
    /// The pose that the server keeps: as `pose.set`, `pose.rotate`, `pose.roll` or `pose.reset` left it.
    Stored,
    /// The file's own pose.
    Rest,
}

/// What becomes of a value past its limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitPolicy {
    /// The nearest value inside is used and reported in `clamped`.
    #[default]
    Clamp,
    /// The request is refused.
    Reject,
    /// It is taken as it is.
    Ignore,
}

/// One value for each degree of freedom.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(deny_unknown_fields)]
pub enum DofValues {
    /// As numbers.
    List(Vec<f64>),
    /// As float32, little-endian, among the raw bytes that follow the request.
    Attached {
        /// Where they lie.
        attach: Attach,
    },
}

impl<'de> Deserialize<'de> for DofValues {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DofValuesVisitor)
    }
}

struct DofValuesVisitor;

impl<'de> Visitor<'de> for DofValuesVisitor {
    type Value = DofValues;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of numbers or an object with `attach`")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<DofValues, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = seq.next_element()? {
            values.push(value);
        }
        Ok(DofValues::List(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<DofValues, A::Error> {
        let members = MapAccessDeserializer::new(members);
        let DofValuesFields { attach } = DofValuesFields::deserialize(members)?;
        Ok(DofValues::Attached { attach })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DofValuesFields {
    attach: Attach,
}

/// Changes the stored pose of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PoseSetParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
    /// What to change. Where it starts from the stored pose, what it does not name stays as it is.
    pub pose: Pose,
}

/// What setting a pose came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PoseSetResult {
    /// Values that their limits changed.
    pub clamped: Vec<Clamped>,
}

/// Turns a joint further, whatever its stored rotation. Its children go with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotateParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
    /// Name of a joint, as `rig.describe` has it.
    pub joint: String,
    /// A direction of any length.
    pub axis: [f64; 3],
    /// Radians, by the right-hand rule.
    pub angle: f64,
    /// What the axis is given in.
    #[serde(default)]
    pub space: AxisSpace,
    /// What becomes of an angle past its limits.
    #[serde(default)]
    pub limits: LimitPolicy,
}

/// What an axis is given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AxisSpace {
    /// The joint's own frame, as it is turned now.
    #[default]
    Joint,
    /// World space.
    World,
}

/// Turns a joint about its own bone: the line to its first child at a distance, else on from its parent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RollParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
    /// Name of a joint, as `rig.describe` has it.
    pub joint: String,
    /// Radians, by the right-hand rule about the bone's direction.
    pub angle: f64,
    /// What becomes of an angle past its limits.
    #[serde(default)]
    pub limits: LimitPolicy,
}

/// A value that its limits changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Clamped {
    /// Name of the degree of freedom.
    pub dof: String,
    /// The value of the request.
    pub asked: f64,
    /// The value in its place.
    pub used: f64,
}

/// The stored pose of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StoredPose {
    /// By name, in radians or the rig's units; scales and weights have none.
    pub dofs: BTreeMap<String, f64>,
    /// By name, each against its parent.
    pub joints: BTreeMap<String, LocalTransform>,
}

/// A joint against its parent: scaled, then rotated, then moved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LocalTransform {
    /// Origin of the joint in the parent's space.
    pub translation: [f64; 3],
    /// Unit quaternion `[x, y, z, w]`.
    pub rotation: [f64; 4],
    /// Factors along the joint's own axes; 1 leaves lengths as they are.
    pub scale: [f64; 3],
}

/// Asks where the joints are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TransformsParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
    /// A pose for this request alone. Without it, as if it were `{}`.
    #[serde(default)]
    pub pose: Pose,
}

/// Where the joints are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Transforms {
    /// In file order, which puts parents before their children.
    pub joints: Vec<JointTransform>,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
}

/// Where one joint is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointTransform {
    /// As `rig.describe` has it.
    pub name: String,
    /// Null for the root.
    pub parent: Option<String>,
    /// Column-major.
    pub world_from_joint: [f64; 16],
}
