//! Pixels of a picture, tile by tile. Never lives here: what is drawn there.

use crate::scene::Size;

/// Pixels of a tile: its samples fit into the second level of a core's cache, and leave space for the triangles.
pub(super) const TILE: [u32; 2] = [64, 32];

/// The tiles of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub size: Size,
    pub columns: u32,
    pub rows: u32,
}

impl Grid {
    pub(super) fn of(size: Size) -> Self {
        Self {
            size,
            columns: size.width.div_ceil(TILE[0]),
            rows: size.height.div_ceil(TILE[1]),
        }
    }

    pub(super) fn tile_count(&self) -> usize {
        self.columns as usize * self.rows as usize
    }
}

/// From the first pixel to the last one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub min: [u32; 2],
    pub max: [u32; 2],
}

impl Rectangle {
    /// As far as it lies between two pixels; it reaches there.
    #[inline(always)]
    pub(super) fn within(self, [left, top]: [u32; 2], [right, bottom]: [u32; 2]) -> Self {
        Self {
            min: [self.min[0].max(left), self.min[1].max(top)],
            max: [self.max[0].min(right), self.max[1].min(bottom)],
        }
    }

    pub(super) fn is_empty(self) -> bool {
        self.min[0] > self.max[0] || self.min[1] > self.max[1]
    }

    /// The smallest that both lie in.
    pub(super) fn and(self, other: Self) -> Self {
        let both =
            |a: [u32; 2], b: [u32; 2], of: fn(u32, u32) -> u32| [of(a[0], b[0]), of(a[1], b[1])];
        Self {
            min: both(self.min, other.min, u32::min),
            max: both(self.max, other.max, u32::max),
        }
    }
}
