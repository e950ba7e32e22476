//! Sampling of textures, as `shaders/shade.wgsl` has it: colors in linear light, the level of detail by the formula in
//! [`Plan`](crate::render::Plan)'s module. Never lives here: where on a texture a pixel is.

use crate::rig::{Encoding, LINEAR_FROM_SRGB, Texture, TextureLevel, TexturePlace, Wrap};
use fearless_simd::f32x4;
use fearless_simd::prelude::*;

/// Linear RGB at a place of a texture that is repeated, `v` = 0 its bottom. `by_x` and `by_y` say how far the place moves from pixel to
/// pixel.
#[inline(always)]
pub(super) fn sample<S: Simd>(
    simd: S,
    texture: &Texture,
    [u, v]: [f32; 2],
    by_x: [f32; 2],
    by_y: [f32; 2],
) -> [f32; 4] {
    let levels = texture.levels();
    let (lower, share) = level(levels, by_x, by_y);
    let at = |level: &TextureLevel| {
        [
            neighbours(u, level.width, Wrap::Repeat),
            neighbours(1.0 - v, level.height, Wrap::Repeat),
        ]
    };
    let nearer = bilinear::<S, false>(simd, &levels[lower], &LINEAR_FROM_SRGB, at(&levels[lower]));
    if share == 0.0 {
        return nearer.to_array();
    }
    let next = &levels[lower + 1];
    let further = bilinear::<S, false>(simd, next, &LINEAR_FROM_SRGB, at(next));
    mix(nearer, further, share).to_array()
}

/// Color, or numbers, and straight alpha of a texture as it lies on a surface. `place` is on the picture, from its upper left corner.
#[inline(always)]
pub(super) fn sample_wrapped<S: Simd>(
    simd: S,
    laid: &TexturePlace,
    [x, y]: [f32; 2],
    by_x: [f32; 2],
    by_y: [f32; 2],
) -> [f32; 4] {
    let levels = laid.texture.levels();
    let table: &[f32; 256] = match laid.texture.encoding() {
        Encoding::Srgb => &LINEAR_FROM_SRGB,
        Encoding::Linear => &SHARES,
    };
    let [across, down] = laid.wrap;
    let (lower, share) = level(levels, by_x, by_y);
    let at = |level: &TextureLevel| {
        [
            neighbours(x, level.width, across),
            neighbours(y, level.height, down),
        ]
    };
    let nearer = bilinear::<S, true>(simd, &levels[lower], table, at(&levels[lower]));
    if share == 0.0 {
        return nearer.to_array();
    }
    let next = &levels[lower + 1];
    let further = bilinear::<S, true>(simd, next, table, at(next));
    mix(nearer, further, share).to_array()
}

/// What each of the 256 values of a channel is of the whole.
static SHARES: [f32; 256] = {
    let mut shares = [0.0; 256];
    let mut value = 0;
    while value < 256 {
        shares[value] = value as f32 / 255.0;
        value += 1;
    }
    shares
};

/// The level before the one wanted, and how far it is from there to the next.
#[inline(always)]
fn level(levels: &[TextureLevel], by_x: [f32; 2], by_y: [f32; 2]) -> (usize, f32) {
    let size = [levels[0].width as f32, levels[0].height as f32];
    let texels_squared = squared(by_x, size).max(squared(by_y, size));
    // Of nothing, and of what is no number, the full picture.
    let level = if texels_squared > 1.0 {
        (0.5 * libm::log2f(texels_squared)).min((levels.len() - 1) as f32)
    } else {
        0.0
    };
    let lower = level as usize;
    (lower, level - lower as f32)
}

fn squared([u, v]: [f32; 2], [width, height]: [f32; 2]) -> f32 {
    let (x, y) = (u * width, v * height);
    x * x + y * y
}

