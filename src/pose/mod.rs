//! What a rig's joints are turned to: [`Pose`] holds it, [`PoseEdit`] changes it within limits, [`Posed`] is its outcome.
//! Never lives here: vertices, and names (callers resolve them to indices).

mod blend;
mod euler;
mod kinematics;
mod palette;
mod turn;

pub use kinematics::{Bone, PoseOutOfRange, Posed};
pub use palette::{Palette, SkinDualQuaternion, SkinMatrix, Skinning};
pub use turn::Space;

use crate::rig::{Axis, Dof, DofKind, Joint, Rig, Rotation};
use blend::Blended;
use euler::Fit;
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// To the bit.
fn is_same_rotation(one: Rotation, other: Rotation) -> bool {
    match (one, other) {
        (Rotation::Angles(one), Rotation::Angles(other)) => {
            is_same(&one.to_array(), &other.to_array())
        }
        (Rotation::Quaternion(one), Rotation::Quaternion(other)) => {
            is_same(&one.to_array(), &other.to_array())
        }
        _ => false,
    }
}

fn is_same(one: &[f64], other: &[f64]) -> bool {
    let mut pairs = one.iter().zip(other);
    one.len() == other.len() && pairs.all(|(a, b)| a.to_bits() == b.to_bits())
}

#[derive(Debug, Clone, Copy)]
struct JointPose {
    /// From rest, in the parent's frame.
    displacement: DVec3,
    rotation: Rotation,
    scale: DVec3,
}

/// A joint in its parent's frame: `T(translation) * R(rotation) * S(scale)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// Its origin in the parent's frame, in the rig's units.
    pub translation: DVec3,
    /// Unit length.
    pub rotation: DQuat,
    /// Factors along the joint's own axes.
    pub scale: DVec3,
}

/// The state of every joint of one rig, in f64.
#[derive(Debug, Clone)]
pub struct Pose {
    rig: Arc<Rig>,
    joints: Vec<JointPose>,
    /// One per morph target.
    morph_weights: Vec<f64>,
}

/// What to do with a value past its limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LimitPolicy {
    /// Use the nearest value inside and report it.
    #[default]
    Clamp,
    /// Refuse the whole edit.
    Reject,
    /// Take it as it is.
    Ignore,
}

/// An animation at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipAt {
    /// Index into the rig's clips.
    pub clip: usize,
    /// In seconds.
    pub time: f64,
    /// Finite, at least 0: its share among clips that move the same. Where these come to less than 1, the pose that is edited makes up
    /// the rest.
    pub weight: f64,
}

/// Changes to a [`Pose`]: clips first, then rotations, then DOFs. Numbers are finite, quaternions of unit length, indices in range.
#[derive(Debug, Clone, Default)]
pub struct PoseEdit {
    /// Mixed by their weights, in this order.
    pub clips: Vec<ClipAt>,
    /// `(joint, local rotation)`
    pub rotations: Vec<(usize, DQuat)>,
    /// `(index into the rig's DOFs, value)`
    pub dofs: Vec<(usize, f64)>,
    /// What becomes of values that leave the limits of their DOFs.
    pub limits: LimitPolicy,
}

/// A value that a limit changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clamped {
    /// Index into the rig's DOFs.
    pub dof: usize,
    /// The value that the edit came to, in the DOF's unit.
    pub asked: f64,
    /// The value of the new pose, in the same unit.
    pub used: f64,
}

/// A value past its limits that [`LimitPolicy::Reject`] refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{dof}` of {asked} is outside its limits {min}..{max}")]
pub struct OutsideLimits {
    /// Its name in the rig.
    pub dof: String,
    /// The value that the edit came to, in the DOF's unit.
    pub asked: f64,
    /// The smallest value allowed, in the same unit.
    pub min: f64,
    /// The largest value allowed, in the same unit.
    pub max: f64,
}

impl Pose {
    /// To the bit, so that everything that is worked out from both is the same.
    pub fn is_same(&self, other: &Self) -> bool {
        let mut joints = self.joints.iter().zip(&other.joints);
        Arc::ptr_eq(&self.rig, &other.rig)
            && joints.all(|(one, other)| {
                is_same(&one.displacement.to_array(), &other.displacement.to_array())
                    && is_same(&one.scale.to_array(), &other.scale.to_array())
                    && is_same_rotation(one.rotation, other.rotation)
            })
            && is_same(&self.morph_weights, &other.morph_weights)
    }

    /// The file's own pose.
    pub fn rest(rig: &Arc<Rig>) -> Self {
        let at_rest = |joint: &Joint| JointPose {
            displacement: DVec3::ZERO,
            rotation: joint.rest_rotation,
            scale: joint.rest_scale,
        };
        Self {
            joints: rig.skeleton().joints().iter().map(at_rest).collect(),
            morph_weights: rig.morphs().iter().map(|morph| morph.rest).collect(),
            rig: Arc::clone(rig),
        }
    }

    /// The rig that it is a pose of.
    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    /// The value of every DOF, in the order of the rig's DOFs.
    pub fn dof_values(&self) -> Vec<f64> {
        // Once for each joint and not for each of its angles: of a quaternion they have to be looked for.
        let angles: Vec<DVec3> = (0..self.joints.len())
            .map(|joint| self.angles(joint))
            .collect();
        let dofs = self.rig.dofs().all().iter();
        dofs.map(|dof| self.value_by(dof, |joint| angles[joint]))
            .collect()
    }

    fn value(&self, dof: &Dof) -> f64 {
        self.value_by(dof, |joint| self.angles(joint))
    }

