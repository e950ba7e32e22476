//! Degrees of freedom: the numbers that a pose sets, and their order on the wire.

use super::{Axis, Limit, Morph, Skeleton};
use std::collections::HashMap;

/// What a DOF moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DofKind {
    /// Displacement from rest along an axis of the parent, in the rig's units.
    Translation {
        /// Index into [`Skeleton::joints`].
        joint: usize,
        /// Of the parent.
        axis: Axis,
    },
    /// Absolute local Euler angle about an axis, in radians.
    Rotation {
        /// Index into [`Skeleton::joints`].
        joint: usize,
        /// About which the angle turns, in its place in the joint's rotation order.
        axis: Axis,
    },
    /// Absolute local scale along an axis of the joint's own.
    Scale {
        /// Index into [`Skeleton::joints`].
        joint: usize,
        /// Of the joint's own.
        axis: Axis,
    },
    /// Weight of a morph target: 0 leaves the mesh as modelled, 1 is the target itself.
    Morph {
        /// Index into [`Rig::morphs`](super::Rig::morphs).
        morph: usize,
    },
}

impl DofKind {
    /// The joint that it moves, if it moves one.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Translation { joint, .. }
            | Self::Rotation { joint, .. }
            | Self::Scale { joint, .. } => Some(joint),
            Self::Morph { .. } => None,
        }
    }
}

/// One number that a pose sets.
#[derive(Debug, Clone)]
pub struct Dof {
    /// `<joint>.<tx|ty|tz|rx|ry|rz|sx|sy|sz>` or `morph.<target>`, unique in its rig.
    pub name: String,
    /// What it moves, and along or about which axis.
    pub kind: DofKind,
    /// Which values an edit may give it, in its unit; only rotations have any.
    pub limit: Limit,
    /// The file's own value, inside `limit`.
    pub rest: f64,
}

/// What the names of the DOFs of morph targets start with.
pub const MORPH_PREFIX: &str = "morph.";

/// Every DOF of a rig: joints in file order, each `tx ty tz rx ry rz sx sy sz` as far as it has them, then morph targets in load order.
#[derive(Debug)]
pub struct Dofs {
    all: Vec<Dof>,
    by_name: HashMap<String, usize>,
    by_kind: HashMap<DofKind, usize>,
}

impl Dofs {
    pub(super) fn of(skeleton: &Skeleton, morphs: &[Morph]) -> Self {
        let mut dofs = Self {
            all: Vec::new(),
            by_name: HashMap::new(),
            by_kind: HashMap::new(),
        };
        for (index, joint) in skeleton.joints().iter().enumerate() {
            let name =
                |letter: char, axis: Axis| format!("{}.{letter}{}", joint.name, axis.letter());
            if joint.translates {
                for axis in Axis::ALL {
                    let kind = DofKind::Translation { joint: index, axis };
                    dofs.push(name('t', axis), kind, Limit::NONE, 0.0);
                }
            }
            let rest_angles = joint.rest_rotation.angles(joint.rotation_order);
            for axis in Axis::ALL {
                let kind = DofKind::Rotation { joint: index, axis };
                let limit = joint.rotation_limits[axis.index()];
                dofs.push(name('r', axis), kind, limit, rest_angles[axis.index()]);
            }
            if joint.scales {
                for axis in Axis::ALL {
                    let kind = DofKind::Scale { joint: index, axis };
                    let rest = joint.rest_scale[axis.index()];
                    dofs.push(name('s', axis), kind, Limit::NONE, rest);
                }
            }
        }
        for (index, morph) in morphs.iter().enumerate() {
            let kind = DofKind::Morph { morph: index };
            dofs.push(
                format!("{MORPH_PREFIX}{}", morph.name),
                kind,
                Limit::NONE,
                morph.rest,
            );
        }
        dofs
    }

    fn push(&mut self, name: String, kind: DofKind, limit: Limit, rest: f64) {
        // Only a morph target called `rx` beside a joint called `morph` comes to this.
        let repeats = (2..).map(|k| format!("{name}#{k}"));
        let free = |candidate: &String| !self.by_name.contains_key(candidate);
        let name = std::iter::once(name.clone())
            .chain(repeats)
            .find(free)
            .unwrap_or(name);
        self.by_name.insert(name.clone(), self.all.len());
        self.by_kind.insert(kind, self.all.len());
        self.all.push(Dof {
            name,
            kind,
            limit,
            rest,
        });
    }

    /// In the order on the wire, which their indices count by.
    pub fn all(&self) -> &[Dof] {
        &self.all
    }

    /// The index in [`Dofs::all`] of the DOF of this name.
    pub fn named(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// The index in [`Dofs::all`] of the DOF that moves this.
    pub fn of_kind(&self, kind: DofKind) -> Option<usize> {
        self.by_kind.get(&kind).copied()
    }
}
