//! How a joint is turned: three angles in an order, or a quaternion. Never lives here: limits.

use glam::{DQuat, DVec3, EulerRot};

/// In which order the three Euler angles of a joint are multiplied, on column vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RotationOrder {
    /// `Rz * Ry * Rx`: x turns first. CSE 169 and glTF.
    #[default]
    Zyx,
    /// `Rx * Ry * Rz`: z turns first. MIT 6.837.
    Xyz,
}

impl RotationOrder {
    /// `angles` are about x, y, z, in radians.
    pub fn quaternion_of(self, angles: DVec3) -> DQuat {
        match self {
            Self::Zyx => DQuat::from_euler(EulerRot::ZYX, angles.z, angles.y, angles.x),
            Self::Xyz => DQuat::from_euler(EulerRot::XYZ, angles.x, angles.y, angles.z),
        }
    }

    /// The triple whose middle angle lies within ±π/2.
    pub fn angles_of(self, quaternion: DQuat) -> DVec3 {
        match self {
            Self::Zyx => {
                let (z, y, x) = quaternion.to_euler(EulerRot::ZYX);
                DVec3::new(x, y, z)
            }
            Self::Xyz => quaternion.to_euler(EulerRot::XYZ).into(),
        }
    }
}

/// A local rotation in the form it was given in. A quaternion stays one until an angle of its joint is set, so that it is never
/// squeezed through angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rotation {
    /// Radians about x, y, z, multiplied in the joint's own order.
    Angles(DVec3),
    /// Unit length.
    Quaternion(DQuat),
}

impl Rotation {
    /// No turn: all three angles are 0.
    pub const NONE: Self = Self::Angles(DVec3::ZERO);

    /// Radians about x, y, z, multiplied in `order`. Of a quaternion, the triple that [`RotationOrder::angles_of`] gives.
    pub fn angles(self, order: RotationOrder) -> DVec3 {
        match self {
            Self::Angles(angles) => angles,
            Self::Quaternion(quaternion) => order.angles_of(quaternion),
        }
    }

    /// As a unit quaternion; `order` is that in which the angles, if it has them, are multiplied.
    pub fn quaternion(self, order: RotationOrder) -> DQuat {
        match self {
            Self::Angles(angles) => order.quaternion_of(angles),
            Self::Quaternion(quaternion) => quaternion,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_multiply_in_the_order_named() {
        let angles = DVec3::new(0.3, -0.8, 1.9);
        let [x, y, z] = [
            DQuat::from_rotation_x(0.3),
            DQuat::from_rotation_y(-0.8),
            DQuat::from_rotation_z(1.9),
        ];
        let (zyx, xyz) = (RotationOrder::Zyx, RotationOrder::Xyz);
        assert!(zyx.quaternion_of(angles).angle_between(z * y * x) < 1e-7);
        assert!(xyz.quaternion_of(angles).angle_between(x * y * z) < 1e-7);
        assert!(zyx.quaternion_of(angles).angle_between(x * y * z) > 0.1);
    }

    #[test]
    fn angles_come_back() {
        for order in [RotationOrder::Zyx, RotationOrder::Xyz] {
            let angles = DVec3::new(2.3, -1.2, -3.0);
            let back = order.angles_of(order.quaternion_of(angles));
            assert!(back.distance(angles) < 1e-12);
        }
    }
}
