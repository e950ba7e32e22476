//! Joints, and what they were bound at.

use super::{finite, is_usable};
use crate::rig::{
    Axis, Binding, BindingDraft, Joint, JointDraft, Limit, RigError, Skeleton, names,
};

pub(super) fn build(drafts: Vec<JointDraft>) -> Result<Skeleton, RigError> {
    let unique_names = names::unique("joint", drafts.iter().map(|joint| joint.name.as_str()));
    let mut joints = Vec::with_capacity(drafts.len());
    for (index, (draft, name)) in drafts.into_iter().zip(unique_names).enumerate() {
        match draft.parent {
            Some(parent) if parent >= index => {
                return Err(RigError::ParentNotBefore {
                    joint: index,
                    parent,
                });
            }
            None if index > 0 => return Err(RigError::SecondRoot { joint: index }),
            _ => {}
        }
        let corners_finite = draft
            .bounding_box
            .is_none_or(|corners| corners.iter().all(|corner| is_usable(&corner.to_array())));
        finite(
            is_usable(&draft.offset.to_array())
                && is_usable(&draft.rest_angles.to_array())
                && corners_finite,
            None,
            || format!("the offset, pose or box of joint `{name}`"),
        )?;
        let mut rest_angles = draft.rest_angles;
        for axis in Axis::ALL {
            let Limit { min, max } = draft.rotation_limits[axis.index()];
            finite(!min.is_nan() && !max.is_nan(), None, || {
                format!("a limit of joint `{name}`")
            })?;
            if min > max {
                return Err(RigError::LimitReversed {
                    joint: index,
                    min,
                    max,
                });
            }
            rest_angles[axis.index()] =
                draft.rotation_limits[axis.index()].clamp(rest_angles[axis.index()]);
        }
        joints.push(Joint {
            name,
            parent: draft.parent,
            offset: draft.offset,
            rotation_order: draft.rotation_order,
            rest_angles,
            rotation_limits: draft.rotation_limits,
            translates: draft.translates,
            bounding_box: draft.bounding_box.map(|[a, b]| [a.min(b), a.max(b)]),
        });
    }
    Ok(Skeleton::new(joints))
}

pub(super) fn build_bindings(
    drafts: &[BindingDraft],
    joint_count: usize,
) -> Result<Vec<Binding>, RigError> {
    let build = |(index, draft): (usize, &BindingDraft)| {
        if let Some(joint) = draft.joint.filter(|&joint| joint >= joint_count) {
            let (what, target) = ("binding", "joint");
            return Err(RigError::OutOfRange {
                mesh: 0,
                what,
                index,
                target,
                found: joint,
                count: joint_count,
            });
        }
        finite(
            is_usable(&draft.bind_from_joint.to_cols_array()),
            Some(0),
            || format!("the matrix of binding {index}"),
        )?;
        let joint_from_bind = draft.bind_from_joint.inverse();
        // A nearly singular matrix has an inverse that is only rounding error.
        if !is_usable(&joint_from_bind.to_cols_array()) {
            return Err(RigError::SingularBinding { binding: index });
        }
        Ok(Binding {
            joint: draft.joint,
            joint_from_bind,
        })
    };
    drafts.iter().enumerate().map(build).collect()
}
