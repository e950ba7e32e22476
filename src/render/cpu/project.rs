//! From model space onto the picture, in fixed point: what is drawn is decided by whole numbers, so that neighbouring triangles agree
//! about every sample of the edge between them. Never lives here: which samples those are.

use super::lanes::{LANES, Lanes, Vectors, WholeLanes};
use crate::scene::Size;
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use glam::Mat4;

/// Steps of a fixed-point coordinate to a pixel, as GPUs have them.
pub(super) const STEPS: i32 = 256;

/// Between these coordinates, in pixels, a triangle is drawn as it is: twice the side of the largest picture, and no more than what
/// edge functions over a block of pixels hold in 32 bits.
pub(super) const GUARD: [f32; 2] = [-8192.0, 24576.0];

/// Where a vertex falls.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Projected {
    /// In steps from the left and the top edge of the picture.
    pub x: i32,
    pub y: i32,
    /// In pixels, not rounded to steps.
    pub pixel: [f32; 2],
    /// From 1 at the near plane down to 0.
    pub depth: f32,
    pub inverse_w: f32,
}

impl Projected {
    /// Before the near plane, or outside the guard band: its triangles are clipped.
    const BEYOND: Self = Self {
        x: i32::MIN,
        y: i32::MIN,
        pixel: [0.0; 2],
        depth: 0.0,
        inverse_w: 0.0,
    };

    pub(super) fn is_beyond(self) -> bool {
        self.x == i32::MIN
    }
}

/// A camera and an instance before it, as vertices go through both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Projection {
    clip_from_model: [[f32; 4]; 4],
    half_size: [f32; 2],
}

impl Projection {
    pub(super) fn new(clip_from_model: Mat4, size: Size) -> Self {
        Self {
            clip_from_model: clip_from_model.to_cols_array_2d(),
            half_size: [size.width, size.height].map(|side| side as f32 / 2.0),
        }
    }

    pub(super) fn half_size(&self) -> [f32; 2] {
        self.half_size
    }

    /// Over as many positions as there are.
    pub(super) fn project(
        &self,
        level: Level,
        positions: &[[f32; 3]],
        projected: &mut [Projected],
    ) {
        dispatch!(level, simd => {
            let groups = positions.chunks(LANES).zip(projected.chunks_mut(LANES));
            for (positions, projected) in groups {
                let clip = self.clip(Vectors::load(simd, positions));
                self.place(clip).store(projected);
            }
        });
    }

    /// One point, with the numbers that many at a time come to.
    pub(super) fn clip_of(&self, [x, y, z]: [f32; 3]) -> [f32; 4] {
        let [a, b, c, d] = self.clip_from_model;
        [0, 1, 2, 3].map(|row| a[row] * x + b[row] * y + c[row] * z + d[row])
    }

    /// One point of clip space.
    pub(super) fn place_of(&self, clip: [f32; 4]) -> Projected {
        let [x, y] = self.pixel_of(clip);
        let is_inside = |pixel: f32| (GUARD[0]..=GUARD[1]).contains(&pixel);
        let [.., z, w] = clip;
        if z <= w && w > 0.0 && is_inside(x) && is_inside(y) {
            Self::placed(clip, [x, y])
        } else {
            Projected::BEYOND
        }
    }

    /// One point of clip space that was cut to lie inside, and does but for rounding. It lies before the eye.
    pub(super) fn place_inside(&self, [x, y, z, w]: [f32; 4]) -> Projected {
        let pixel = self.pixel_of([x, y, z, w]);
        let pixel = pixel.map(|pixel| pixel.clamp(GUARD[0], GUARD[1]));
        Self::placed([x, y, z.min(w), w], pixel)
    }

    fn pixel_of(&self, [x, y, _, w]: [f32; 4]) -> [f32; 2] {
        let inverse_w = 1.0 / w;
        let [half_width, half_height] = self.half_size;
        [
            x * inverse_w * half_width + half_width,
            half_height - y * inverse_w * half_height,
        ]
    }

    fn placed([_, _, z, w]: [f32; 4], pixel: [f32; 2]) -> Projected {
        let [x, y] = pixel.map(|pixel| (pixel * STEPS as f32).round_ties_even() as i32);
        let inverse_w = 1.0 / w;
        Projected {
            x,
            y,
            pixel,
            depth: z * inverse_w,
            inverse_w,
        }
    }

    #[inline(always)]
    fn clip<S: Simd>(&self, Vectors { x, y, z }: Vectors<S>) -> [Lanes<S>; 4] {
        let [a, b, c, d] = self.clip_from_model;
        let mut clip = [x; 4];
        for row in 0..4 {
            clip[row] = x * a[row] + y * b[row] + z * c[row] + d[row];
        }
        clip
    }

    #[inline(always)]
    fn place<S: Simd>(&self, [x, y, z, w]: [Lanes<S>; 4]) -> Places<S> {
        let inverse_w = 1.0 / w;
        let [half_width, half_height] = self.half_size;
        let pixel_x = x * inverse_w * half_width + half_width;
        let pixel_y = half_height - y * inverse_w * half_height;
        let [low, high] = GUARD;
        let is_inside = z.simd_le(w)
            & w.simd_gt(0.0)
            & pixel_x.simd_ge(low)
            & pixel_x.simd_le(high)
            & pixel_y.simd_ge(low)
            & pixel_y.simd_le(high);
        let beyond = WholeLanes::splat(w.token(), i32::MIN);
        Places {
            x: is_inside.select(in_steps(pixel_x), beyond),
            y: is_inside.select(in_steps(pixel_y), beyond),
            pixel_x,
            pixel_y,
            depth: z * inverse_w,
            inverse_w,
        }
    }
}

#[inline(always)]
fn in_steps<S: Simd>(pixel: Lanes<S>) -> WholeLanes<S> {
    (pixel * STEPS as f32).round_ties_even().to_int()
}

/// As many vertices as there are lanes.
struct Places<S: Simd> {
    x: WholeLanes<S>,
    y: WholeLanes<S>,
    pixel_x: Lanes<S>,
    pixel_y: Lanes<S>,
    depth: Lanes<S>,
    inverse_w: Lanes<S>,
}

impl<S: Simd> Places<S> {
    #[inline(always)]
    fn store(self, projected: &mut [Projected]) {
        let (x, y) = (self.x.to_array(), self.y.to_array());
        let (pixel_x, pixel_y) = (self.pixel_x.to_array(), self.pixel_y.to_array());
        let (depth, inverse_w) = (self.depth.to_array(), self.inverse_w.to_array());
        for (lane, projected) in projected.iter_mut().take(LANES).enumerate() {
            *projected = Projected {
                x: x[lane],
                y: y[lane],
                pixel: [pixel_x[lane], pixel_y[lane]],
                depth: depth[lane],
                inverse_w: inverse_w[lane],
            };
        }
    }
}
