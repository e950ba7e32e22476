//! Stage 2, raster: which samples lie in a triangle, and which of them it is the nearest at (Pineda, "A parallel algorithm for polygon
//! rasterization", 1988). All of it is whole numbers but depth. Never lives here: color.
//!
//! A corner is a point in steps of 1/256 pixel. The edge from a to b has the function
//! `E(p) = (b.x − a.x)(p.y − a.y) − (b.y − a.y)(p.x − a.x)`, positive on the right of it as it runs on the picture, whose rows run
//! downward: where the corners run clockwise a sample is inside if all three edges are positive there. A sample on an edge belongs to the
//! triangle whose top or left edge that is, so that of two triangles at an edge exactly one has it.
//!
//! Samples lie on a grid of eighths of a pixel, 32 steps apart. In eighths (i, j) the function is `32·(dx·j − dy·i) + C`, which is at
//! least 0 just where `dx·j − dy·i + ⌊C / 32⌋` is. At a block of 8 x 8 pixels this is evaluated at the block's corner in 64 bits; then
//! either the whole block lies on one side, or the function is so small in all of it that 32 bits hold it, eight samples at a time.

use super::bin::{Rectangle, doubled_area};
use super::geometry::Layer;
use super::lanes::LANES;
use super::project::{Projected, STEPS};
use super::samples::{BLOCK, BLOCK_COLUMNS, EIGHTHS, Pattern, STEPS_IN_EIGHTH, TileSamples};
use fearless_simd::prelude::*;
use fearless_simd::{f32x8, i32x8, u32x8};

/// Where eight samples that lie side by side in a block are, from the upper left corner of the first one's pixel.
#[derive(Clone, Copy)]
pub(super) struct Footprint<S: Simd> {
    /// In eighths of a pixel.
    x: i32x8<S>,
    y: i32x8<S>,
    /// In pixels.
    pixel_x: f32x8<S>,
    pixel_y: f32x8<S>,
    /// How many pixels they are the samples of.
    pixels: u32,
}

impl<S: Simd> Footprint<S> {
    #[inline(always)]
    pub fn of(simd: S, pattern: Pattern) -> Self {
        let positions = pattern.positions();
        let mut eighths = [[0; LANES]; 2];
        for lane in 0..LANES {
            let [x, y] = positions[lane % positions.len()];
            eighths[0][lane] = x + EIGHTHS * (lane / positions.len()) as i32;
            eighths[1][lane] = y;
        }
        let x = i32x8::load_array(simd, eighths[0]);
        let y = i32x8::load_array(simd, eighths[1]);
        Self {
            x,
            y,
            pixel_x: x.to_float::<f32x8<S>>() * (1.0 / EIGHTHS as f32),
            pixel_y: y.to_float::<f32x8<S>>() * (1.0 / EIGHTHS as f32),
            pixels: (LANES / positions.len()) as u32,
        }
    }
}

/// One edge of a triangle whose corners run clockwise.
#[derive(Clone, Copy)]
struct Edge {
    /// Across the edge's ends, in steps.
    dx: i32,
    dy: i32,
    /// ⌊C / 32⌋, less what keeps out samples on an edge that is neither top nor left.
    at_origin: i64,
}

impl Edge {
    #[inline(always)]
    fn new(a: Projected, b: Projected) -> Self {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let is_top_or_left = dy < 0 || (dy == 0 && dx > 0);
        let constant = i64::from(dy) * i64::from(a.x) - i64::from(dx) * i64::from(a.y);
        let steps = i64::from(STEPS_IN_EIGHTH);
        Self {
            dx,
            dy,
            at_origin: (constant - i64::from(!is_top_or_left)) >> steps.ilog2(),
        }
    }

    /// At a point in eighths of a pixel.
    #[inline(always)]
    fn at(&self, [x, y]: [u32; 2]) -> i64 {
        i64::from(self.dx) * i64::from(y) - i64::from(self.dy) * i64::from(x) + self.at_origin
    }
}

