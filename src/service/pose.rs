//! `pose.*` and `joint.transforms`, and what every request with a pose needs: from names to indices.

use super::names::{unknown, unknown_dof, unknown_joint};
use super::{Call, describe};
use crate::engine::{Base, PoseError, RigRef};
use crate::pose::{Clamped, ClipAt, LimitPolicy, Pose, PoseEdit, Posed, Space};
use crate::protocol::pose as wire;
use crate::protocol::rig::RigParams;
use crate::protocol::{Done, Fault, FieldFault, FieldPath};
use crate::rig::{LARGEST_COORDINATE, Rig};
use glam::{DMat4, DQuat, DVec3};
use std::collections::BTreeMap;
use std::sync::Arc;

impl Call {
    pub(super) fn get_pose(&self, params: &RigParams) -> Result<wire::StoredPose, Fault> {
        let RigRef { loaded, stored, .. } = self.engine().rig(&params.rig)?;
        let rig = &loaded.rig;
        let names = rig.dofs().all().iter().map(|dof| dof.name.clone());
        let joints = rig
            .skeleton()
            .joints()
            .iter()
            .enumerate()
            .map(|(index, joint)| {
                let local = stored.local(index);
                let local = wire::LocalTransform {
                    translation: local.translation.to_array(),
                    rotation: local.rotation.to_array(),
                    scale: local.scale.to_array(),
                };
                (joint.name.clone(), local)
            });
        Ok(wire::StoredPose {
            dofs: names.zip(stored.dof_values()).collect(),
            joints: joints.collect(),
        })
    }

    pub(super) fn set_pose(
        &self,
        params: &wire::PoseSetParams,
    ) -> Result<wire::PoseSetResult, Fault> {
        let (loaded, clamped) = self.engine().set_pose(&params.rig, |current| {
            let (base, edit) = self.edit(&params.pose, current).map_err(of_pose)?;
            let changed = current.changed(base, &edit);
            changed.map_err(|error| Fault::from(of_pose(located(error, &params.pose))))
        })?;
        Ok(wire::PoseSetResult {
            clamped: describe::clamped(&loaded.rig, &clamped),
        })
    }

    pub(super) fn reset_pose(&self, params: &RigParams) -> Result<Done, Fault> {
        self.engine().reset_pose(&params.rig)?;
        Ok(Done {})
    }

    pub(super) fn rotate_pose(
        &self,
        params: &wire::RotateParams,
    ) -> Result<wire::PoseSetResult, Fault> {
        let axis = DVec3::from_array(params.axis);
        if axis == DVec3::ZERO {
            let problem = "expected a direction, but found a vector of length 0";
            return Err(Fault::invalid_params("axis", problem));
        }
        let space = match params.space {
            wire::AxisSpace::Joint => Space::Joint,
            wire::AxisSpace::World => Space::World,
        };
        self.turn(&params.rig, &params.joint, params.limits, |pose, joint| {
            Ok(pose.turned(joint, axis, params.angle, space))
        })
    }

    pub(super) fn roll_pose(
        &self,
        params: &wire::RollParams,
    ) -> Result<wire::PoseSetResult, Fault> {
        self.turn(&params.rig, &params.joint, params.limits, |pose, joint| {
            let no_bone = || FieldFault::new("joint", "the joint has no bone to roll about");
            let axis = pose.roll_axis(joint).ok_or_else(no_bone)?;
            Ok(pose.turned(joint, axis, params.angle, Space::Joint))
        })
    }

    /// Changes the stored rotation of one joint to what `turned` makes of the stored pose.
    fn turn(
        &self,
        rig: &str,
        joint: &str,
        limits: wire::LimitPolicy,
        turned: impl FnOnce(&Pose, usize) -> Result<DQuat, FieldFault>,
    ) -> Result<wire::PoseSetResult, Fault> {
        let (loaded, clamped) = self.engine().set_pose(rig, |current| {
            let index = joint_named(joint, &current.loaded.rig)
                .map_err(|problem| FieldFault::new("joint", problem))?;
            let edit = PoseEdit {
                rotations: vec![(index, turned(&current.stored, index)?)],
                limits: of_limits(limits),
                ..PoseEdit::default()
            };
            let changed = current.changed(Base::Stored, &edit);
            changed.map_err(|error| match error {
                PoseError::OutsideLimits(outside) => {
                    Fault::invalid_params("angle", outside.to_string())
                }
                PoseError::OutOfRange(out) => Fault::invalid_params("pose", out.to_string()),
            })
        })?;
        Ok(wire::PoseSetResult {
            clamped: describe::clamped(&loaded.rig, &clamped),
        })
    }

