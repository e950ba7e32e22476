//! Degrees of freedom: the numbers that a pose sets, and their order on the wire.

use super::{Axis, Joint, Limit, Skeleton};
use std::collections::HashMap;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DofKind {
    /// Displacement from rest along an axis of the parent, in the rig's units.
    Translation(Axis),
    /// Absolute local Euler angle about an axis, in radians.
    Rotation(Axis),
}

/// One number that a pose sets.
#[derive(Debug, Clone)]
pub struct Dof {
    /// `<joint>.<tx|ty|tz|rx|ry|rz>`, unique in its rig.
    pub name: String,
    pub joint: usize,
    pub kind: DofKind,
    pub limit: Limit,
    /// The file's own value, inside `limit`.
    pub rest: f64,
}

impl Dof {
    fn of(joint: &Joint, index: usize, kind: DofKind) -> Self {
        let (letter, axis, limit, rest) = match kind {
            DofKind::Translation(axis) => ('t', axis, Limit::NONE, 0.0),
            DofKind::Rotation(axis) => (
                'r',
                axis,
                joint.rotation_limits[axis.index()],
                joint.rest_angles[axis.index()],
            ),
        };
        Self {
            name: format!("{}.{letter}{}", joint.name, axis.letter()),
            joint: index,
            kind,
            limit,
            rest,
        }
    }
}

/// Every DOF of a rig: joints in file order, each `tx ty tz rx ry rz` as far as it has them.
#[derive(Debug)]
pub struct Dofs {
    all: Vec<Dof>,
    by_name: HashMap<String, usize>,
    /// Of each joint, where its three rotations start.
    first_rotation: Vec<usize>,
}

impl Dofs {
    pub(super) fn of(skeleton: &Skeleton) -> Self {
        let mut all = Vec::new();
        let mut first_rotation = Vec::with_capacity(skeleton.joints().len());
        for (index, joint) in skeleton.joints().iter().enumerate() {
            if joint.translates {
                all.extend(Axis::ALL.map(|axis| Dof::of(joint, index, DofKind::Translation(axis))));
            }
            first_rotation.push(all.len());
            all.extend(Axis::ALL.map(|axis| Dof::of(joint, index, DofKind::Rotation(axis))));
        }
        let by_name = all
            .iter()
            .enumerate()
            .map(|(index, dof)| (dof.name.clone(), index))
            .collect();
        Self {
            all,
            by_name,
            first_rotation,
        }
    }

    pub fn all(&self) -> &[Dof] {
        &self.all
    }

    /// The index in [`Dofs::all`] of the DOF of this name.
    pub fn named(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The index in [`Dofs::all`] of a joint's rotation about an axis.
    pub fn rotation(&self, joint: usize, axis: Axis) -> usize {
        self.first_rotation[joint] + axis.index()
    }
}