    fn value_by(&self, dof: &Dof, angles: impl Fn(usize) -> DVec3) -> f64 {
        match dof.kind {
            DofKind::Translation { joint, axis } => self.joints[joint].displacement[axis.index()],
            DofKind::Rotation { joint, axis } => angles(joint)[axis.index()],
            DofKind::Scale { joint, axis } => self.joints[joint].scale[axis.index()],
            DofKind::Morph { morph } => self.morph_weights[morph],
        }
    }

    /// About x, y and z. Of those that make a quaternion, the ones that the joint's limits allow, so that they set the same pose again.
    fn angles(&self, joint: usize) -> DVec3 {
        let of_joint = self.joint(joint);
        match self.joints[joint].rotation {
            Rotation::Quaternion(quaternion) if of_joint.is_limited() => {
                let order = of_joint.rotation_order;
                match euler::fit(quaternion, order, &of_joint.rotation_limits) {
                    Fit::Inside(angles) => angles,
                    // Limits were ignored when it was set.
                    Fit::Clamped { asked, .. } => asked,
                }
            }
            rotation => rotation.angles(of_joint.rotation_order),
        }
    }

    /// How a joint, by its index, stands in its parent's frame.
    pub fn local(&self, joint: usize) -> Local {
        let JointPose {
            displacement,
            rotation,
            scale,
        } = self.joints[joint];
        Local {
            translation: self.joint(joint).offset + displacement,
            rotation: rotation.quaternion(self.joint(joint).rotation_order),
            scale,
        }
    }

    /// The pose after the edit, and what limits changed on the way. `self` stays as it is.
    ///
    /// # Errors
    /// [`OutsideLimits`] under [`LimitPolicy::Reject`].
    pub fn edited(&self, edit: &PoseEdit) -> Result<(Self, Vec<Clamped>), OutsideLimits> {
        let mut next = self.clone();
        let mut clamped = Vec::new();
        let Blended { dofs, rotations } = Blended::of(self, &edit.clips);
        for (dof, asked) in dofs {
            next.set_limited(dof, asked, edit.limits, &mut clamped)?;
        }
        for (joint, quaternion) in rotations {
            next.set_rotation(joint, quaternion, edit.limits, &mut clamped)?;
        }
        for &(joint, quaternion) in &edit.rotations {
            next.set_rotation(joint, quaternion, edit.limits, &mut clamped)?;
        }
        for &(dof, asked) in &edit.dofs {
            next.set_limited(dof, asked, edit.limits, &mut clamped)?;
        }
        Ok((next, clamped))
    }

    fn set_limited(
        &mut self,
        dof: usize,
        asked: f64,
        policy: LimitPolicy,
        clamped: &mut Vec<Clamped>,
    ) -> Result<(), OutsideLimits> {
        let limit = self.rig.dofs().all()[dof].limit;
        let mut used = asked;
        if policy != LimitPolicy::Ignore && !limit.contains(asked) {
            used = limit.clamp(asked);
            self.note(Clamped { dof, asked, used }, policy, clamped)?;
        }
        self.set_dof(dof, used);
        Ok(())
    }

    fn set_dof(&mut self, dof: usize, value: f64) {
        let rig = Arc::clone(&self.rig);
        match rig.dofs().all()[dof].kind {
            DofKind::Translation { joint, axis } => {
                self.joints[joint].displacement[axis.index()] = value;
            }
            DofKind::Rotation { joint, axis } => {
                let mut angles = self.angles(joint);
                angles[axis.index()] = value;
                self.joints[joint].rotation = Rotation::Angles(angles);
            }
            DofKind::Scale { joint, axis } => self.joints[joint].scale[axis.index()] = value,
            DofKind::Morph { morph } => self.morph_weights[morph] = value,
        }
    }

    fn set_rotation(
        &mut self,
        joint: usize,
        quaternion: DQuat,
        policy: LimitPolicy,
        clamped: &mut Vec<Clamped>,
    ) -> Result<(), OutsideLimits> {
        let of_joint = self.joint(joint);
        let is_held = policy != LimitPolicy::Ignore && of_joint.is_limited();
        let order = of_joint.rotation_order;
        let fit = is_held.then(|| euler::fit(quaternion, order, &of_joint.rotation_limits));
        self.joints[joint].rotation = match fit {
            None | Some(Fit::Inside(_)) => Rotation::Quaternion(quaternion),
            Some(Fit::Clamped { asked, used }) => {
                for axis in Axis::ALL {
                    let (asked, used) = (asked[axis.index()], used[axis.index()]);
                    let dof = self.rig.dofs().of_kind(DofKind::Rotation { joint, axis });
                    if let Some(dof) = dof.filter(|_| asked != used) {
                        self.note(Clamped { dof, asked, used }, policy, clamped)?;
                    }
                }
                Rotation::Angles(used)
            }
        };
        Ok(())
    }

    fn note(
        &self,
        value: Clamped,
        policy: LimitPolicy,
        clamped: &mut Vec<Clamped>,
    ) -> Result<(), OutsideLimits> {
        if policy == LimitPolicy::Reject {
            let dof = &self.rig.dofs().all()[value.dof];
            let (min, max) = (dof.limit.min, dof.limit.max);
            return Err(OutsideLimits {
                dof: dof.name.clone(),
                asked: value.asked,
                min,
                max,
            });
        }
        clamped.push(value);
        Ok(())
    }

    fn joint(&self, index: usize) -> &Joint {
        &self.rig.skeleton().joints()[index]
    }
}

#[cfg(test)]
mod tests;