/// What an edge says of a block.
enum Across {
    Outside,
    Inside,
    /// Its function at the upper left corner.
    Through(i32),
}

impl Edge {
    #[inline(always)]
    fn across(&self, corner: [u32; 2]) -> Across {
        /// The furthest that a sample lies from the corner, in eighths.
        const REACH: i64 = (BLOCK as i32 * EIGHTHS - 1) as i64;
        let at_corner = self.at(corner);
        let (dx, dy) = (i64::from(self.dx), i64::from(self.dy));
        if at_corner + REACH * (dx.max(0) + (-dy).max(0)) < 0 {
            Across::Outside
        } else if at_corner + REACH * (dx.min(0) + (-dy).min(0)) >= 0 {
            Across::Inside
        } else {
            // Of either sign within the block, so no larger than `REACH · (|dx| + |dy|)`, which the guard band keeps below 2^30.
            Across::Through(at_corner as i32)
        }
    }
}

/// A quantity that is linear over the picture: its value at a point, and how it changes from pixel to pixel.
#[derive(Clone, Copy)]
pub(super) struct Slope {
    pub origin: [f32; 2],
    pub by_x: [f32; 2],
    pub by_y: [f32; 2],
}

impl Slope {
    /// Over a triangle that is no line: a quantity with the values `a`, `b`, `c` at the corners changes by
    /// `(b − a) · by_x[0] + (c − a) · by_x[1]` to the right, and likewise downward.
    #[inline(always)]
    pub fn of(corners: [Projected; 3]) -> Self {
        let step = 1.0 / STEPS as f32;
        // Of whole numbers, so that no sliver's comes to nothing.
        let rounded_area = doubled_area(corners) as f32 * (step * step);
        let unrounded = [corners[0].pixel, corners[1].pixel, corners[2].pixel];
        let area = Sides::of(unrounded).doubled_area();
        // The rounded corners say what is covered, the unrounded ones what is there: over a triangle of less than a pixel rounding would
        // bend everything. A sliver that rounding makes another one of is taken as rounded.
        if (0.5..2.0).contains(&(area / rounded_area)) {
            Self::between(unrounded, area)
        } else {
            let [a, b, c] = corners;
            let rounded = [[a.x, a.y], [b.x, b.y], [c.x, c.y]];
            Self::between(
                rounded.map(|at| at.map(|steps| steps as f32 * step)),
                rounded_area,
            )
        }
    }

    #[inline(always)]
    fn between(corners: [[f32; 2]; 3], doubled_area: f32) -> Self {
        let Sides { ab, ac } = Sides::of(corners);
        let share = 1.0 / doubled_area;
        Self {
            origin: corners[0],
            by_x: [ac[1] * share, -ab[1] * share],
            by_y: [-ac[0] * share, ab[0] * share],
        }
    }
}

/// From the first corner of a triangle to the others, in pixels.
struct Sides {
    ab: [f32; 2],
    ac: [f32; 2],
}

impl Sides {
    #[inline(always)]
    fn of([a, b, c]: [[f32; 2]; 3]) -> Self {
        Self {
            ab: [b[0] - a[0], b[1] - a[1]],
            ac: [c[0] - a[0], c[1] - a[1]],
        }
    }

    #[inline(always)]
    fn doubled_area(&self) -> f32 {
        self.ab[0] * self.ac[1] - self.ac[0] * self.ab[1]
    }
}

