//! `pose.*` and `joint.transforms`.

use super::call::Call;
use super::describe;
use super::prepared_pose::{EvaluatedPose, PreparedPose, joint_named, limit_policy};
use crate::engine::{Base, PoseError, RigRef};
use crate::pose::{Pose, PoseEdit, Space};
use crate::protocol::pose as wire;
use crate::protocol::rig::RigParams;
use crate::protocol::{Done, Fault, FieldFault};
use glam::{DMat4, DQuat, DVec3};

impl Call {
    pub(super) fn get_pose(&self, params: &RigParams) -> Result<wire::StoredPose, Fault> {
        let RigRef { loaded, stored, .. } = self.engine().rig(&params.rig)?;
        let rig = &loaded.rig;
        let names = rig.dofs().all().iter().map(|dof| dof.name.clone());
        let joints = rig.skeleton().joints().iter().enumerate();
        let joints = joints.map(|(index, joint)| {
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
        params: wire::PoseSetParams,
    ) -> Result<wire::PoseSetResult, Fault> {
        let (loaded, clamped) = self.engine().set_pose::<Fault>(&params.rig, |current| {
            let pose = self.prepare_pose(params.pose, current)?;
            Ok(pose.change(current).map_err(of_pose)?)
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
                limits: limit_policy(limits),
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
        params: wire::TransformsParams,
    ) -> Result<wire::Transforms, Fault> {
        let found = self.engine().rig(&params.rig)?;
        let pose = self.prepare_pose(params.pose, &found)?;
        let EvaluatedPose { posed, clamped } = pose.evaluate(&found).map_err(of_pose)?;
        let joints = posed.rig().skeleton().joints();
        let placed = joints.iter().zip(posed.world_from_joint());
        let transforms = placed.map(|(joint, &world_from_joint)| wire::JointTransform {
            name: joint.name.clone(),
            parent: describe::parent_name(joint, joints),
            world_from_joint: DMat4::from(world_from_joint).to_cols_array(),
        });
        Ok(wire::Transforms {
            joints: transforms.collect(),
            clamped,
        })
    }

    /// The `pose` of a request.
    pub(super) fn prepare_pose(
        &self,
        pose: wire::Pose,
        found: &RigRef,
    ) -> Result<PreparedPose, FieldFault> {
        PreparedPose::new(pose, &self.attached, found).map_err(of_pose)
    }
}

/// A fault of a request's own pose, as seen from the request.
pub(super) fn of_pose(fault: FieldFault) -> FieldFault {
    fault.within("pose")
}
