//! Poses read, set and limited. Never lives here: turning about axes, and kinematics, which have tests of their own.

use super::*;
use crate::limits::Limits;
use crate::rig::{Draft, JointDraft, Limit, RotationOrder};
use std::f64::consts::PI;

fn joint(parent: Option<usize>, limits: [Limit; 3]) -> JointDraft {
    JointDraft {
        parent,
        offset: DVec3::Y,
        rotation_limits: limits,
        translates: parent.is_none(),
        ..JointDraft::default()
    }
}

/// A free root and a hinge about z that opens to 2 radians.
fn hinge() -> Pose {
    let lock = Limit { min: 0.0, max: 0.0 };
    let open = Limit { min: 0.0, max: 2.0 };
    let joints = vec![
        joint(None, [Limit::NONE; 3]),
        joint(Some(0), [lock, lock, open]),
    ];
    let rig = Draft {
        joints,
        ..Draft::default()
    }
    .build(&Limits::default())
    .expect("a valid draft");
    Pose::rest(&Arc::new(rig))
}

fn turn(joint: usize, quaternion: DQuat) -> PoseEdit {
    PoseEdit {
        rotations: vec![(joint, quaternion)],
        ..PoseEdit::default()
    }
}

#[test]
fn dofs_stand_in_the_promised_order() {
    let pose = hinge();
    let names: Vec<_> = pose
        .rig
        .dofs()
        .all()
        .iter()
        .map(|dof| dof.name.as_str())
        .collect();
    let root = ["tx", "ty", "tz", "rx", "ry", "rz"].map(|suffix| format!("joint_0.{suffix}"));
    let hinge = ["rx", "ry", "rz"].map(|suffix| format!("joint_1.{suffix}"));
    assert_eq!(names, [root.as_slice(), hinge.as_slice()].concat());
}

#[test]
fn a_value_past_its_limit_is_clamped_refused_or_taken() {
    let pose = hinge();
    let dof = pose.rig.dofs().named("joint_1.rz").expect("the hinge");
    let edit = |limits| PoseEdit {
        dofs: vec![(dof, 5.0)],
        limits,
        ..PoseEdit::default()
    };
    let (clamped_pose, clamped) = pose
        .edited(&edit(LimitPolicy::Clamp))
        .expect("clamping accepts");
    assert_eq!(
        clamped,
        [Clamped {
            dof,
            asked: 5.0,
            used: 2.0
        }]
    );
    assert_eq!(clamped_pose.dof_values()[dof], 2.0);
    assert!(pose.edited(&edit(LimitPolicy::Reject)).is_err());
    assert_eq!(
        pose.edited(&edit(LimitPolicy::Ignore))
            .expect("taken")
            .0
            .dof_values()[dof],
        5.0
    );
    assert_eq!(
        pose.dof_values()[dof],
        0.0,
        "an edit leaves the pose it started from alone"
    );
}

#[test]
fn an_unlimited_joint_keeps_its_quaternion_at_the_singularity() {
    let quaternion = RotationOrder::Zyx.quaternion_of(DVec3::new(0.3, PI / 2.0, -1.1));
    let (pose, clamped) = hinge().edited(&turn(0, quaternion)).expect("no limits");
    assert_eq!(pose.local(0).rotation, quaternion);
    assert!(clamped.is_empty());
}

#[test]
fn a_limited_joint_keeps_a_quaternion_that_one_of_its_triples_allows() {
    // The hinge at 2 radians is also (pi, pi, 2 - pi): only the first triple is inside.
    let quaternion = -DQuat::from_rotation_z(2.0);
    let (pose, clamped) = hinge().edited(&turn(1, quaternion)).expect("inside");
    assert!(clamped.is_empty(), "{clamped:?}");
    assert_eq!(pose.local(1).rotation, quaternion);
}

#[test]
fn a_limited_joint_clamps_a_quaternion_that_none_allows() {
    let (pose, clamped) = hinge()
        .edited(&turn(1, DQuat::from_rotation_z(2.5)))
        .expect("clamped");
    let dof = pose.rig.dofs().named("joint_1.rz").expect("the hinge");
    assert_eq!(clamped.len(), 1);
    assert_eq!((clamped[0].dof, clamped[0].used), (dof, 2.0));
    assert!((clamped[0].asked - 2.5).abs() < 1e-12);
    let refused = PoseEdit {
        limits: LimitPolicy::Reject,
        ..turn(1, DQuat::from_rotation_z(2.5))
    };
    assert!(hinge().edited(&refused).is_err());
}

