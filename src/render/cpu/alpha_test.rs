//! Surfaces with holes: a triangle is not there in the pixels in whose middle it lets through too much.
//! Never lives here: which samples it covers.

use super::interpolate::Plane;
use super::material::PartMaterial;
use super::raster::CoverageTest;
use super::triangle::{Corner, Slope};
use fearless_simd::prelude::*;

/// A triangle of a masked surface, or a piece of one.
pub(super) struct AlphaTest<'a, S: Simd> {
    simd: S,
    material: &'a PartMaterial<'a>,
    /// In pixels.
    origin: [f32; 2],
    texcoord: Plane,
    color: Plane,
}

impl<'a, S: Simd> AlphaTest<'a, S> {
    /// Of a triangle that is no line.
    #[inline(always)]
    pub(super) fn of(simd: S, material: &'a PartMaterial<'a>, corners: &[Corner; 3]) -> Self {
        let slope = Slope::of(corners.map(|corner| corner.projected));
        Self {
            simd,
            material,
            origin: slope.origin,
            texcoord: Plane::of_texcoords(simd, &slope, corners),
            color: Plane::of_colors(simd, &slope, corners),
        }
    }
}

impl<S: Simd> CoverageTest for AlphaTest<'_, S> {
    const PASSES_ALWAYS: bool = false;

    #[inline(always)]
    fn passes(&self, pixel: [u32; 2]) -> bool {
        let planes = [&self.texcoord, &self.color];
        let pixel = pixel.map(|at| at as f32);
        let alpha = self.material.alpha(self.simd, planes, self.origin, pixel);
        alpha >= self.material.params.least_alpha
    }
}
