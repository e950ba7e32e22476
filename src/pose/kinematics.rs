//! Forward kinematics: f64 throughout, rounded once when a palette is made.

use super::{Local, Palette, Pose, Skinning};
use crate::rig::{Binding, Mesh, Part, Rig};
use glam::{DAffine3, DVec3};
use std::sync::{Arc, OnceLock};

/// A pose worked out: what skinning and drawing need, of one rig, unable to be wrong any more.
#[derive(Debug)]
pub struct Posed {
    rig: Arc<Rig>,
    world_from_joint: Vec<DAffine3>,
    /// One per binding.
    model_from_bind: Vec<DAffine3>,
    /// Made when first asked for, by the ways of skinning.
    palettes: [OnceLock<Palette>; 2],
    morph_weights: Vec<f32>,
}

/// What stands between a joint and one of its children.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bone {
    /// The joint that turns it.
    pub owner: usize,
    /// The joint that it leads to.
    pub child: usize,
    /// Where the owner is, in world space.
    pub from: DVec3,
    /// Where the child is, in world space; never equal to `from`.
    pub to: DVec3,
    /// In the rig's units.
    pub radius: f64,
}

/// Largest radius of a bone to its own length: short ones would look like coins.
const LARGEST_RADIUS_SHARE: f64 = 0.2;

/// A pose that flings a rig further than numbers reach.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PoseOutOfRange {
    /// The transform of a joint to the world, or that of what is bound to it, has a number that is too large.
    #[error("the pose moves joint `{joint}` by more than {LARGEST_MOVE:e} units")]
    Joint {
        /// Its name in the rig.
        joint: String,
    },
    /// A weight is so large that vertices could leave the range of float32.
    #[error("the weight of morph target `{morph}` is beyond ±{LARGEST_WEIGHT:e}")]
    Morph {
        /// The target's name in the rig.
        morph: String,
    },
}

/// Coordinates of a rig stay below [`LARGEST_COORDINATE`](crate::rig::LARGEST_COORDINATE), so a vertex moved by this stays far inside float32.
const LARGEST_MOVE: f64 = 1e18;
/// As many targets as there may be, each at this weight, keep a vertex as far inside.
const LARGEST_WEIGHT: f64 = 1e6;

impl Posed {
    /// Each joint: `world_from_joint = world_from_parent * T(offset + displacement) * R * S`; each binding:
    /// `model_from_bind = world_from_joint * joint_from_bind`.
    ///
    /// # Errors
    /// [`PoseOutOfRange`] where a displacement is so large that a vertex could overflow float32.
    pub fn new(pose: &Pose) -> Result<Self, PoseOutOfRange> {
        let rig = Arc::clone(pose.rig());
        let joints = rig.skeleton().joints();
        let mut world_from_joint: Vec<DAffine3> = Vec::with_capacity(joints.len());
        for (index, joint) in joints.iter().enumerate() {
            let Local {
                translation,
                rotation,
                scale,
            } = pose.local(index);
            let parent_from_joint =
                DAffine3::from_scale_rotation_translation(scale, rotation, translation);
            let world_from_parent = joint
                .parent
                .map_or(DAffine3::IDENTITY, |parent| world_from_joint[parent]);
            let placed = world_from_parent * parent_from_joint;
            if !is_small(placed) {
                return Err(PoseOutOfRange::Joint {
                    joint: joint.name.clone(),
                });
            }
            world_from_joint.push(placed);
        }
        let mut model_from_bind = Vec::with_capacity(rig.bindings().len());
        for &Binding {
            joint,
            joint_from_bind,
        } in rig.bindings()
        {
            let moved = joint.map_or(joint_from_bind, |joint| {
                world_from_joint[joint] * joint_from_bind
            });
            if !is_small(moved) {
                let joint = joint.map_or_else(String::new, |joint| joints[joint].name.clone());
                return Err(PoseOutOfRange::Joint { joint });
            }
            model_from_bind.push(moved);
        }
        let morph_weights = morph_weights(pose)?;
        Ok(Self {
            world_from_joint,
            model_from_bind,
            palettes: Default::default(),
            morph_weights,
            rig,
        })
    }

    /// The rig that the pose is of.
    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    /// One per joint, in file order.
    pub fn world_from_joint(&self) -> &[DAffine3] {
        &self.world_from_joint
    }

    /// The skinning palette of the pose, made at the first call for each way of skinning.
    pub fn palette(&self, skinning: Skinning) -> &Palette {
        let [linear, dual_quaternion] = &self.palettes;
        let palette = match skinning {
            Skinning::Linear => linear,
            Skinning::DualQuaternion => dual_quaternion,
        };
        palette.get_or_init(|| Palette::rounded(&self.model_from_bind, skinning))
    }

    /// Where the middle of a part of one of the rig's meshes comes to lie, about: as if all of it followed what most of it does.
    pub fn center_of(&self, part: &Part) -> DVec3 {
        let moved = self.model_from_bind.get(part.follows as usize);
        let center = part.center.as_dvec3();
        moved.map_or(center, |moved| moved.transform_point3(center))
    }

