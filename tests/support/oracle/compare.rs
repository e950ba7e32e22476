//! How far found vertices are from wanted ones, how much that may be, and numbers that are random but the same everywhere. Never lives here: how
//! either side came by its vertices.

use super::Skinned;
use super::matrix::{Vector, angle, difference, length};

/// The worst of all vertices, not a number counting as infinite.
#[derive(Debug, Clone, Copy, Default)]
pub struct Worst {
    /// Distance between positions, as a share of the rig's size or its largest coordinate, whichever is more.
    pub position: f64,
    /// Radians between normals.
    pub normal: f64,
    /// By how much a normal is not of unit length.
    pub length: f64,
    /// Positions and normals that were not looked at.
    pub skipped: usize,
}

impl Worst {
    /// Eighty steps of float32 at the rig's size: a sum of a few dozen products loses less.
    pub const POSITION: f64 = 1e-5;
    /// A quarter of what one step of an 8-bit color can show.
    pub const NORMAL: f64 = 1e-3;
    /// Eighty steps of float32 as well: a dot product and an inverse square root lose less.
    pub const LENGTH: f64 = 1e-5;

    pub fn is_close(&self) -> bool {
        self.position <= Self::POSITION
            && self.normal <= Self::NORMAL
            && self.length <= Self::LENGTH
    }

    pub fn and(self, other: Self) -> Self {
        Self {
            position: worse(self.position, other.position),
            normal: worse(self.normal, other.normal),
            length: worse(self.length, other.length),
            skipped: self.skipped + other.skipped,
        }
    }
}

fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// Vertices by their place in the file, position and normal.
pub type Found = Vec<[[f32; 3]; 2]>;

/// The corners of the smallest box.
pub fn bounds(positions: impl Iterator<Item = Vector>) -> [Vector; 2] {
    let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    positions.fold(none, |[min, max], p| {
        [
            [0, 1, 2].map(|i| p[i].min(min[i])),
            [0, 1, 2].map(|i| p[i].max(max[i])),
        ]
    })
}

pub fn compare(found: &[[[f32; 3]; 2]], wanted: &Skinned) -> Worst {
    assert_eq!(found.len(), wanted.positions.len(), "number of vertices");
    let [min, max] = bounds(wanted.positions.iter().flatten().copied());
    let largest = min.iter().chain(&max).fold(0.0f64, |a, x| a.max(x.abs()));
    let size = length(difference(max, min)).max(largest);
    let mut worst = Worst::default();
    for (index, &vertex) in found.iter().enumerate() {
        let [position, normal] = vertex.map(|v| v.map(f64::from));
        worst.length = worse(worst.length, (length(normal) - 1.0).abs());
        match wanted.positions[index] {
            Some(wanted) => {
                let off = length(difference(position, wanted)) / size;
                worst.position = worse(worst.position, off);
            }
            None => worst.skipped += 1,
        }
        match wanted.normals[index] {
            Some(wanted) => worst.normal = worse(worst.normal, angle(normal, wanted)),
            None => worst.skipped += 1,
        }
    }
    worst
}
