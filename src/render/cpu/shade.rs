//! Stage 3, shade: the twin of `shaders/light.wgsl`, for many fragments at a time. A fragment is what a triangle shows of one pixel.

use super::lanes::{LANES, Lanes, Vectors, held, power, rows_of, transposed};
use crate::render::view::View;
use fearless_simd::f32x4;
use fearless_simd::prelude::*;
use glam::Vec4;

/// What a triangle shows of a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Fragment {
    /// The normal, of any length, and 1 / w.
    pub normal: [f32; 4],
    /// The position over w.
    pub position: [f32; 4],
    /// What is scattered, linear RGB, and 1; of what is not lit, its color and 0.
    pub diffuse: [f32; 4],
}

/// The fragments of one block and layer.
pub(super) struct Fragments {
    pub count: usize,
    /// In the block, and at how many samples of it the fragment is seen.
    pub pixel: Vec<(u8, u8)>,
    pub given: Vec<Fragment>,
    /// Linear, from 0 to 1, and 1.
    pub color: Vec<[f32; 4]>,
}

impl Fragments {
    /// Of a block whose pixels show as many triangles as they have samples.
    const MOST: usize = super::samples::BLOCK_PIXELS * 4;

    pub fn add(&mut self, pixel: usize, samples: usize, fragment: Fragment) {
        self.pixel[self.count] = (pixel as u8, samples as u8);
        self.given[self.count] = fragment;
        self.count += 1;
    }
}

impl Default for Fragments {
    fn default() -> Self {
        Self {
            count: 0,
            pixel: vec![(0, 0); Self::MOST],
            given: vec![Fragment::default(); Self::MOST],
            color: vec![[0.0; 4]; Self::MOST],
        }
    }
}

/// Colors all fragments.
#[inline(always)]
pub(super) fn shade<S: Simd>(simd: S, view: &View, fragments: &mut Fragments) {
    let groups = fragments.count.div_ceil(LANES);
    for group in 0..groups {
        let given = &fragments.given.as_chunks::<LANES>().0[group];
        let mut rows = [[f32x4::splat(simd, 0.0); LANES]; 3];
        for lane in 0..LANES {
            rows[0][lane] = f32x4::load_array(simd, given[lane].normal);
            rows[1][lane] = f32x4::load_array(simd, given[lane].position);
            rows[2][lane] = f32x4::load_array(simd, given[lane].diffuse);
        }
        let [nx, ny, nz, inverse_w] = transposed(rows[0]);
        let [px, py, pz, _] = transposed(rows[1]);
        let [red, green, blue, is_lit] = transposed(rows[2]);
        let normal = Vectors {
            x: nx,
            y: ny,
            z: nz,
        };
        let position = Vectors {
            x: px,
            y: py,
            z: pz,
        }
        .times(1.0 / inverse_w);
        let diffuse = Vectors {
            x: red,
            y: green,
            z: blue,
        };
        let lit = blinn_phong(simd, view, position, normal, diffuse);
        let is_lit = is_lit.simd_gt(0.0);
        let colors = rows_of([
            is_lit.select(lit.x, red),
            is_lit.select(lit.y, green),
            is_lit.select(lit.z, blue),
            Lanes::splat(simd, 1.0),
        ]);
        let into = &mut fragments.color.as_chunks_mut::<LANES>().0[group];
        for lane in 0..LANES {
            into[lane] = colors[lane].to_array();
        }
    }
}

/// `ambient · diffuse + Σ radiance · (diffuse · max(n·l, 0) + [n·l > 0] · specular · max(n·h, 0)^shininess)`, clamped.
#[inline(always)]
fn blinn_phong<S: Simd>(
    simd: S,
    view: &View,
    position: Vectors<S>,
    normal: Vectors<S>,
    diffuse: Vectors<S>,
) -> Vectors<S> {
    let zero = Lanes::splat(simd, 0.0);
    let nothing = Vectors::splat(simd, [0.0; 3]);
    let toward_eye = toward(view.eye_in_world, position).unit_or(nothing);
    // A surface without a normal faces the eye.
    let normal = normal.unit_or(toward_eye);
    let has_highlight = view.specular.max_element() > 0.0;
    let [ar, ag, ab] = view.ambient.to_array();
    let [sr, sg, sb] = view.specular.to_array();
    let mut color = Vectors {
        x: diffuse.x * ar,
        y: diffuse.y * ag,
        z: diffuse.z * ab,
    };
    for light in &view.lights[..view.light_count as usize] {
        let to_light = toward(light.toward_or_position, position);
        // A point that the light itself sits on is lit from nowhere.
        let is_point = light.toward_or_position.w == 1.0;
        let l = if is_point {
            to_light.unit_or(nothing)
        } else {
            to_light
        };
        let n_dot_l = normal.dot(l);
        let is_lit = n_dot_l.simd_gt(zero);
        if !is_lit.any_true() {
            continue;
        }
        let [lr, lg, lb, falls_off] = light.radiance.to_array();
        let strength = if falls_off == 1.0 {
            let distance_squared = to_light.dot(to_light);
            1.0 / distance_squared.max(view.least_distance_squared)
        } else {
            Lanes::splat(simd, 1.0)
        };
        let strength = is_lit.select(strength, zero);
        let scattered = n_dot_l * strength;
        color.x += diffuse.x * scattered * lr;
        color.y += diffuse.y * scattered * lg;
        color.z += diffuse.z * scattered * lb;
        if has_highlight {
            let halfway = l.plus(toward_eye);
            let squared = halfway.dot(halfway);
            let n_dot_h = normal.dot(halfway).max(zero);
            // The cosine's square, so that no root is needed; where light and eye are opposite there is no halfway.
            let cosine_squared = squared
                .simd_gt(zero)
                .select(n_dot_h * n_dot_h / squared, zero);
            let highlight = power(cosine_squared, view.shininess * 0.5) * strength;
            color.x += highlight * (sr * lr);
            color.y += highlight * (sg * lg);
            color.z += highlight * (sb * lb);
        }
    }
    Vectors {
        x: held(color.x),
        y: held(color.y),
        z: held(color.z),
    }
}

/// From positions to a homogeneous point, or along it where it is infinitely far.
#[inline(always)]
fn toward<S: Simd>(point: Vec4, position: Vectors<S>) -> Vectors<S> {
    let simd = position.x.token();
    let [x, y, z, w] = point.to_array();
    Vectors::splat(simd, [x, y, z]).minus(position.times(Lanes::splat(simd, w)))
}