    /// Whether anything that a mesh of the rig follows turns left into right, and so inside into outside.
    pub fn mirrors(&self, mesh: &Mesh) -> bool {
        let mut followed = mesh.binding_bounds().iter();
        // What is flat has no inside.
        followed.any(|binding_bounds| {
            let moved = self.model_from_bind[binding_bounds.binding as usize];
            moved.matrix3.determinant() <= 0.0
        })
    }

    /// One per morph target of the rig.
    pub fn morph_weights(&self) -> &[f32] {
        &self.morph_weights
    }

    /// The bones: from each joint to each of its children at non-zero distance, as thick as
    /// [`Skeleton::bone_radius`](crate::rig::Skeleton::bone_radius) says, but never more than a fifth of their own length in radius.
    pub fn bones(&self) -> impl Iterator<Item = Bone> {
        let origin = |joint: usize| self.world_from_joint[joint].translation;
        let skeleton = self.rig.skeleton();
        // Where all joints coincide at rest, a bone can still be pulled out of them.
        let rest_radius = skeleton.bone_radius().unwrap_or(f64::INFINITY);
        let joints = skeleton.joints().iter().enumerate();
        joints
            .filter_map(move |(child, joint)| {
                let owner = joint.parent?;
                let (from, to) = (origin(owner), origin(child));
                Some(Bone {
                    owner,
                    child,
                    from,
                    to,
                    radius: rest_radius.min(from.distance(to) * LARGEST_RADIUS_SHARE),
                })
            })
            .filter(|bone| bone.from != bone.to)
    }
}

fn morph_weights(pose: &Pose) -> Result<Vec<f32>, PoseOutOfRange> {
    let morphs = pose.rig().morphs();
    let mut weights = Vec::with_capacity(morphs.len());
    for (morph, &weight) in morphs.iter().zip(&pose.morph_weights) {
        if !(-LARGEST_WEIGHT..=LARGEST_WEIGHT).contains(&weight) {
            let morph = morph.name.clone();
            return Err(PoseOutOfRange::Morph { morph });
        }
        weights.push(weight as f32);
    }
    Ok(weights)
}

fn is_small(affine: DAffine3) -> bool {
    affine
        .to_cols_array()
        .iter()
        .all(|number| number.abs() <= LARGEST_MOVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::pose::PoseEdit;
    use crate::rig::{Draft, JointDraft};

    fn posed(parents_and_offsets: &[(Option<usize>, DVec3)], dofs: Vec<(usize, f64)>) -> Posed {
        let joint = |&(parent, offset): &(Option<usize>, DVec3)| JointDraft {
            parent,
            offset,
            translates: true,
            ..JointDraft::default()
        };
        let rig = Draft {
            joints: parents_and_offsets.iter().map(joint).collect(),
            ..Draft::default()
        };
        let rig = rig.build(&Limits::default()).expect("a valid draft");
        let edit = PoseEdit {
            dofs,
            ..PoseEdit::default()
        };
        let (pose, _) = Pose::rest(&Arc::new(rig)).edited(&edit).expect("no limits");
        Posed::new(&pose).expect("within range")
    }

    #[test]
    fn bones_name_both_ends_and_short_ones_are_thin() {
        // hip (0) - knee (1) - twist (2), where the knee is - toe (3), close by
        let joints = [
            (None, DVec3::X),
            (Some(0), DVec3::NEG_Y * 4.0),
            (Some(1), DVec3::ZERO),
            (Some(2), DVec3::Z * 0.5),
            (Some(0), DVec3::Y * 3.0),
        ];
        let bone = |owner, child, from, to, radius| Bone {
            owner,
            child,
            from,
            to,
            radius,
        };
        let knee = DVec3::new(1.0, -4.0, 0.0);
        let toe = DVec3::new(1.0, -4.0, 0.5);
        let found: Vec<Bone> = posed(&joints, Vec::new()).bones().collect();
        // The median is 3, a fifth of the toe's bone is 0.1.
        let radius = 3.0 * 0.1;
        let wanted = [
            bone(0, 1, DVec3::X, knee, radius),
            bone(2, 3, knee, toe, 0.1),
            bone(0, 4, DVec3::X, DVec3::new(1.0, 3.0, 0.0), radius),
        ];
        assert_eq!(found, wanted);
    }

    #[test]
    fn a_bone_pulled_out_of_a_point_has_a_thickness() {
        let joints = [(None, DVec3::ZERO), (Some(0), DVec3::ZERO)];
        assert_eq!(posed(&joints, Vec::new()).bones().count(), 0);
        // Six DOFs of the root, then `joint_1.tx`.
        let bones: Vec<Bone> = posed(&joints, vec![(6, 2.0)]).bones().collect();
        assert_eq!(bones.len(), 1);
        assert_eq!(bones[0].radius, 0.4);
    }
}
