//! Forward kinematics and the skinning palette: f64 throughout, rounded once at the end.

use super::Pose;
use crate::rig::{Binding, Rig};
use glam::{DAffine3, DVec3, Vec4};
use std::sync::Arc;

/// One skinning matrix `model_from_bind`, as the three rows of an affine matrix that a shader multiplies column vectors by.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SkinMatrix {
    pub rows: [Vec4; 3],
}

impl SkinMatrix {
    pub const IDENTITY: Self = Self {
        rows: [Vec4::X, Vec4::Y, Vec4::Z],
    };

    fn rounded(model_from_bind: DAffine3) -> Self {
        let DAffine3 {
            matrix3,
            translation,
        } = model_from_bind;
        let row = |i: usize| matrix3.row(i).extend(translation[i]).as_vec4();
        Self {
            rows: [row(0), row(1), row(2)],
        }
    }
}

/// One [`SkinMatrix`] per binding, in the order of [`Rig::bindings`]. Finite, and so small that no vertex can overflow.
#[derive(Debug, Clone, PartialEq)]
pub struct Palette(Vec<SkinMatrix>);

impl Palette {
    pub fn matrices(&self) -> &[SkinMatrix] {
        &self.0
    }

    /// Leaves every vertex where it was modelled.
    pub fn bind(rig: &Rig) -> Self {
        Self(vec![SkinMatrix::IDENTITY; rig.bindings().len()])
    }
}

/// A pose worked out: what skinning and drawing need, of one rig, unable to be wrong any more.
#[derive(Debug)]
pub struct Posed {
    rig: Arc<Rig>,
    world_from_joint: Vec<DAffine3>,
    palette: Palette,
}

/// A pose that flings a rig further than numbers reach.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the pose moves joint `{joint}` by more than {LARGEST_MOVE:e} units")]
pub struct PoseOutOfRange {
    pub joint: String,
}

/// Coordinates of a rig stay below [`LARGEST_COORDINATE`](crate::rig::LARGEST_COORDINATE), so a vertex moved by this stays far inside float32.
const LARGEST_MOVE: f64 = 1e18;

impl Posed {
    /// Each joint: `world_from_joint = world_from_parent * T(offset + displacement) * R`; each binding:
    /// `model_from_bind = world_from_joint * joint_from_bind`.
    ///
    /// # Errors
    /// [`PoseOutOfRange`] where a displacement is so large that a vertex could overflow float32.
    pub fn new(pose: &Pose) -> Result<Self, PoseOutOfRange> {
        let rig = Arc::clone(pose.rig());
        let joints = rig.skeleton().joints();
        let mut world_from_joint: Vec<DAffine3> = Vec::with_capacity(joints.len());
        for (index, joint) in joints.iter().enumerate() {
            let (translation, rotation) = pose.local(index);
            let parent_from_joint = DAffine3::from_rotation_translation(rotation, translation);
            let world_from_parent = joint
                .parent
                .map_or(DAffine3::IDENTITY, |parent| world_from_joint[parent]);
            let placed = world_from_parent * parent_from_joint;
            if !is_small(placed) {
                return Err(PoseOutOfRange {
                    joint: joint.name.clone(),
                });
            }
            world_from_joint.push(placed);
        }
        let mut palette = Vec::with_capacity(rig.bindings().len());
        for &Binding {
            joint,
            joint_from_bind,
        } in rig.bindings()
        {
            let model_from_bind = joint.map_or(joint_from_bind, |joint| {
                world_from_joint[joint] * joint_from_bind
            });
            if !is_small(model_from_bind) {
                let joint = joint.map_or_else(String::new, |joint| joints[joint].name.clone());
                return Err(PoseOutOfRange { joint });
            }
            palette.push(SkinMatrix::rounded(model_from_bind));
        }
        Ok(Self {
            world_from_joint,
            palette: Palette(palette),
            rig,
        })
    }

    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    /// One per joint, in file order.
    pub fn world_from_joint(&self) -> &[DAffine3] {
        &self.world_from_joint
    }

    pub fn palette(&self) -> &Palette {
        &self.palette
    }

    /// The bones: from each joint to each of its children at non-zero distance, as `(owner, from, to)` in world space.
    pub fn bones(&self) -> impl Iterator<Item = (usize, DVec3, DVec3)> {
        let origin = |joint: usize| self.world_from_joint[joint].translation;
        let joints = self.rig.skeleton().joints().iter().enumerate();
        joints
            .filter_map(move |(child, joint)| {
                joint
                    .parent
                    .map(|parent| (parent, origin(parent), origin(child)))
            })
            .filter(|(_, from, to)| from != to)
    }
}

fn is_small(affine: DAffine3) -> bool {
    affine
        .to_cols_array()
        .iter()
        .all(|number| number.abs() <= LARGEST_MOVE)
}
