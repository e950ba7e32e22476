//! The file family of the MIT course 6.837: one reader per extension, the grammar in its module doc. Rows are lines here.
//! Never lives here: other dialects that use the same extensions, and which mesh goes with which attachments.

pub(super) mod attach;
mod draw_vertices;
pub(super) mod mention;
pub(super) mod mtl;
pub(super) mod obj;
mod polygon;
pub(super) mod skel;
mod statements;
#[cfg(test)]
mod tests;

use crate::rig::{BindPose, BindingDraft, JointDraft};
use glam::{DAffine3, DVec3};

/// Where each joint stands when nothing is turned, which is how the course's meshes were bound: one binding per joint.
/// Parents stand before their children, as [`skel::read`] gives them.
pub(super) fn bindings(joints: &[JointDraft]) -> Vec<BindingDraft> {
    let mut positions_in_bind: Vec<DVec3> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent_position_in_bind = joint
            .parent
            .map_or(DVec3::ZERO, |parent| positions_in_bind[parent]);
        positions_in_bind.push(parent_position_in_bind + joint.offset);
    }
    let binding = |(joint, position_in_bind)| BindingDraft {
        joint: Some(joint),
        stood: BindPose::BindFromJoint(DAffine3::from_translation(position_in_bind)),
    };
    positions_in_bind
        .into_iter()
        .enumerate()
        .map(binding)
        .collect()
}
