//! Turning a joint from where it is: about an axis, or about its own bone. Never lives here: limits, which [`Pose::edited`] holds the
//! outcome against.

use super::Pose;
use glam::{DQuat, DVec3};

/// Which frame an axis is given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// The joint's own, which turns with it.
    Joint,
    /// The world's, in which root joints are placed.
    World,
}

impl Pose {
    /// The local rotation of a joint after a turn by `angle` radians, counter-clockwise about `axis`: `q·R` in the joint's own frame,
    /// `P⁻¹·R·P·q` in world space, where `P` is how its parent is turned. Unit length. The axis may have any length; one of 0 turns
    /// nothing.
    pub fn turned(&self, joint: usize, axis: DVec3, angle: f64, space: Space) -> DQuat {
        let parent_from_joint = self.local(joint).rotation;
        let turn = unit(axis).map_or(DQuat::IDENTITY, |axis| DQuat::from_axis_angle(axis, angle));
        let turned = match space {
            Space::Joint => parent_from_joint * turn,
            Space::World => {
                let world_from_parent = self
                    .joint(joint)
                    .parent
                    .map_or(DQuat::IDENTITY, |parent| self.world_rotation(parent));
                world_from_parent.inverse() * turn * world_from_parent * parent_from_joint
            }
        };
        // Turns are made one on top of another, thousands of times; without this their rounding would add up to a scale.
        turned.normalize()
    }

    /// The direction that rolling a joint turns about, in its own frame and of unit length: toward its first child at non-zero distance,
    /// else on along the line from its parent; a joint where its parent is has the parent's own. `None` where there is no bone at all.
    pub fn roll_axis(&self, joint: usize) -> Option<DVec3> {
        let mut joint_from_here = DQuat::IDENTITY;
        let mut here = joint;
        loop {
            if let Some(axis_in_here) = self.toward_a_child(here) {
                return Some(joint_from_here * axis_in_here);
            }
            let parent = self.joint(here).parent?;
            let local = self.local(here);
            let joint_from_parent = joint_from_here * local.rotation.inverse();
            // Before the parent is turned, its scale moves what hangs on it.
            if let Some(axis_in_parent) = unit(self.local(parent).scale * local.translation) {
                return Some(joint_from_parent * axis_in_parent);
            }
            (joint_from_here, here) = (joint_from_parent, parent);
        }
    }

    fn toward_a_child(&self, joint: usize) -> Option<DVec3> {
        let children = self.rig().skeleton().children(joint).iter();
        let scale = self.local(joint).scale;
        children
            .map(|&child| scale * self.local(child).translation)
            .find_map(unit)
    }

    fn world_rotation(&self, joint: usize) -> DQuat {
        let ancestors = std::iter::successors(Some(joint), |&at| self.joint(at).parent);
        ancestors
            .map(|at| self.local(at).rotation)
            .reduce(|here, parent| parent * here)
            .unwrap_or(DQuat::IDENTITY)
            .normalize()
    }
}