#[test]
fn setting_an_angle_turns_a_quaternion_into_angles() {
    let (pose, _) = hinge()
        .edited(&turn(0, DQuat::from_rotation_x(0.4)))
        .expect("no limits");
    let dof = pose.rig.dofs().named("joint_0.rz").expect("the root");
    let (pose, _) = pose
        .edited(&PoseEdit {
            dofs: vec![(dof, 0.2)],
            ..PoseEdit::default()
        })
        .expect("no limits");
    let values = pose.dof_values();
    assert!(
        (values[dof - 2] - 0.4).abs() < 1e-12 && values[dof] == 0.2,
        "{values:?}"
    );
}

/// One joint of each order, with these limits.
fn limited(order: RotationOrder, rotation_limits: [Limit; 3]) -> Pose {
    let draft = Draft {
        joints: vec![JointDraft {
            rotation_order: order,
            rotation_limits,
            ..JointDraft::default()
        }],
        ..Draft::default()
    };
    Pose::rest(&Arc::new(
        draft.build(&Limits::default()).expect("a valid draft"),
    ))
}

#[test]
fn values_that_were_read_set_the_same_pose_again() {
    const LOCK: Limit = Limit { min: 0.0, max: 0.0 };
    const fn range(min: f64, max: f64) -> Limit {
        Limit { min, max }
    }
    let patterns = [
        [Limit::NONE; 3],
        [range(-1.0, 1.0), Limit::NONE, Limit::NONE],
        [Limit::NONE, range(-0.5, 0.5), Limit::NONE],
        [Limit::NONE, range(1.0, 4.0), Limit::NONE],
        [range(-0.4, 0.4), range(-2.0, 2.0), range(-3.0, 0.0)],
        [range(3.0, 5.0), Limit::NONE, range(-7.0, -4.0)],
        [range(11.0, 14.0), range(2.0, 2.5), range(-20.0, -15.0)],
        [LOCK, LOCK, range(0.0, 2.0)],
        [range(0.0, f64::INFINITY), Limit::NONE, LOCK],
    ];
    // Evenly spread: the additive recurrence of the plastic number's kin.
    let mut at = glam::DVec4::splat(0.5);
    let mut random = || {
        at = (at
            + glam::DVec4::new(
                0.8566748838545029,
                0.733891856627126,
                0.628706721008,
                0.538597,
            ))
        .fract();
        (at - glam::DVec4::splat(0.5)).normalize()
    };
    for order in [RotationOrder::Zyx, RotationOrder::Xyz] {
        for limits in patterns {
            let rest = limited(order, limits);
            let dofs: Vec<Dof> = rest.rig.dofs().all().to_vec();
            for round in 0..10_000 {
                let asked = DQuat::from_vec4(random());
                let (pose, _) = rest.edited(&turn(0, asked)).expect("clamped");
                let alone = round % 3;
                let middle = limits[alone].clamp(0.3);
                let one_set = PoseEdit {
                    dofs: vec![(alone, middle)],
                    ..PoseEdit::default()
                };
                let (one_set, _) = pose.edited(&one_set).expect("clamped");
                for pose in [pose, one_set] {
                    let values = pose.dof_values();
                    for (dof, &value) in dofs.iter().zip(&values) {
                        assert!(dof.limit.contains(value), "{limits:?} {asked}: {values:?}");
                    }
                    let again = PoseEdit {
                        dofs: values.iter().copied().enumerate().collect(),
                        limits: LimitPolicy::Reject,
                        ..PoseEdit::default()
                    };
                    let (again, _) = rest.edited(&again).expect("inside its limits");
                    let off = again
                        .local(0)
                        .rotation
                        .angle_between(pose.local(0).rotation);
                    // Radians: by as much may a quaternion miss a limit, on each axis.
                    assert!(off < 4e-6, "{limits:?} {asked}: {values:?} {off}");
                    assert_eq!(again.dof_values(), values);
                }
            }
        }
    }
}