    pub(super) fn joint_transforms(
        &self,
        params: &wire::TransformsParams,
    ) -> Result<wire::Transforms, Fault> {
        let found = self.engine().rig(&params.rig)?;
        let (posed, clamped) = self.posed(&params.pose, &found).map_err(of_pose)?;
        let joints = posed.rig().skeleton().joints();
        let transforms =
            joints
                .iter()
                .zip(posed.world_from_joint())
                .map(|(joint, &world_from_joint)| wire::JointTransform {
                    name: joint.name.clone(),
                    parent: describe::parent_name(joint, joints),
                    world_from_joint: DMat4::from(world_from_joint).to_cols_array(),
                });
        Ok(wire::Transforms {
            joints: transforms.collect(),
            clamped: describe::clamped(posed.rig(), &clamped),
        })
    }

    /// The pose of this request, worked out, and what limits changed in it. A fault is as seen from the pose.
    pub(super) fn posed(
        &self,
        pose: &wire::Pose,
        found: &RigRef,
    ) -> Result<(Arc<Posed>, Vec<Clamped>), FieldFault> {
        let (base, edit) = self.edit(pose, found)?;
        found
            .posed(base, &edit)
            .map_err(|error| located(error, pose))
    }

    /// Whether the pose can be asked for. It is not worked out. A fault is as seen from the pose.
    pub(super) fn check_pose(&self, pose: &wire::Pose, found: &RigRef) -> Result<(), FieldFault> {
        let (base, edit) = self.edit(pose, found)?;
        let edited = found.start(base).edited(&edit).map_err(PoseError::from);
        edited.map(drop).map_err(|error| located(error, pose))
    }

    fn edit(&self, pose: &wire::Pose, current: &RigRef) -> Result<(Base, PoseEdit), FieldFault> {
        let rig = &current.loaded.rig;
        let base = match pose.base {
            Some(wire::PoseBase::Stored) => Base::Stored,
            Some(wire::PoseBase::Rest) => Base::Rest,
            // What a digest names is the same everywhere, so a server's own pose has no part in it.
            None if current.by_digest => Base::Rest,
            None => Base::Stored,
        };
        let dofs = match &pose.dof_values {
            None => named_dofs(&pose.dofs, rig)?,
            Some(values) if pose.dofs.is_empty() => self.all_dofs(values, rig)?,
            Some(_) => {
                return Err(FieldFault::new(
                    "dof_values",
                    "expected either `dofs` or `dof_values`, but found both",
                ));
            }
        };
        Ok((
            base,
            PoseEdit {
                clips: clips(pose, rig)?,
                rotations: rotations(&pose.rotations, rig)?,
                dofs,
                limits: of_limits(pose.limits),
            },
        ))
    }

    /// As many as there are. A fault is as seen from the values.
    pub(super) fn numbers(&self, values: &wire::DofValues) -> Result<Vec<f64>, FieldFault> {
        let attach = match values {
            wire::DofValues::List(values) => return Ok(values.clone()),
            wire::DofValues::Attached { attach } => attach,
        };
        let bytes = attach
            .of(&self.attached)
            .map_err(|fault| fault.within("attach"))?;
        let (words, rest) = bytes.as_chunks::<4>();
        if !rest.is_empty() {
            let problem = format!("expected float32 numbers, but found {} bytes", bytes.len());
            return Err(FieldFault::new("attach", problem));
        }
        let values = words.iter().map(|&word| f32::from_le_bytes(word));
        Ok(values.map(f64::from).collect())
    }

    fn all_dofs(
        &self,
        values: &wire::DofValues,
        rig: &Rig,
    ) -> Result<Vec<(usize, f64)>, FieldFault> {
        let field = "dof_values";
        let values = self.numbers(values).map_err(|fault| fault.within(field))?;
        let (wanted, found) = (rig.dofs().all().len(), values.len());
        if wanted != found {
            let problem = format!("expected {wanted} values, one for each DOF, but found {found}");
            return Err(FieldFault::new(field, problem));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(FieldFault::new((field, index), "expected a finite number"));
        }
        Ok(values.into_iter().enumerate().collect())
    }
}

/// A fault of a request's own pose, as seen from the request.
pub(super) fn of_pose(fault: FieldFault) -> FieldFault {
    fault.within("pose")
}

