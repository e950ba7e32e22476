//! Lights that a file has. Never lives here: what a picture is lit by, which its request says.

use glam::{DAffine3, Vec3};

/// A light of a file. Its own space is where it shines along −Z, from the origin.
#[derive(Debug, Clone)]
pub struct FileLight {
    /// Unique in its rig.
    pub name: String,
    /// What it moves with; `None` of one that stands still, whose `joint_from_light` leads to the world.
    pub joint: Option<usize>,
    /// From the light's own space to that of the joint, or to the world.
    pub joint_from_light: DAffine3,
    /// In which directions it shines.
    pub kind: FileLightKind,
    /// Linear RGB, each channel 0..1.
    pub color: Vec3,
    /// In candela; of a directional one in lux.
    pub intensity: f64,
}

/// How a light of a file spreads, in its own space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FileLightKind {
    /// Along −Z everywhere, as from infinitely far; where it stands does not count.
    Directional,
    /// From its origin, in all directions.
    Point,
    /// Angles from −Z in radians, `0 <= inner < outer <= π/2`: up to which it shines in full, and up to which at all.
    Spot {
        /// Half the angle of the cone in which it shines in full.
        inner: f64,
        /// Half the angle of the cone outside of which it is dark.
        outer: f64,
    },
}

impl FileLight {
    /// Largest intensity: as bright as a light of a frame request can be.
    pub const MOST_INTENSITY: f64 = 1e12;
}