/// Red, green and blue as `table` has them, and alpha, or anything in its place.
#[inline(always)]
fn bilinear<S: Simd, const HAS_ALPHA: bool>(
    simd: S,
    level: &TextureLevel,
    table: &[f32; 256],
    [([left, right], across), ([upper, lower], down)]: [([usize; 2], f32); 2],
) -> f32x4<S> {
    let (above, below) = (upper * level.width as usize, lower * level.width as usize);
    let corners = [above + left, above + right, below + left, below + right];
    let mut texels = [f32x4::splat(simd, 0.0); 4];
    for (texel, corner) in texels.iter_mut().zip(corners) {
        let [r, g, b, alpha] = level.texels[corner];
        let alpha = if HAS_ALPHA {
            SHARES[alpha as usize]
        } else {
            1.0
        };
        let linear = [
            table[r as usize],
            table[g as usize],
            table[b as usize],
            alpha,
        ];
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
fn neighbours(place: f32, side: u32, wrap: Wrap) -> ([usize; 2], f32) {
    let within = match wrap {
        Wrap::Repeat => place - place.floor(),
        Wrap::Mirror => {
            let twice = place - 2.0 * (0.5 * place).floor();
            if twice > 1.0 { 2.0 - twice } else { twice }
        }
        // Half a texel beyond an edge, and further, there is nothing but the texels at the edge.
        Wrap::Clamp => place.clamp(-1.0, 2.0),
    };
    // What is no number lies at the start.
    let within = if within.is_finite() { within } else { 0.0 };
    let texels = within * side as f32 - 0.5;
    let before = texels.floor();
    let (first, side) = (before as i32, side as i32);
    let last = first + 1;
    let pair = match wrap {
        Wrap::Repeat => [
            if first < 0 { first + side } else { first },
            if last >= side { last - side } else { last },
        ],
        // What is mirrored at its edge goes on with the same texel.
        Wrap::Mirror | Wrap::Clamp => [first, last].map(|texel| texel.clamp(0, side - 1)),
    };
    (pair.map(|texel| texel as usize), texels - before)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both texels with their shares, as a sampler has them: the texels beside the place, each wrapped by itself.
    fn by_definition(place: f64, side: u32, wrap: Wrap) -> [(usize, f64); 2] {
        let texels = place * f64::from(side) - 0.5;
        let (before, side) = (texels.floor(), i64::from(side));
        let wrapped = |texel: i64| match wrap {
            Wrap::Repeat => texel.rem_euclid(side),
            Wrap::Mirror => {
                let of_both = texel.rem_euclid(2 * side);
                of_both.min(2 * side - 1 - of_both)
            }
            Wrap::Clamp => texel.clamp(0, side - 1),
        };
        let share = texels - before;
        [0, 1].map(|next| {
            let share = if next == 0 { 1.0 - share } else { share };
            (wrapped(before as i64 + next) as usize, share)
        })
    }

    #[test]
    fn beyond_its_edges_a_texture_goes_on_as_samplers_have_it() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for side in [1u32, 2, 3, 4, 7] {
                for step in -300..300 {
                    // A number that both hold, off the places where one texel gives way to the next.
                    let place = f64::from(step) / 64.0 + 1.0 / 512.0;
                    let (pair, share) = neighbours(place as f32, side, wrap);
                    let mut found = vec![0.0; side as usize];
                    found[pair[0]] += 1.0 - f64::from(share);
                    found[pair[1]] += f64::from(share);
                    for (texel, share) in by_definition(place, side, wrap) {
                        found[texel] -= share;
                    }
                    let is_nothing = |left: &f64| left.abs() < 1e-5;
                    assert!(
                        found.iter().all(is_nothing),
                        "{wrap:?} of {side} at {place}"
                    );
                }
            }
        }
    }

    #[test]
    fn places_that_are_no_numbers_or_far_off_are_on_the_texture() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for place in [
                f32::NAN,
                f32::INFINITY,
                -f32::INFINITY,
                3e38,
                -3e38,
                -1e-30,
                1e9,
            ] {
                let ([first, last], share) = neighbours(place, 5, wrap);
                assert!(
                    first < 5 && last < 5 && (0.0..=1.0).contains(&share),
                    "{wrap:?} {place}"
                );
            }
        }
    }
}