/// A value past its limits is at fault where the pose gives it.
fn located(error: PoseError, pose: &wire::Pose) -> FieldFault {
    let outside = match error {
        PoseError::OutsideLimits(outside) => outside,
        PoseError::OutOfRange(out) => {
            return FieldFault::new(FieldPath::default(), out.to_string());
        }
    };
    let path = if pose.dofs.contains_key(&outside.dof) {
        FieldPath::from("dofs").field(outside.dof.clone())
    } else if pose.dof_values.is_some() {
        "dof_values".into()
    } else if pose.rotations.is_empty() && pose.clip.is_some() {
        "clip".into()
    } else if pose.rotations.is_empty() {
        "clips".into()
    } else {
        "rotations".into()
    };
    FieldFault::new(path, outside.to_string())
}

fn of_limits(limits: wire::LimitPolicy) -> LimitPolicy {
    match limits {
        wire::LimitPolicy::Clamp => LimitPolicy::Clamp,
        wire::LimitPolicy::Reject => LimitPolicy::Reject,
        wire::LimitPolicy::Ignore => LimitPolicy::Ignore,
    }
}

fn clips(pose: &wire::Pose, rig: &Rig) -> Result<Vec<ClipAt>, FieldFault> {
    if let Some(wire::ClipAt { name, time }) = &pose.clip {
        if !pose.clips.is_empty() {
            let problem = "expected either `clip` or `clips`, but found both";
            return Err(FieldFault::new("clips", problem));
        }
        let only = clip_at(name, *time, 1.0, rig).map_err(|fault| fault.within("clip"))?;
        return Ok(vec![only]);
    }
    let clip = |(index, clip): (usize, &wire::WeightedClip)| {
        clip_at(&clip.name, clip.time, clip.weight, rig)
            .map_err(|fault| fault.within(("clips", index)))
    };
    pose.clips.iter().enumerate().map(clip).collect()
}

/// A fault is as seen from the clip.
fn clip_at(name: &str, time: f64, weight: f64, rig: &Rig) -> Result<ClipAt, FieldFault> {
    // As far as the keys of a clip can be.
    if time.abs() > LARGEST_COORDINATE {
        let problem = format!("expected a time within ±{LARGEST_COORDINATE:e}, but found {time:e}");
        return Err(FieldFault::new("time", problem));
    }
    if !(0.0..=LARGEST_COORDINATE).contains(&weight) {
        let problem =
            format!("expected a number from 0 to {LARGEST_COORDINATE:e}, but found {weight:e}");
        return Err(FieldFault::new("weight", problem));
    }
    match rig.clips().iter().position(|clip| clip.name == name) {
        Some(clip) => Ok(ClipAt { clip, time, weight }),
        None => {
            let known = rig.clips().iter().map(|clip| clip.name.as_str());
            Err(FieldFault::new("name", unknown("clip", name, known)))
        }
    }
}

fn named_dofs(dofs: &BTreeMap<String, f64>, rig: &Rig) -> Result<Vec<(usize, f64)>, FieldFault> {
    let index = |(name, &value): (&String, &f64)| match rig.dofs().named(name) {
        Some(dof) => Ok((dof, value)),
        None => Err(FieldFault::new(
            FieldPath::from("dofs").field(name.clone()),
            unknown_dof(name, rig),
        )),
    };
    dofs.iter().map(index).collect()
}

fn rotations(
    rotations: &BTreeMap<String, [f64; 4]>,
    rig: &Rig,
) -> Result<Vec<(usize, DQuat)>, FieldFault> {
    let index = |(name, &rotation): (&String, &[f64; 4])| {
        let path = || FieldPath::from("rotations").field(name.clone());
        let joint = joint_named(name, rig).map_err(|problem| FieldFault::new(path(), problem))?;
        let length = DQuat::from_array(rotation).length();
        // Off by more than float32 or a few printed decimals leave, it was not meant as a rotation.
        if (length - 1.0).abs() > 1e-2 {
            let problem = format!(
                "expected a unit quaternion [x, y, z, w], but found one of length {length}"
            );
            return Err(FieldFault::new(path(), problem));
        }
        Ok((joint, DQuat::from_array(rotation).normalize()))
    };
    rotations.iter().map(index).collect()
}

/// The joint's index, or what is wrong with its name.
fn joint_named(name: &str, rig: &Rig) -> Result<usize, String> {
    let found = rig.skeleton().joint_named(name);
    found.ok_or_else(|| unknown_joint(name, rig))
}
