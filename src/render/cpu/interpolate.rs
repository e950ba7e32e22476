//! What a triangle has at its corners, anywhere on it. Divided by w, everything is linear over the picture; so is 1 / w, by which it is
//! divided again (Heckbert and Moreton, "Interpolation for polygon texture mapping and shading", 1991). Four numbers go together.

use super::triangle::{Corner, Slope};
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

    /// u / w, v / w, 1 / w.
    #[inline(always)]
    pub(super) fn of_texcoords<S: Simd>(simd: S, slope: &Slope, [a, b, c]: &[Corner; 3]) -> Self {
        let texcoord = |corner: &Corner| {
            let ([u, v], inverse_w) = (corner.texcoord, corner.projected.inverse_w);
            [u * inverse_w, v * inverse_w, inverse_w, 0.0]
        };
        Self::through(simd, slope, [texcoord(a), texcoord(b), texcoord(c)])
    }

    /// The vertex color over w.
    #[inline(always)]
    pub(super) fn of_colors<S: Simd>(simd: S, slope: &Slope, [a, b, c]: &[Corner; 3]) -> Self {
        let color = |corner: &Corner| {
            let inverse_w = corner.projected.inverse_w;
            corner.color.map(|channel| channel * inverse_w)
        };
        Self::through(simd, slope, [color(a), color(b), color(c)])
    }

    /// `from_origin` in pixels.
    #[inline(always)]
    pub(super) fn at<S: Simd>(&self, simd: S, from_origin: [f32; 2]) -> f32x4<S> {
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
    pub(super) fn of<S: Simd>(simd: S, corners: [Corner; 3], side: Side, is_flat: bool) -> Self {
        let [a, b, c] = &corners;
        let slope = Slope::of([a.projected, b.projected, c.projected]);
        let toward_us = if side == Side::Front { 1.0 } else { -1.0 };
        let normals = if is_flat {
            let own = own_normal(&corners) * toward_us;
            // The same at every corner, so not divided by w.
            let at = |corner: &Corner| own.extend(corner.projected.inverse_w).to_array();
            [at(a), at(b), at(c)]
        } else {
            let at = |corner: &Corner| corner.over_w(corner.normal, toward_us);
            [at(a), at(b), at(c)]
        };
        let position = |corner: &Corner| corner.over_w(corner.position, 1.0);
        Self {
            origin: slope.origin,
            normal: Plane::through(simd, &slope, normals),
            position: Plane::through(simd, &slope, [position(a), position(b), position(c)]),
            texcoord: Plane::of_texcoords(simd, &slope, &corners),
        }
    }
}

/// On the side that it is seen from where its corners run counter-clockwise, of any length.
fn own_normal([a, b, c]: &[Corner; 3]) -> Vec3 {
    let from = Vec3::from_array(a.position);
    (Vec3::from_array(b.position) - from).cross(Vec3::from_array(c.position) - from)
}

impl Corner {
    /// A vector of this corner, and 1, divided by w.
    #[inline(always)]
    fn over_w(&self, [x, y, z]: [f32; 3], factor: f32) -> [f32; 4] {
        let inverse_w = self.projected.inverse_w;
        let factor = factor * inverse_w;
        [x * factor, y * factor, z * factor, inverse_w]
    }
}
