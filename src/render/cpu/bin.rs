//! Sorting triangles by the tiles of the picture that they reach, so that each tile is drawn from first to last while its samples are
//! at hand. Here goes what is not seen at all: the far sides of closed skin, and triangles that fall between the samples.
//! Never lives here: which samples a triangle covers.

use super::clip::{ClippedTriangle, Unplaced, clip};
use super::geometry::{Entry, Geometry, Paint, Place, Surface};
use super::project::{Projected, Projection, STEPS};
use super::samples::Pattern;
use crate::render::cull::Side;
use crate::scene::Size;

/// Pixels of a tile: its samples fit into the second level of a core's cache, with room for the triangles.
pub(super) const TILE: [u32; 2] = [64, 32];

/// The tiles of a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub size: Size,
    pub columns: u32,
    pub rows: u32,
}

impl Grid {
    pub fn of(size: Size) -> Self {
        Self {
            size,
            columns: size.width.div_ceil(TILE[0]),
            rows: size.height.div_ceil(TILE[1]),
        }
    }

    pub fn tile_count(&self) -> usize {
        self.columns as usize * self.rows as usize
    }
}

/// Triangles one after another, as one thread sorted them. Kept from picture to picture.
#[derive(Default)]
pub(super) struct Chunk {
    /// One per tile, row by row, and perhaps more; in the order in which they are drawn.
    pub bins: Vec<Vec<Entry>>,
    pub clipped: Vec<ClippedTriangle>,
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
    pub fn within(self, [left, top]: [u32; 2], [right, bottom]: [u32; 2]) -> Self {
        Self {
            min: [self.min[0].max(left), self.min[1].max(top)],
            max: [self.max[0].min(right), self.max[1].min(bottom)],
        }
    }
}

impl Chunk {
    /// Sorts the triangles of `geometry` whose numbers are in `range`.
    pub fn fill(
        &mut self,
        geometry: &Geometry<'_>,
        range: std::ops::Range<u32>,
        projection: &Projection,
        grid: &Grid,
        pattern: Pattern,
    ) {
        if self.bins.len() < grid.tile_count() {
            self.bins.resize_with(grid.tile_count(), Vec::new);
        }
        let bins = self.bins.iter_mut().take(grid.tile_count());
        bins.for_each(Vec::clear);
        self.clipped.clear();
        for surface in geometry.surfaces {
            let (start, end) = (
                surface.first_triangle.max(range.start),
                surface.end().min(range.end),
            );
            for triangle in start..end {
                let place = Place {
                    surface,
                    triangle: (triangle - surface.first_triangle) as usize,
                };
                let corners = geometry.projected_of(place);
                let [a, b, c] = corners;
                if !(a.is_beyond() || b.is_beyond() || c.is_beyond()) {
                    self.add(Entry::whole(triangle), surface, corners, grid, pattern);
                    continue;
                }
                let first_piece = self.clipped.len();
                let whole = geometry.whole_corners(place);
                let vertices = place.vertices();
                let unplaced = [0, 1, 2].map(|corner| Unplaced {
                    clip: match surface.paint {
                        Paint::Lines(_) => {
                            geometry.line_corners[vertices[corner] - geometry.positions.len()]
                        }
                        _ => projection.clip_of(whole[corner].position),
                    },
                    corner: whole[corner],
                });
                clip(triangle, unplaced, projection, &mut self.clipped);
                for piece in first_piece..self.clipped.len() {
                    let corners = self.clipped[piece].corners.map(|corner| corner.projected);
                    self.add(Entry::clipped(piece), surface, corners, grid, pattern);
                }
            }
        }
    }

    fn add(
        &mut self,
        entry: Entry,
        surface: &Surface<'_>,
        corners: [Projected; 3],
        grid: &Grid,
        pattern: Pattern,
    ) {
        let is_seen = side(corners).is_some_and(|side| Some(side) != surface.culled);
        let Some(reached) = is_seen
            .then(|| pixels(corners, grid.size, pattern))
            .flatten()
        else {
            return;
        };
        let tile = |pixel: [u32; 2]| [pixel[0] / TILE[0], pixel[1] / TILE[1]];
        let ([left, top], [right, bottom]) = (tile(reached.min), tile(reached.max));
        for row in top..=bottom {
            for column in left..=right {
                self.bins[(row * grid.columns + column) as usize].push(entry);
            }
        }
    }
}

/// Which side of a triangle is seen; `None` of one that is a line.
#[inline(always)]
pub(super) fn side(corners: [Projected; 3]) -> Option<Side> {
    match doubled_area(corners) {
        0 => None,
        // The picture's rows run downward.
        area if area < 0 => Some(Side::Front),
        _ => Some(Side::Back),
    }
}

/// In squared steps; positive where the corners run clockwise on the picture.
#[inline(always)]
pub(super) fn doubled_area([a, b, c]: [Projected; 3]) -> i64 {
    let (bx, by) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
    let (cx, cy) = (i64::from(c.x - a.x), i64::from(c.y - a.y));
    bx * cy - cx * by
}

/// Whose samples may lie in a triangle; `None` where there is no such sample.
#[inline(always)]
pub(super) fn pixels(corners: [Projected; 3], size: Size, pattern: Pattern) -> Option<Rectangle> {
    let [a, b, c] = corners;
    let span = |[a, b, c]: [i32; 3], side: u32| {
        let first = pattern.first_at(a.min(b).min(c)).max(0);
        let last = pattern.last_at(a.max(b).max(c));
        // Both lie at samples, so that rounding down finds their pixels.
        let (first, last) = (
            first / STEPS,
            last.min(side as i32 * STEPS - 1) >> STEPS.ilog2(),
        );
        (first <= last).then_some([first as u32, last as u32])
    };
    let ([left, right], [top, bottom]) = (
        span([a.x, b.x, c.x], size.width)?,
        span([a.y, b.y, c.y], size.height)?,
    );
    Some(Rectangle {
        min: [left, top],
        max: [right, bottom],
    })
}
