//! What a triangle has at its corners, anywhere on it. Divided by w, everything is linear over the picture; so is 1 / w, by which it is
//! divided again (Heckbert and Moreton, "Interpolation for polygon texture mapping and shading", 1991). Four numbers go together.

use super::geometry::Corner;
use super::raster::Slope;
use crate::render::cull::Side;
use fearless_simd::f32x4;
use fearless_simd::prelude::*;
use glam::Vec3;

/// Four numbers that are linear over the picture: at the origin, and how they change from pixel to pixel.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    at_origin: [f32; 4],
    by_x: [f32; 4],
    by_y: [f32; 4],
}

impl Plane {
    #[inline(always)]
    fn through<S: Simd>(simd: S, slope: &Slope, corners: [[f32; 4]; 3]) -> Self {
        let [a, b, c] = corners;
        let at_origin = f32x4::load_array(simd, a);
        let ab = f32x4::load_array(simd, b) - at_origin;
        let ac = f32x4::load_array(simd, c) - at_origin;
        let (by_x, by_y) = (slope.by_x, slope.by_y);
        Self {
            at_origin: a,
            by_x: (ab * by_x[0] + ac * by_x[1]).to_array(),
            by_y: (ab * by_y[0] + ac * by_y[1]).to_array(),
        }
    }

    /// `from_origin` in pixels.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, from_origin: [f32; 2]) -> f32x4<S> {
        let by_x = f32x4::load_array(simd, self.by_x);
        let by_y = f32x4::load_array(simd, self.by_y);
        f32x4::load_array(simd, self.at_origin) + by_x * from_origin[0] + by_y * from_origin[1]
    }
}

/// A triangle, ready to be looked up.
#[derive(Clone, Copy)]
pub(super) struct Planes {
    /// In pixels.
    pub origin: [f32; 2],
    /// The normal on the side that is seen, of any length, then 1 / w.
    pub normal: Plane,
    /// x / w, y / w, z / w in world space.
    pub position: Plane,
    /// u / w, v / w, 1 / w.
    pub texcoord: Plane,
}

impl Planes {
    /// Of a triangle that is no line. `is_flat`: lit by its own normal.
    #[inline(always)]
    pub fn of<S: Simd>(simd: S, corners: [Corner; 3], side: Side, is_flat: bool) -> Self {
        let slope = Slope::of(corners.map(|corner| corner.projected));
        let toward_us = match side {
            Side::Front => 1.0,
            Side::Back => -1.0,
        };
        let divided = |corner: &Corner, numbers: [f32; 3], factor: f32| {
            let inverse_w = corner.projected.inverse_w;
            let [x, y, z] = numbers.map(|number| number * factor * inverse_w);
            [x, y, z, inverse_w]
        };
        let mut normals = corners.map(|corner| divided(&corner, corner.normal, toward_us));
        if is_flat {
            let [a, b, c] = corners.map(|corner| Vec3::from_array(corner.position));
            let own = (b - a).cross(c - a) * toward_us;
            for normal in &mut normals {
                normal[..3].copy_from_slice(&own.to_array());
            }
        }
        let positions = corners.map(|corner| divided(&corner, corner.position, 1.0));
        let texcoords = corners.map(|corner| {
            let ([u, v], inverse_w) = (corner.texcoord, corner.projected.inverse_w);
            [u * inverse_w, v * inverse_w, inverse_w, 0.0]
        });
        Self {
            origin: slope.origin,
            normal: Plane::through(simd, &slope, normals),
            position: Plane::through(simd, &slope, positions),
            texcoord: Plane::through(simd, &slope, texcoords),
        }
    }
}