/// Draws a triangle into the samples of a tile where it is nearer than what is there. `reached` lies within the tile, whose upper left
/// pixel is `corner`.
#[inline(always)]
pub(super) fn draw<S: Simd>(
    footprint: &Footprint<S>,
    tile: &mut TileSamples,
    corner: [u32; 2],
    layer: Layer,
    number: u32,
    corners: [Projected; 3],
    reached: Rectangle,
) {
    let [a, b, c] = corners;
    let [a, b, c] = if doubled_area(corners) > 0 {
        [a, b, c]
    } else {
        [a, c, b]
    };
    let edges = [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)];
    let slope = Slope::of([a, b, c]);
    let (db, dc) = (b.depth - a.depth, c.depth - a.depth);
    let depth = Depth {
        origin: slope.origin,
        at_origin: a.depth,
        by_x: db * slope.by_x[0] + dc * slope.by_x[1],
        by_y: db * slope.by_y[0] + dc * slope.by_y[1],
    };
    let simd = footprint.x.token();
    let of_samples = [
        footprint.y * edges[0].dx - footprint.x * edges[0].dy,
        footprint.y * edges[1].dx - footprint.x * edges[1].dy,
        footprint.y * edges[2].dx - footprint.x * edges[2].dy,
    ];
    let blocks = |axis: usize| {
        (reached.min[axis] - corner[axis]) / BLOCK..=(reached.max[axis] - corner[axis]) / BLOCK
    };
    for block_row in blocks(1) {
        for block_column in blocks(0) {
            let at = [
                corner[0] + block_column * BLOCK,
                corner[1] + block_row * BLOCK,
            ];
            let mut at_corner = [0; 3];
            let mut by_edge = [(0, 0); 3];
            let mut lanes = [i32x8::splat(simd, 0); 3];
            let mut is_outside = false;
            for (index, edge) in edges.iter().enumerate() {
                match edge.across(at.map(|pixel| pixel * EIGHTHS as u32)) {
                    Across::Outside => is_outside = true,
                    // Stays 0 and so inside.
                    Across::Inside => {}
                    Across::Through(value) => {
                        at_corner[index] = value;
                        by_edge[index] = (EIGHTHS * edge.dx, -EIGHTHS * edge.dy);
                        lanes[index] = of_samples[index];
                    }
                }
            }
            if is_outside {
                continue;
            }
            let samples = tile.block((block_row * BLOCK_COLUMNS + block_column) as usize, layer);
            // The part of the block that is reached, in pixels from its corner.
            let [left, top] = [0, 1].map(|axis| reached.min[axis].max(at[axis]) - at[axis]);
            let [right, bottom] = [0, 1].map(|axis| (reached.max[axis] - at[axis]).min(BLOCK - 1));
            let groups = BLOCK / footprint.pixels;
            for row in top..=bottom {
                let y =
                    f32x8::splat(simd, (at[1] + row) as f32) + footprint.pixel_y - depth.origin[1];
                let of_row = y * depth.by_y + depth.at_origin;
                for group in left / footprint.pixels..=right / footprint.pixels {
                    let column = group * footprint.pixels;
                    let mut inside = [0; 3];
                    for edge in 0..3 {
                        let (down, right) = by_edge[edge];
                        inside[edge] = at_corner[edge] + down * row as i32 + right * column as i32;
                    }
                    let [first, second, third] = inside;
                    let outside = (lanes[0] + first) | (lanes[1] + second) | (lanes[2] + third);
                    // Negative where any is.
                    let covered = outside.simd_ge(0);
                    if !covered.any_true() {
                        continue;
                    }
                    let index = (row * groups + group) as usize;
                    let x = f32x8::splat(simd, (at[0] + column) as f32) + footprint.pixel_x
                        - depth.origin[0];
                    let found = x * depth.by_x + of_row;
                    let there = f32x8::load_array(simd, samples.depth[index]);
                    let wins = covered & found.simd_gt(there);
                    let shown = u32x8::load_array(simd, samples.triangle[index]);
                    wins.select(found, there)
                        .store_array(&mut samples.depth[index]);
                    wins.select(u32x8::splat(simd, number), shown)
                        .store_array(&mut samples.triangle[index]);
                }
            }
        }
    }
}

/// How near a triangle is, over the picture.
#[derive(Clone, Copy)]
struct Depth {
    origin: [f32; 2],
    at_origin: f32,
    by_x: f32,
    by_y: f32,
}
