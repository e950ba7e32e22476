//! Stage 2, raster: which samples lie in a triangle, and which of them it is the nearest at (Pineda, "A parallel algorithm for polygon
//! rasterization", 1988). All of it is whole numbers but depth. Never lives here: color.
//!
//! A corner is a point in steps of 1/256 pixel. The edge from a to b has the function
//! `E(p) = (b.x − a.x)(p.y − a.y) − (b.y − a.y)(p.x − a.x)`, positive on the right of it as it runs on the picture, whose rows run
//! downward: where the corners run clockwise a sample is inside if all three edges are positive there. A sample on an edge belongs to the
//! triangle whose top or left edge that is, so that of two triangles at an edge exactly one has it.
//!
//! Samples lie on a grid of eighths of a pixel, 32 steps apart. In eighths (i, j) the function is `32·(dx·j − dy·i) + C`, which is at
//! least 0 just where `dx·j − dy·i + ⌊C / 32⌋` is. This is evaluated at a corner in 64 bits. Over a small triangle it is so small that 32
//! bits hold it, eight samples at a time. A larger one goes by blocks of 8 x 8 pixels: either a whole block lies on one side of an edge,
//! or the function is small in all of the block.

use super::grid::Rectangle;
use super::project::{Projected, STEPS};
use super::samples::{BLOCK, EIGHTHS, GROUP, Layer, Pattern, STEPS_IN_EIGHTH, TileSamples};
use super::triangle::{Slope, doubled_area};
use fearless_simd::prelude::*;
use fearless_simd::{f32x8, i32x8, mask32x8, u32x8};

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
    pub(super) fn of(simd: S, pattern: Pattern) -> Self {
        let positions = pattern.positions();
        let mut eighths = [[0; GROUP]; 2];
        for lane in 0..GROUP {
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
            pixels: (GROUP / positions.len()) as u32,
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
    Through,
}

impl Edge {
    /// `at_corner` is its function at the block's upper left corner.
    #[inline(always)]
    fn across(&self, at_corner: i64) -> Across {
        /// The furthest that a sample lies from the corner, in eighths.
        const REACH: i64 = (BLOCK as i32 * EIGHTHS - 1) as i64;
        let (dx, dy) = (i64::from(self.dx), i64::from(self.dy));
        if at_corner + REACH * (dx.max(0) + (-dy).max(0)) < 0 {
            Across::Outside
        } else if at_corner + REACH * (dx.min(0) + (-dy).min(0)) >= 0 {
            Across::Inside
        } else {
            // Of either sign within the block, so no larger than `REACH · (|dx| + |dy|)`, which the guard band keeps below 2^30.
            Across::Through
        }
    }
}

/// Which of the pixels that a triangle covers show it: an alpha test for each of them.
pub(super) trait CoverageTest {
    /// Whether all of them do.
    const PASSES_ALWAYS: bool;

    fn passes(&self, pixel: [u32; 2]) -> bool;
}

/// Of a surface without an alpha test.
pub(super) struct Opaque;

impl CoverageTest for Opaque {
    const PASSES_ALWAYS: bool = true;

    #[inline(always)]
    fn passes(&self, _: [u32; 2]) -> bool {
        true
    }
}

/// What a triangle is drawn on.
pub(super) trait Target {
    /// Whether it hides what is drawn behind it later.
    const HIDES: bool;

    fn samples(&mut self) -> &mut TileSamples;

    /// The triangle at those samples of the group of a pixel of the tile that are `covered`, where it is nearer than what is there and
    /// `present`.
    fn show<S: Simd>(
        &mut self,
        of_tile: [u32; 2],
        covered: mask32x8<S>,
        nearness: f32x8<S>,
        present: impl FnOnce(mask32x8<S>) -> mask32x8<S>,
    );
}

/// Samples keep what is nearest.
pub(super) struct Nearest<'a> {
    pub tile: &'a mut TileSamples,
    pub mark: Mark,
}

