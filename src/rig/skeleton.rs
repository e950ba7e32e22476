//! Joints and their degrees of freedom.

use super::{Rotation, RotationOrder};
use glam::DVec3;

/// Closed range of a DOF, in its unit; infinite ends mean no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The smallest value allowed; negative infinity where there is none.
    pub min: f64,
    /// The largest value allowed; infinity where there is none.
    pub max: f64,
}

impl Limit {
    /// No limit: both ends are infinite.
    pub const NONE: Self = Self {
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
    };

    /// Whether both ends are infinite.
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }

    /// Whether a value is within both ends, or at one of them.
    pub fn contains(self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }

    /// The value itself where it is allowed, else the nearer end.
    pub fn clamp(self, value: f64) -> f64 {
        value.max(self.min).min(self.max)
    }
}

/// One of the three axes of a right-handed frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// The first component of a vector.
    X,
    /// The second component of a vector.
    Y,
    /// The third component of a vector.
    Z,
}

impl Axis {
    /// In the order of their indices.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0 for x, 1 for y, 2 for z.
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

/// One joint. Lengths in the rig's units, angles in radians.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Unique in its skeleton.
    pub name: String,
    /// An index before this joint's own.
    pub parent: Option<usize>,
    /// From the parent's origin to this joint's, in the parent's frame.
    pub offset: DVec3,
    /// In which order its three angles are multiplied.
    pub rotation_order: RotationOrder,
    /// The file's own, inside `rotation_limits`.
    pub rest_rotation: Rotation,
    /// The file's own, along the joint's own axes.
    pub rest_scale: DVec3,
    /// About x, y and z.
    pub rotation_limits: [Limit; 3],
    /// Whether it has translation DOFs besides the rotations.
    pub translates: bool,
    /// Whether it has scale DOFs besides them.
    pub scales: bool,
    /// Smallest and largest corner in the joint's own frame, where the file gives a box or has a default for it.
    pub bounding_box: Option<[DVec3; 2]>,
}

impl Joint {
    /// Whether any of the three angles has a limit.
    pub fn is_limited(&self) -> bool {
        self.rotation_limits.iter().any(|limit| !limit.is_none())
    }
}

/// Joints, parents before children; one root or several, or none in a rig that is only a mesh.
#[derive(Debug)]
pub struct Skeleton {
    joints: Vec<Joint>,
    children: Vec<Vec<usize>>,
    bone_radius: Option<f64>,
}

/// Radius of bones to the median of their lengths: a figure as tall as a person has a median of about 0.15, since spine, hands and
/// feet are short, and its bones are about 0.03 thick.
const BONE_RADIUS_SHARE: f64 = 0.1;

impl Skeleton {
    /// `joints` come from [`Draft::build`](super::Draft::build), which has checked them.
    pub(super) fn new(joints: Vec<Joint>) -> Self {
        let mut children = vec![Vec::new(); joints.len()];
        for (index, joint) in joints.iter().enumerate() {
            if let Some(parent) = joint.parent {
                children[parent].push(index);
            }
        }
        Self {
            bone_radius: median_bone_length(&joints).map(|length| length * BONE_RADIUS_SHARE),
            joints,
            children,
        }
    }

    /// In file order, parents before their children.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Indices of the joints that hang on `joint`, in file order.
    pub fn children(&self, joint: usize) -> &[usize] {
        &self.children[joint]
    }

    /// The index of the joint of exactly this name.
    pub fn joint_named(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// How thick bones are drawn and picked: a radius in the rig's units, positive, the same in every pose. Bones that are short for it
    /// are drawn and picked thinner. `None` where no joint stands away from its parent, so that there is no bone to measure.
    pub fn bone_radius(&self) -> Option<f64> {
        self.bone_radius
    }
}

/// At rest, of joints that stand away from their parents; of an even number the longer of the middle two.
fn median_bone_length(joints: &[Joint]) -> Option<f64> {
    let mut lengths: Vec<f64> = joints
        .iter()
        .filter(|joint| joint.parent.is_some())
        .map(|joint| joint.offset.length())
        .filter(|&length| length > 0.0)
        .collect();
    let middle = lengths.len() / 2;
    (!lengths.is_empty()).then(|| *lengths.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain whose root stands far from the origin, its joints at these distances from one another.
    fn chain(distances: &[f64]) -> Skeleton {
        let offsets = std::iter::once(1000.0).chain(distances.iter().copied());
        let joint = |(index, offset): (usize, f64)| Joint {
            name: format!("joint_{index}"),
            parent: index.checked_sub(1),
            offset: DVec3::NEG_Y * offset,
            rotation_order: RotationOrder::Zyx,
            rest_rotation: Rotation::NONE,
            rest_scale: DVec3::ONE,
            rotation_limits: [Limit::NONE; 3],
            translates: false,
            scales: false,
            bounding_box: None,
        };
        Skeleton::new(offsets.enumerate().map(joint).collect())
    }

    #[test]
    fn bones_are_a_tenth_of_their_median_in_radius() {
        for (distances, wanted) in [
            (&[0.4, 0.1, 0.3][..], Some(0.03)),
            (&[0.0, 0.4, 0.0, 0.0, 0.1, 0.3], Some(0.03)),
            (&[2.0, 5.0], Some(0.5)),
            (&[0.0, 0.0], None),
            (&[], None),
        ] {
            let radius = chain(distances).bone_radius();
            let is_near = |(found, wanted): (f64, f64)| (found - wanted).abs() < 1e-12;
            assert_eq!(radius.is_some(), wanted.is_some(), "{distances:?}");
            assert!(
                radius.zip(wanted).is_none_or(is_near),
                "{distances:?}: {radius:?}"
            );
        }
    }
}
