//! Stages 4 and 5, blend and resolve: in parity with `shaders/resolve.wgsl`. Samples of a pixel are averaged, layers laid over each other,
//! and the outcome is encoded as sRGB.

use super::lanes::{LANES, Lanes, power, saturate, transposed};
use super::samples::BLOCK_PIXELS;
use super::shade::Fragments;
use fearless_simd::prelude::*;
use fearless_simd::{f32x4, u32x16};

/// Sums over the samples of each pixel of a block: linear red, green and blue, and how many of them are covered.
pub(super) struct Sums([[f32; 4]; BLOCK_PIXELS]);

impl Default for Sums {
    fn default() -> Self {
        Self([[0.0; 4]; BLOCK_PIXELS])
    }
}

impl Sums {
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Of some of the block's rows, channel by channel.
    #[inline(always)]
    fn rows<S: Simd>(&self, simd: S, rows: usize) -> [Lanes<S>; 4] {
        let of_rows = &self.0.as_chunks::<LANES>().0[rows];
        let mut pixels = [f32x4::splat(simd, 0.0); LANES];
        for lane in 0..LANES {
            pixels[lane] = f32x4::load_array(simd, of_rows[lane]);
        }
        transposed(pixels)
    }

    /// Of `samples` colors of each pixel, premultiplied and with their opacity in place of a count.
    #[inline(always)]
    pub(super) fn of_samples<S: Simd>(simd: S, samples: usize, colors: &[[f32; 4]]) -> Self {
        let mut sums = Self::default();
        for (sum, colors) in sums.0.iter_mut().zip(colors.chunks_exact(samples)) {
            let mut all = f32x4::splat(simd, 0.0);
            for color in colors {
                all += f32x4::load_array(simd, *color);
            }
            all.store_array(sum);
        }
        sums
    }

    /// In the fragments' order.
    #[inline(always)]
    pub(super) fn add<S: Simd>(&mut self, simd: S, fragments: &Fragments) {
        let colors = fragments.pixel.iter().zip(&fragments.color);
        for (&(pixel, samples), &color) in colors.take(fragments.count) {
            let sum = &mut self.0[usize::from(pixel) % BLOCK_PIXELS];
            let more = f32x4::load_array(simd, color) * f32::from(samples);
            (f32x4::load_array(simd, *sum) + more).store_array(sum);
        }
    }
}

/// How the pixels of one picture are put together.
#[derive(Clone, Copy)]
pub(super) struct Resolve {
    /// Premultiplied.
    pub background: [f32; 4],
    pub sample_count: usize,
    /// Of the skin's layer.
    pub opacity: f32,
}

impl Resolve {
    /// As many pixels of a block, row by row, as there are lanes: RGBA8 each, the first byte lowest. `rows` counts by that many.
    #[inline(always)]
    pub(super) fn rows<S: Simd>(
        &self,
        simd: S,
        base: &Sums,
        skin: Option<&Sums>,
        rows: usize,
    ) -> [u32; LANES] {
        let share = 1.0 / self.sample_count as f32;
        // The background shows at samples that nothing covers.
        let mut color = base.rows(simd, rows);
        let uncovered = self.sample_count as f32 - color[3];
        for (channel, behind) in color.iter_mut().zip(self.background) {
            *channel = (*channel + uncovered * behind) * share;
        }
        if let Some(skin) = skin {
            let opacity = self.opacity * share;
            let over = skin.rows(simd, rows);
            let through = 1.0 - over[3] * opacity;
            for channel in 0..4 {
                color[channel] = over[channel] * opacity + color[channel] * through;
            }
        }
        encoded(color).to_array()
    }

    /// A pixel that nothing covers.
    #[inline(always)]
    pub(super) fn empty<S: Simd>(&self, simd: S) -> u32 {
        self.rows(simd, &Sums::default(), None, 0)[0]
    }
}

/// From premultiplied linear color to straight sRGB.
#[inline(always)]
fn encoded<S: Simd>([r, g, b, alpha]: [Lanes<S>; 4]) -> u32x16<S> {
    let is_there = alpha.simd_gt(0.0);
    let zero = Lanes::splat(alpha.token(), 0.0);
    let divisor = alpha.max(1e-6);
    let red = byte(srgb(is_there.select(r / divisor, zero)));
    let green = byte(srgb(is_there.select(g / divisor, zero)));
    let blue = byte(srgb(is_there.select(b / divisor, zero)));
    red | (green << 8) | (blue << 16) | (byte(alpha) << 24)
}

/// From 0..1 to the nearest of 0..255.
#[inline(always)]
fn byte<S: Simd>(number: Lanes<S>) -> u32x16<S> {
    (saturate(number) * 255.0 + 0.5).to_int()
}

/// IEC 61966-2-1.
#[inline(always)]
fn srgb<S: Simd>(linear: Lanes<S>) -> Lanes<S> {
    let curved = power(linear, 1.0 / 2.4) * 1.055 - 0.055;
    linear.simd_le(0.003_130_8).select(linear * 12.92, curved)
}