impl Target for Nearest<'_> {
    const HIDES: bool = true;

    #[inline(always)]
    fn samples(&mut self) -> &mut TileSamples {
        self.tile
    }

    #[inline(always)]
    fn show<S: Simd>(
        &mut self,
        of_tile: [u32; 2],
        covered: mask32x8<S>,
        nearness: f32x8<S>,
        present: impl FnOnce(mask32x8<S>) -> mask32x8<S>,
    ) {
        let simd = nearness.token();
        let group = self.tile.group(of_tile, self.mark.layer);
        let there = f32x8::load_array(simd, *group.depth);
        let shown = u32x8::load_array(simd, *group.triangle);
        let wins = present(covered & nearness.simd_gt(there));
        let number = u32x8::splat(simd, self.mark.number);
        wins.select(nearness, there).store_array(group.depth);
        wins.select(number, shown).store_array(group.triangle);
    }
}

/// What samples keep of a triangle, and in which of their layers.
#[derive(Clone, Copy)]
pub(super) struct Mark {
    pub layer: Layer,
    pub number: u32,
}

/// Draws a triangle onto the samples of a tile where it is nearer than what is there. `reached` lies within the tile, whose upper left
/// pixel is `corner`.
#[inline(always)]
pub(super) fn draw<S: Simd, T: Target, P: CoverageTest>(
    footprint: &Footprint<S>,
    target: T,
    corner: [u32; 2],
    corners: [Projected; 3],
    reached: Rectangle,
    test: &P,
) {
    /// Pixels: of a triangle that is no longer no edge function exceeds `2 · 64 · 8 · 64 · 256`, which is 2^24, within its rectangle.
    const SMALL: u32 = 64;
    let [a, b, c] = corners;
    let [a, b, c] = if doubled_area(corners) > 0 {
        [a, b, c]
    } else {
        [a, c, b]
    };
    let edges = [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)];
    let slope = Slope::of([a, b, c]);
    let (db, dc) = (b.depth - a.depth, c.depth - a.depth);
    let mut walk = Walk {
        footprint,
        target,
        corner,
        test,
        depth: Depth {
            origin: slope.origin,
            at_origin: a.depth,
            by_x: db * slope.by_x[0] + dc * slope.by_x[1],
            by_y: db * slope.by_y[0] + dc * slope.by_y[1],
        },
    };
    let is_small = |[a, b, c]: [i32; 3]| a.max(b).max(c) - a.min(b).min(c) <= SMALL as i32 * STEPS;
    if is_small([a.x, b.x, c.x]) && is_small([a.y, b.y, c.y]) {
        let [a, b, c] = edges;
        return walk.rectangle([Some(a), Some(b), Some(c)], reached);
    }
    let blocks = |axis: usize| reached.min[axis] / BLOCK..=reached.max[axis] / BLOCK;
    for row in blocks(1) {
        for column in blocks(0) {
            let at = [column * BLOCK, row * BLOCK];
            let mut through = [None; 3];
            let mut is_outside = false;
            for (through, edge) in through.iter_mut().zip(edges) {
                match edge.across(edge.at(at.map(|pixel| pixel * EIGHTHS as u32))) {
                    Across::Outside => is_outside = true,
                    Across::Inside => {}
                    Across::Through => *through = Some(edge),
                }
            }
            if is_outside {
                continue;
            }
            let [least, most] = walk.depth.over_block(at);
            let in_tile = [at[0] - corner[0], at[1] - corner[1]];
            if most <= *walk.target.samples().least_depth(in_tile) {
                continue;
            }
            let last = [at[0] + BLOCK - 1, at[1] + BLOCK - 1];
            walk.rectangle(through, reached.within(at, last));
            // One with holes hides nothing for certain.
            if T::HIDES && P::PASSES_ALWAYS && through.iter().all(Option::is_none) {
                let there = walk.target.samples().least_depth(in_tile);
                *there = there.max(least);
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

impl Depth {
    /// The least and the most that a sample of a block may come to: samples lie an eighth of a pixel from its edges, which is more than
    /// what rounding moves them by, and rounding keeps what is larger larger.
    #[inline(always)]
    fn over_block(&self, at: [u32; 2]) -> [f32; 2] {
        let span = |axis: usize, by: f32| {
            let from = at[axis] as f32 - self.origin[axis];
            let ends = [from * by, (from + BLOCK as f32) * by];
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        };
        let (x, y) = (span(0, self.by_x), span(1, self.by_y));
        [0, 1].map(|end| x[end] + (y[end] + self.at_origin))
    }
}

/// A triangle on its way through the samples of a tile.
struct Walk<'a, S: Simd, T, P> {
    footprint: &'a Footprint<S>,
    target: T,
    corner: [u32; 2],
    test: &'a P,
    depth: Depth,
}

impl<S: Simd, T: Target, P: CoverageTest> Walk<'_, S, T, P> {
    /// Every sample of the pixels of `within`, as far as it is inside of those edges that are given. 32 bits hold their functions there.
    #[inline(always)]
    fn rectangle(&mut self, edges: [Option<Edge>; 3], within: Rectangle) {
        let footprint = *self.footprint;
        let simd = footprint.x.token();
        // Groups of samples start at every so many pixels, of tiles too.
        let left = within.min[0] / footprint.pixels * footprint.pixels;
        let mut of_row = [i32x8::splat(simd, 0); 3];
        let mut down = [0; 3];
        let mut right = [0; 3];
        for index in 0..3 {
            // Without an edge all stays 0, and so inside.
            if let Some(edge) = edges[index] {
                let at_left = edge.at([left * EIGHTHS as u32, within.min[1] * EIGHTHS as u32]);
                of_row[index] = footprint.y * edge.dx - footprint.x * edge.dy + at_left as i32;
                down[index] = EIGHTHS * edge.dx;
                right[index] = -EIGHTHS * footprint.pixels as i32 * edge.dy;
            }
        }
        let [mut row_a, mut row_b, mut row_c] = of_row;
        let depth = self.depth;
        let first_x = footprint.pixel_x + (left as f32 - depth.origin[0]);
        for y in within.min[1]..=within.max[1] {
            let (mut a, mut b, mut c) = (row_a, row_b, row_c);
            let from_top = footprint.pixel_y + (y as f32 - depth.origin[1]);
            let depth_of_row = from_top * depth.by_y + depth.at_origin;
            let mut x = left;
            while x <= within.max[0] {
                // Negative where any of them is.
                let covered = (a | b | c).simd_ge(0);
                if covered.any_true() {
                    let from_left = first_x + (x - left) as f32;
                    let nearness = from_left * depth.by_x + depth_of_row;
                    self.show([x, y], covered, nearness);
                }
                (a, b, c) = (a + right[0], b + right[1], c + right[2]);
                x += footprint.pixels;
            }
            (row_a, row_b, row_c) = (row_a + down[0], row_b + down[1], row_c + down[2]);
        }
    }

    /// The triangle at those samples of a group that it covers and is nearest at.
    #[inline(always)]
    fn show(&mut self, pixel: [u32; 2], covered: mask32x8<S>, nearness: f32x8<S>) {
        let of_tile = [pixel[0] - self.corner[0], pixel[1] - self.corner[1]];
        let (test, pixels) = (self.test, self.footprint.pixels);
        self.target.show(
            of_tile,
            covered,
            nearness,
            #[inline(always)]
            |wins| {
                if P::PASSES_ALWAYS {
                    wins
                } else {
                    present(test, pixel, pixels, wins)
                }
            },
        );
    }
}

/// Those samples of a group, whose first pixel this is, in whose pixel a triangle is there.
#[inline(always)]
fn present<S: Simd, P: CoverageTest>(
    test: &P,
    [x, y]: [u32; 2],
    pixels: u32,
    wins: mask32x8<S>,
) -> mask32x8<S> {
    let samples = GROUP as u32 / pixels;
    let of_pixel = (1u64 << samples) - 1;
    let mut left = wins.to_bitmask();
    for index in 0..pixels {
        let own = of_pixel << (index * samples);
        if left & own != 0 && !test.passes([x + index, y]) {
            left &= !own;
        }
    }
    mask32x8::from_bitmask(wins.token(), left)
}
