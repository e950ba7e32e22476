//! `pose.*` and `joint.transforms`, and what every request with a pose needs: from names to indices.

use super::names::{unknown, unknown_dof, unknown_joint};
use super::{Call, describe};
use crate::engine::{Base, EngineError, RigRef};
use crate::pose::{Clamped, ClipAt, LimitPolicy, Pose, PoseEdit, Posed, Space};
use crate::protocol::pose as wire;
use crate::protocol::rig::RigParams;
use crate::protocol::{Done, Fault, shortened};
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
        let choose = |current: &RigRef| self.edit(&params.pose, current);
        let set = self.engine().set_pose(&params.rig, choose);
        let (loaded, clamped) = set.map_err(|error| located(error, &params.pose))?;
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
            let axis = pose.roll_axis(joint);
            let axis =
                axis.ok_or_else(|| no_such("joint", "the joint has no bone to roll about"))?;
            Ok(pose.turned(joint, axis, params.angle, Space::Joint))
        })
    }

    /// Changes the stored rotation of one joint to what `turned` makes of the stored pose.
    fn turn(
        &self,
        rig: &str,
        joint: &str,
        limits: wire::LimitPolicy,
        turned: impl FnOnce(&Pose, usize) -> Result<DQuat, EngineError>,
    ) -> Result<wire::PoseSetResult, Fault> {
        let set = self.engine().set_pose(rig, |current| {
            let index = joint_named(joint, &current.loaded.rig)
                .map_err(|problem| no_such("joint", problem))?;
            let edit = PoseEdit {
                rotations: vec![(index, turned(&current.stored, index)?)],
                limits: of_limits(limits),
                ..PoseEdit::default()
            };
            Ok((Base::Stored, edit))
        });
        let (loaded, clamped) = set.map_err(|error| match error {
            EngineError::OutsideLimits(outside) => {
                Fault::invalid_params("angle", outside.to_string())
            }
            other => other.into(),
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
        let (posed, clamped) = self.posed(&params.pose, &found)?;
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

    /// The pose of this request, worked out, and what limits changed in it.
    pub(super) fn posed(
        &self,
        pose: &wire::Pose,
        found: &RigRef,
    ) -> Result<(Arc<Posed>, Vec<Clamped>), Fault> {
        let (base, edit) = self.edit(pose, found)?;
        found
            .posed(base, &edit)
            .map_err(|error| located(error, pose))
    }

    /// Whether the pose can be asked for. It is not worked out.
    pub(super) fn check_pose(&self, pose: &wire::Pose, found: &RigRef) -> Result<(), Fault> {
        let (base, edit) = self.edit(pose, found)?;
        let edited = found.start(base).edited(&edit).map_err(EngineError::from);
        edited.map(drop).map_err(|error| located(error, pose))
    }

    fn edit(&self, pose: &wire::Pose, current: &RigRef) -> Result<(Base, PoseEdit), EngineError> {
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
                return Err(no_such(
                    "pose.dof_values",
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

    /// As many as there are. `field` is theirs.
    pub(super) fn numbers(
        &self,
        values: &wire::DofValues,
        field: &str,
    ) -> Result<Vec<f64>, EngineError> {
        let attach = match values {
            wire::DofValues::List(values) => return Ok(values.clone()),
            wire::DofValues::Attached { attach } => attach,
        };
        let path = format!("{field}.attach");
        let bytes = attach.of(&self.attached, &path);
        let bytes = bytes.map_err(|fault| match fault {
            Fault::InvalidParams { path, message } => no_such(path, message),
            other => no_such(&path, other.to_string()),
        })?;
        let (words, rest) = bytes.as_chunks::<4>();
        if !rest.is_empty() {
            let problem = format!("expected float32 numbers, but found {} bytes", bytes.len());
            return Err(no_such(path, problem));
        }
        let values = words.iter().map(|&word| f32::from_le_bytes(word));
        Ok(values.map(f64::from).collect())
    }

    fn all_dofs(
        &self,
        values: &wire::DofValues,
        rig: &Rig,
    ) -> Result<Vec<(usize, f64)>, EngineError> {
        let values = self.numbers(values, "pose.dof_values")?;
        let (wanted, found) = (rig.dofs().all().len(), values.len());
        if wanted != found {
            return Err(no_such(
                "pose.dof_values",
                format!("expected {wanted} values, one for each DOF, but found {found}"),
            ));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(no_such(
                format!("pose.dof_values[{index}]"),
                "expected a finite number",
            ));
        }
        Ok(values.into_iter().enumerate().collect())
    }
}

/// A value past its limits is at fault where the request gave it.
fn located(error: EngineError, pose: &wire::Pose) -> Fault {
    let EngineError::OutsideLimits(outside) = error else {
        return error.into();
    };
    let path = if pose.dofs.contains_key(&outside.dof) {
        format!("pose.dofs.{}", outside.dof)
    } else if pose.dof_values.is_some() {
        "pose.dof_values".to_owned()
    } else if pose.rotations.is_empty() && pose.clip.is_some() {
        "pose.clip".to_owned()
    } else if pose.rotations.is_empty() {
        "pose.clips".to_owned()
    } else {
        "pose.rotations".to_owned()
    };
    Fault::invalid_params(path, outside.to_string())
}

fn of_limits(limits: wire::LimitPolicy) -> LimitPolicy {
    match limits {
        wire::LimitPolicy::Clamp => LimitPolicy::Clamp,
        wire::LimitPolicy::Reject => LimitPolicy::Reject,
        wire::LimitPolicy::Ignore => LimitPolicy::Ignore,
    }
}

fn clips(pose: &wire::Pose, rig: &Rig) -> Result<Vec<ClipAt>, EngineError> {
    if let Some(wire::ClipAt { name, time }) = &pose.clip {
        if !pose.clips.is_empty() {
            let problem = "expected either `clip` or `clips`, but found both";
            return Err(no_such("pose.clips", problem));
        }
        return Ok(vec![clip_at(name, *time, 1.0, "pose.clip", rig)?]);
    }
    let clip = |(index, clip): (usize, &wire::WeightedClip)| {
        let field = format!("pose.clips[{index}]");
        clip_at(&clip.name, clip.time, clip.weight, &field, rig)
    };
    pose.clips.iter().enumerate().map(clip).collect()
}

fn clip_at(
    name: &str,
    time: f64,
    weight: f64,
    field: &str,
    rig: &Rig,
) -> Result<ClipAt, EngineError> {
    // As far as the keys of a clip can be.
    if time.abs() > LARGEST_COORDINATE {
        let problem = format!("expected a time within ±{LARGEST_COORDINATE:e}, but found {time:e}");
        return Err(no_such(format!("{field}.time"), problem));
    }
    if !(0.0..=LARGEST_COORDINATE).contains(&weight) {
        let problem =
            format!("expected a number from 0 to {LARGEST_COORDINATE:e}, but found {weight:e}");
        return Err(no_such(format!("{field}.weight"), problem));
    }
    match rig.clips().iter().position(|clip| clip.name == name) {
        Some(clip) => Ok(ClipAt { clip, time, weight }),
        None => {
            let known = rig.clips().iter().map(|clip| clip.name.as_str());
            Err(no_such(
                format!("{field}.name"),
                unknown("clip", name, known),
            ))
        }
    }
}

fn named_dofs(dofs: &BTreeMap<String, f64>, rig: &Rig) -> Result<Vec<(usize, f64)>, EngineError> {
    let index = |(name, &value): (&String, &f64)| match rig.dofs().named(name) {
        Some(dof) => Ok((dof, value)),
        None => Err(no_such(
            format!("pose.dofs.{}", shortened(name)),
            unknown_dof(name, rig),
        )),
    };
    dofs.iter().map(index).collect()
}

fn rotations(
    rotations: &BTreeMap<String, [f64; 4]>,
    rig: &Rig,
) -> Result<Vec<(usize, DQuat)>, EngineError> {
    let index = |(name, &rotation): (&String, &[f64; 4])| {
        let field = || format!("pose.rotations.{}", shortened(name));
        let joint = joint_named(name, rig).map_err(|problem| no_such(field(), problem))?;
        let length = DQuat::from_array(rotation).length();
        // Off by more than float32 or a few printed decimals leave, it was not meant as a rotation.
        if (length - 1.0).abs() > 1e-2 {
            let problem = format!(
                "expected a unit quaternion [x, y, z, w], but found one of length {length}"
            );
            return Err(no_such(field(), problem));
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

pub(super) fn no_such(field: impl Into<String>, problem: impl Into<String>) -> EngineError {
    EngineError::NoSuchPart {
        field: field.into(),
        problem: problem.into(),
    }
}
