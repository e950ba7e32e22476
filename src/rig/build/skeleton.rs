//! Joints, and what they were bound at.

use super::{LARGEST_COORDINATE, finite, is_usable};
use crate::rig::{
    Axis, BindPose, Binding, BindingDraft, Joint, JointDraft, Limit, RigError, RigProblem,
    Rotation, Skeleton, names,
};
use glam::DVec3;

pub(super) fn build(drafts: Vec<JointDraft>) -> Result<Skeleton, RigProblem> {
    let unique_names = names::unique("joint", drafts.iter().map(|joint| joint.name.as_str()));
    let mut joints = Vec::with_capacity(drafts.len());
    for (index, (draft, name)) in drafts.into_iter().zip(unique_names).enumerate() {
        match draft.parent {
            Some(parent) if parent >= index => {
                return Err(RigProblem::ParentNotBefore {
                    joint: index,
                    parent,
                });
            }
            _ => {}
        }
        let corners_finite = draft
            .bounding_box
            .is_none_or(|corners| corners.iter().all(|corner| is_usable(&corner.to_array())));
        finite(
            is_usable(&draft.offset.to_array())
                && is_usable(&draft.rest_scale.to_array())
                && is_usable(&numbers_of(draft.rest_rotation))
                && corners_finite,
            || format!("the offset, pose, scale or box of joint `{name}`"),
        )?;
        for axis in Axis::ALL {
            let Limit { min, max } = draft.rotation_limits[axis.index()];
            // Ends may be infinite, but what is clamped between them may not.
            let has_usable = min <= LARGEST_COORDINATE && max >= -LARGEST_COORDINATE;
            finite(has_usable, || format!("a limit of joint `{name}`"))?;
            if min > max {
                return Err(RigProblem::LimitReversed {
                    joint: index,
                    min,
                    max,
                });
            }
        }
        let rest_rotation = match draft.rest_rotation {
            Rotation::Angles(angles) => {
                let clamped = |axis: usize| draft.rotation_limits[axis].clamp(angles[axis]);
                Rotation::Angles(DVec3::new(clamped(0), clamped(1), clamped(2)))
            }
            quaternion @ Rotation::Quaternion(_) => quaternion,
        };
        joints.push(Joint {
            name,
            parent: draft.parent,
            offset: draft.offset,
            rotation_order: draft.rotation_order,
            rest_rotation,
            rest_scale: draft.rest_scale,
            rotation_limits: draft.rotation_limits,
            translates: draft.translates,
            scales: draft.scales,
            bounding_box: draft.bounding_box.map(|[a, b]| [a.min(b), a.max(b)]),
        });
    }
    Ok(Skeleton::new(joints))
}

pub(super) fn build_bindings(
    drafts: &[BindingDraft],
    joint_count: usize,
) -> Result<Vec<Binding>, RigError> {
    let binding = |(index, draft): (usize, &BindingDraft)| {
        build_binding(index, draft, joint_count).map_err(|problem| problem.of(draft.file.as_ref()))
    };
    drafts.iter().enumerate().map(binding).collect()
}

fn build_binding(
    index: usize,
    draft: &BindingDraft,
    joint_count: usize,
) -> Result<Binding, RigProblem> {
    if let Some(found) = draft.joint.filter(|&joint| joint >= joint_count) {
        return Err(RigProblem::OutOfRange {
            what: format!("binding {index}"),
            target: "joint",
            found,
            count: joint_count,
        });
    }
    let (BindPose::BindFromJoint(given) | BindPose::JointFromBind(given)) = draft.bind_pose;
    finite(is_usable(&given.to_cols_array()), || {
        format!("the matrix of binding {index}")
    })?;
    let joint_from_bind = match draft.bind_pose {
        BindPose::BindFromJoint(bind_from_joint) => bind_from_joint.inverse(),
        BindPose::JointFromBind(joint_from_bind) => joint_from_bind,
    };
    // A nearly singular matrix has an inverse that is only rounding error.
    if !is_usable(&joint_from_bind.to_cols_array()) {
        return Err(RigProblem::SingularBinding { binding: index });
    }
    Ok(Binding {
        joint: draft.joint,
        joint_from_bind,
    })
}

fn numbers_of(rotation: Rotation) -> [f64; 4] {
    match rotation {
        Rotation::Angles(angles) => angles.extend(0.0).to_array(),
        Rotation::Quaternion(quaternion) => quaternion.to_array(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_may_have_any_ends_that_leave_a_finite_angle() {
        let built = |min: f64, max: f64| {
            let mut joint = JointDraft::default();
            joint.rotation_limits[0] = Limit { min, max };
            build(vec![joint])
        };
        for (min, max) in [
            (-1e10, 1e10),
            (f64::NEG_INFINITY, f64::INFINITY),
            (1e9, f64::INFINITY),
        ] {
            assert!(built(min, max).is_ok(), "{min} {max}");
        }
        for (min, max) in [
            (f64::INFINITY, f64::INFINITY),
            (1.1e9, 1.2e9),
            (f64::NEG_INFINITY, -1.1e9),
            (f64::NAN, 1.0),
            (0.0, f64::NAN),
        ] {
            let refused = built(min, max).map(drop);
            assert!(
                matches!(refused, Err(RigProblem::NotFinite { .. })),
                "{min} {max}"
            );
        }
    }
}
