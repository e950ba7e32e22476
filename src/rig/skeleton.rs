//! Joints and their degrees of freedom.

use glam::DVec3;

/// Closed range of a DOF, in its unit; infinite ends mean no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    pub min: f64,
    pub max: f64,
}

impl Limit {
    pub const NONE: Self = Self {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
    };

    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    pub fn contains(self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }

    pub fn clamp(self, value: f64) -> f64 {
        value.max(self.min).min(self.max)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    pub fn index(self) -> usize {
        self as usize
    }

    /// The unit vector along it.
    pub fn unit(self) -> DVec3 {
        [DVec3::X, DVec3::Y, DVec3::Z][self.index()]
    }

    pub(super) fn letter(self) -> char {
        ['x', 'y', 'z'][self.index()]
    }
}

/// In which order the three Euler angles of a joint are multiplied, on column vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotationOrder {
    /// `Rz * Ry * Rx`: x turns first. CSE 169 and glTF.
    Zyx,
    /// `Rx * Ry * Rz`: z turns first. MIT 6.837.
    Xyz,
}

/// One joint. Lengths in the rig's units, angles in radians.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Unique in its skeleton.
    pub name: String,
    /// An index before this joint's own.
    pub parent: Option<usize>,
    /// From the parent's origin to this joint's, in the parent's frame.
    pub offset: DVec3,
    pub rotation_order: RotationOrder,
    /// The file's own angles about x, y and z, inside `rotation_limits`.
    pub rest_angles: DVec3,
    /// About x, y and z.
    pub rotation_limits: [Limit; 3],
    /// Whether it has translation DOFs besides the rotations.
    pub translates: bool,
    /// Smallest and largest corner in the joint's own frame, where the file gives a box or has a default for it.
    pub bounding_box: Option<[DVec3; 2]>,
}

impl Joint {
    /// Whether any of the three angles has a limit.
    pub fn is_limited(&self) -> bool {
        self.rotation_limits.iter().any(|limit| !limit.is_none())
    }
}

/// Joints, parents before children; one root, or none in a rig that is only a mesh.
#[derive(Debug)]
pub struct Skeleton {
    joints: Vec<Joint>,
    children: Vec<Vec<usize>>,
}

impl Skeleton {
    /// `joints` come from [`Draft::build`](super::Draft::build), which has checked them.
    pub(super) fn new(joints: Vec<Joint>) -> Self {
        let mut children = vec![Vec::new(); joints.len()];
        for (index, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent {
                children[parent].push(index);
            }
        }
        Self { joints, children }
    }

    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Indices of the joints that hang on `joint`, in file order.
    pub fn children(&self, joint: usize) -> &[usize] {
        &self.children[joint]
    }

    pub fn joint_named(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }
}