/// `None` where the vector has no direction. Its largest number is made 1 first: the square of a length can vanish or overflow where
/// the length does not.
fn unit(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    (vector / largest).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::pose::{PoseEdit, Posed};
    use crate::rig::{Draft, JointDraft, Rotation, RotationOrder};
    use glam::DAffine3;
    use std::sync::Arc;

    /// Units and radians: what a few hundred rotations in f64 lose.
    const ROUNDING: f64 = 1e-9;

    const SKEW: DVec3 = DVec3::new(0.3, -2.0, 1.1);

    fn posed(joints: &[(Option<usize>, DVec3)], order: RotationOrder) -> Pose {
        let joint = |(index, &(parent, offset)): (usize, &(Option<usize>, DVec3))| JointDraft {
            parent,
            offset,
            rotation_order: order,
            rest_rotation: Rotation::Angles(
                DVec3::new(0.4, -0.9, 1.7) * (1.0 + 0.37 * index as f64),
            ),
            translates: parent.is_none(),
            ..JointDraft::default()
        };
        let draft = Draft {
            joints: joints.iter().enumerate().map(joint).collect(),
            ..Draft::default()
        };
        Pose::rest(&Arc::new(
            draft.build(&Limits::default()).expect("a valid draft"),
        ))
    }

    /// ```text
    /// 0 - 1 - 2 = 3 - 4 = 6      = no distance
    /// ‖    \
    /// 5     7 - 9
    ///       ‖
    ///       8
    /// ```
    fn tree(order: RotationOrder) -> Pose {
        let joints = [
            (None, DVec3::new(5.0, 1.0, 0.0)),
            (Some(0), DVec3::new(0.2, 1.0, 0.1)),
            (Some(1), DVec3::new(0.5, 0.7, -0.3)),
            (Some(2), DVec3::ZERO),
            (Some(3), DVec3::new(0.0, 0.6, 0.2)),
            (Some(0), DVec3::ZERO),
            (Some(4), DVec3::ZERO),
            (Some(1), DVec3::new(-0.5, 0.7, 0.3)),
            (Some(7), DVec3::ZERO),
            (Some(7), DVec3::new(-0.1, 0.4, 0.0)),
        ];
        posed(&joints, order)
    }

    fn placed(pose: &Pose) -> Vec<DAffine3> {
        let posed = Posed::new(pose).expect("within range");
        posed.world_from_joint().to_vec()
    }

    fn with(pose: &Pose, joint: usize, rotation: DQuat) -> Pose {
        let edit = PoseEdit {
            rotations: vec![(joint, rotation)],
            ..PoseEdit::default()
        };
        pose.edited(&edit).expect("no limits").0
    }

    #[test]
    fn a_full_circle_of_small_turns_comes_back_and_children_follow_rigidly() {
        for order in [RotationOrder::Xyz, RotationOrder::Zyx] {
            for space in [Space::Joint, Space::World] {
                let start = tree(order);
                let before = placed(&start);
                let mut pose = start.clone();
                for step in 1..=360 {
                    let rotation = pose.turned(1, SKEW, 1f64.to_radians(), space);
                    assert!((rotation.length() - 1.0).abs() < 1e-15);
                    pose = with(&pose, 1, rotation);
                    let now = placed(&pose);
                    for child in [2, 3, 4, 6, 7, 8, 9] {
                        let was = before[1].inverse() * before[child];
                        let is = now[1].inverse() * now[child];
                        assert!(is.abs_diff_eq(was, ROUNDING), "{order:?} {space:?} {child}");
                    }
                    let is_back = now[4].abs_diff_eq(before[4], ROUNDING);
                    assert_eq!(is_back, step == 360, "{order:?} {space:?} {step}");
                    for other in [0, 5] {
                        assert_eq!(now[other], before[other]);
                    }
                }
            }
        }
    }

    #[test]
    fn the_axis_stands_still_in_the_space_that_it_is_given_in() {
        for order in [RotationOrder::Xyz, RotationOrder::Zyx] {
            let start = tree(order);
            let before = placed(&start);
            let angle = 0.8;
            // What the turn is in world space: the joint's matrix after it, without what it was before.
            let turn = |space| {
                let after = placed(&with(&start, 2, start.turned(2, SKEW * 40.0, angle, space)));
                DQuat::from_mat3(&(after[2].matrix3 * before[2].matrix3.inverse()))
            };
            let axis = SKEW.normalize_or_zero();
            let about = |axis| DQuat::from_axis_angle(axis, angle);
            let in_world = turn(Space::World);
            assert!(in_world.abs_diff_eq(about(axis), ROUNDING), "{in_world}");
            let in_joint = turn(Space::Joint);
            let wanted = about(before[2].matrix3 * axis);
            assert!(in_joint.abs_diff_eq(wanted, ROUNDING), "{in_joint}");
        }
    }

    #[test]
    fn an_axis_may_have_any_length_but_none() {
        let pose = tree(RotationOrder::Zyx);
        let wanted = pose.turned(2, SKEW, 0.8, Space::World);
        for length in [1e-300, 1e-12, 1e300] {
            let found = pose.turned(2, SKEW * length, 0.8, Space::World);
            assert!(found.abs_diff_eq(wanted, ROUNDING), "{length:e}: {found}");
        }
        let found = pose.turned(2, DVec3::ZERO, 0.8, Space::Joint);
        assert!(
            found.abs_diff_eq(pose.local(2).rotation, ROUNDING),
            "{found}"
        );
    }

    #[test]
    fn rolling_turns_a_bone_in_place() {
        for order in [RotationOrder::Xyz, RotationOrder::Zyx] {
            let start = tree(order);
            let before = placed(&start);
            for (joint, child) in [(0, 1), (1, 2), (3, 4), (7, 9)] {
                let axis = start.roll_axis(joint).expect("a bone");
                let rolled = with(&start, joint, start.turned(joint, axis, 1.3, Space::Joint));
                let after = placed(&rolled);
                let moved = |at: usize| after[at].translation.distance(before[at].translation);
                assert!(moved(child) < ROUNDING, "{order:?} {joint}");
                assert!(!after[joint].abs_diff_eq(before[joint], 0.1));
                // The line from the joint to its child, not from the child to the joint.
                let along = before[child].translation - before[joint].translation;
                assert!(along.dot(before[joint].matrix3 * axis) > 0.0);
            }
            let axis = start.roll_axis(1).expect("a bone");
            let after = placed(&with(&start, 1, start.turned(1, axis, 1.3, Space::Joint)));
            assert!(after[7].translation.distance(before[7].translation) > 0.1);
        }
    }

    #[test]
    fn a_joint_without_a_bone_rolls_about_the_one_before_it() {
        for order in [RotationOrder::Xyz, RotationOrder::Zyx] {
            let pose = tree(order);
            let at = placed(&pose);
            let line = |from: usize, to: usize| {
                (at[to].translation - at[from].translation).normalize_or_zero()
            };
            // `(joint, the bone it rolls about)`: an end; one whose child is where it is; an end that is where its parent is; one where
            // the root is, whose parent has a child further on.
            for (joint, (from, to)) in [(9, (7, 9)), (2, (1, 2)), (6, (3, 4)), (5, (0, 1))] {
                let axis = at[joint].matrix3 * pose.roll_axis(joint).expect("a bone");
                let wanted = line(from, to);
                assert!(
                    axis.abs_diff_eq(wanted, ROUNDING),
                    "{joint}: {axis} {wanted}"
                );
            }
        }
        let point = [(None, DVec3::Y), (Some(0), DVec3::ZERO)];
        let point = posed(&point, RotationOrder::Zyx);
        assert_eq!([point.roll_axis(0), point.roll_axis(1)], [None, None]);
    }
}
