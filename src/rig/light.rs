//! Lights that a file has. Never lives here: what a picture is lit by, which its request says.

use glam::{DAffine3, Vec3};

/// A light of a file. Its own space is where it shines along −Z, from the origin.
#[derive(Debug, Clone)]
pub struct FileLight {
    /// Unique in its rig.
    pub name: String,
    /// What it moves with; `None` of one that stands still, whose `joint_from_light` leads to the world.
    pub joint: Option<usize>,
    pub joint_from_light: DAffine3,
    pub kind: FileLightKind,
    /// Linear RGB, each channel 0..1.
    pub color: Vec3,
    /// In candela; of a directional one in lux.
    pub intensity: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FileLightKind {
    Directional,
    Point,
    /// Angles from −Z in radians, `0 <= inner < outer <= π/2`: up to which it shines in full, and up to which at all.
    Spot {
        inner: f64,
        outer: f64,
    },
}

impl FileLight {
    /// Largest intensity: as bright as a light of a frame request can be.
    pub const MOST_INTENSITY: f64 = 1e12;
}
