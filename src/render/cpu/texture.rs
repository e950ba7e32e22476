//! Sampling of textures, as `shaders/shade.wgsl` has it: in linear light, repeated, the level of detail by the formula in
//! [`Plan`](crate::render::Plan)'s module.

use crate::rig::{LINEAR_FROM_SRGB, Texture, TextureLevel};
use fearless_simd::f32x4;
use fearless_simd::prelude::*;

/// Linear RGB at a place of the texture, `v` = 0 its bottom. `by_x` and `by_y` say how far the place moves from pixel to pixel.
#[inline(always)]
pub(super) fn sample<S: Simd>(
    simd: S,
    texture: &Texture,
    texcoord: [f32; 2],
    by_x: [f32; 2],
    by_y: [f32; 2],
) -> [f32; 4] {
    let levels = texture.levels();
    let size = [levels[0].width as f32, levels[0].height as f32];
    let texels_squared = squared(by_x, size).max(squared(by_y, size));
    // Of nothing, and of what is no number, the full picture.
    let level = if texels_squared > 1.0 {
        (0.5 * libm::log2f(texels_squared)).min((levels.len() - 1) as f32)
    } else {
        0.0
    };
    let lower = level as usize;
    let share = level - lower as f32;
    let nearer = bilinear(simd, &levels[lower], texcoord);
    if share == 0.0 {
        return nearer.to_array();
    }
    let further = bilinear(simd, &levels[lower + 1], texcoord);
    mix(nearer, further, share).to_array()
}

fn squared([u, v]: [f32; 2], [width, height]: [f32; 2]) -> f32 {
    let (x, y) = (u * width, v * height);
    x * x + y * y
}

#[inline(always)]
fn bilinear<S: Simd>(simd: S, level: &TextureLevel, [u, v]: [f32; 2]) -> f32x4<S> {
    let table: &[f32; 256] = &LINEAR_FROM_SRGB;
    let ([left, right], across) = neighbours(u, level.width);
    let ([upper, lower], down) = neighbours(1.0 - v, level.height);
    let (above, below) = (upper * level.width as usize, lower * level.width as usize);
    let corners = [above + left, above + right, below + left, below + right];
    let mut texels = [f32x4::splat(simd, 0.0); 4];
    for (texel, corner) in texels.iter_mut().zip(corners) {
        let [r, g, b, _] = level.texels[corner];
        let linear = [table[r as usize], table[g as usize], table[b as usize], 1.0];
        *texel = f32x4::load_array(simd, linear);
    }
    let [a, b, c, d] = texels;
    mix(mix(a, b, across), mix(c, d, across), down)
}

#[inline(always)]
fn mix<S: Simd>(a: f32x4<S>, b: f32x4<S>, share: f32) -> f32x4<S> {
    a + (b - a) * share
}

/// The two texels on an axis between whose middles a place lies, and how far it is from the first to the second.
#[inline(always)]
fn neighbours(place: f32, side: u32) -> ([usize; 2], f32) {
    let repeated = place - place.floor();
    // What is no number lies at the start.
    let repeated = if repeated.is_finite() { repeated } else { 0.0 };
    let texels = repeated * side as f32 - 0.5;
    let before = texels.floor();
    let (first, side) = (before as i32, side as i32);
    let last = first + 1;
    (
        [
            (if first < 0 { first + side } else { first }) as usize,
            (if last >= side { last - side } else { last }) as usize,
        ],
        texels - before,
    )
}
