//! Sampling of textures, as `shaders/shade.wgsl` has it: in linear light, repeated, the level of detail by the formula in
//! [`Plan`](crate::render::Plan)'s module.

use crate::rig::{LINEAR_FROM_SRGB, Texture, TextureLevel};

/// Linear RGB at a place of the texture, `v` = 0 its bottom. `by_x` and `by_y` say how far the place moves from pixel to pixel.
pub(super) fn sample(
    texture: &Texture,
    texcoord: [f32; 2],
    by_x: [f32; 2],
    by_y: [f32; 2],
) -> [f32; 3] {
    let levels = texture.levels();
    let size = [levels[0].width as f32, levels[0].height as f32];
    let squared = |[u, v]: [f32; 2]| {
        let (u, v) = (u * size[0], v * size[1]);
        u * u + v * v
    };
    let texels_squared = squared(by_x).max(squared(by_y));
    // Of nothing, and of what is no number, the full picture.
    let level = if texels_squared > 1.0 {
        (0.5 * libm::log2f(texels_squared)).min((levels.len() - 1) as f32)
    } else {
        0.0
    };
    let lower = level as usize;
    let share = level - lower as f32;
    let nearer = bilinear(&levels[lower], texcoord);
    if share == 0.0 {
        return nearer;
    }
    let further = bilinear(&levels[lower + 1], texcoord);
    [0, 1, 2].map(|channel| nearer[channel] + (further[channel] - nearer[channel]) * share)
}

fn bilinear(level: &TextureLevel, [u, v]: [f32; 2]) -> [f32; 3] {
    let table = &*LINEAR_FROM_SRGB;
    let ([left, right], across) = neighbours(u, level.width);
    let ([upper, lower], down) = neighbours(1.0 - v, level.height);
    let texel = |x: usize, y: usize| {
        let [r, g, b, _] = level.texels[y * level.width as usize + x];
        [r, g, b].map(|channel| table[channel as usize])
    };
    let mix = |a: [f32; 3], b: [f32; 3], share: f32| {
        [0, 1, 2].map(|channel| a[channel] + (b[channel] - a[channel]) * share)
    };
    let above = mix(texel(left, upper), texel(right, upper), across);
    let below = mix(texel(left, lower), texel(right, lower), across);
    mix(above, below, down)
}

/// The two texels on an axis between whose middles a place lies, and how far it is from the first to the second.
fn neighbours(place: f32, side: u32) -> ([usize; 2], f32) {
    let repeated = place - place.floor();
    // What is no number lies at the start.
    let texels = if repeated.is_finite() { repeated } else { 0.0 } * side as f32 - 0.5;
    let before = texels.floor();
    let side = side as i32;
    let wrapped = |texel: i32| {
        if texel < 0 {
            texel + side
        } else if texel >= side {
            texel - side
        } else {
            texel
        }
    };
    let first = before as i32;
    (
        [wrapped(first) as usize, wrapped(first + 1) as usize],
        texels - before,
    )
}
