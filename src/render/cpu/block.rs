//! A block of a tile from samples to colors. Never lives here: what covers the samples, and light.

use super::context::PictureContext;
use super::gather::Gather;
use super::shade::shade;
use fearless_simd::prelude::*;

/// Gathers and shades what the samples of a block show.
#[inline(always)]
pub(super) fn shade_shown<S: Simd>(
    simd: S,
    picture: &PictureContext<'_>,
    mut gather: Gather<'_>,
    shown: &[u32],
) {
    if !picture.has_materials {
        match picture.pattern.count() {
            1 => gather.block::<S, 1, false>(simd, shown),
            _ => gather.block::<S, 4, false>(simd, shown),
        }
        shade::<S, false>(simd, picture.view, picture.plain, gather.fragments);
    } else {
        shade_materials(simd, picture, gather, shown);
    }
}

/// Gathers and shades a block that may show surfaces with materials of their own. By itself, so that it does not lie in the way of pictures without.
#[inline(never)]
fn shade_materials<S: Simd>(
    simd: S,
    picture: &PictureContext<'_>,
    mut gather: Gather<'_>,
    shown: &[u32],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            match picture.pattern.count() {
                1 => gather.block::<S, 1, true>(simd, shown),
                _ => gather.block::<S, 4, true>(simd, shown),
            }
            shade::<S, true>(simd, picture.view, picture.plain, gather.fragments);
        },
    );
}
