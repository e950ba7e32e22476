//! Stage 3, shade: in parity with `shaders/light.wgsl`, for many fragments at a time. A fragment is what a triangle shows of one pixel.

use super::lanes::{LANES, Lanes, Vectors, power, powers, rows_of, saturate, transposed};
use crate::render::instance_params::InstanceParams;
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

/// What a material does beside diffuse reflection.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MaterialSample {
    /// Linear RGB, and shininess.
    pub specular: [f32; 4],
    /// Linear RGB, and how much of the fragment hides what is behind.
    pub emissive: [f32; 4],
    /// What a normal map says: how far to the right, up and out of the surface; and 1. Nothing of what has none.
    pub mapped: [f32; 4],
    /// Unit vectors that the map leans along. Behind the first one stands the smallest squared distance that an inverse-square light is
    /// divided by.
    pub right: [f32; 4],
    pub up: [f32; 4],
}

impl MaterialSample {
    /// Of what has no material of its own.
    #[inline(always)]
    pub(super) fn plain(params: &InstanceParams) -> Self {
        Self {
            specular: params.specular.extend(params.shininess).to_array(),
            emissive: [0.0, 0.0, 0.0, 1.0],
            right: [0.0, 0.0, 0.0, params.least_distance_squared],
            ..Self::default()
        }
    }
}

/// The fragments of one block and layer.
pub(super) struct Fragments {
    pub count: usize,
    /// In the block, and at how many samples of it the fragment is seen.
    pub pixel: Vec<(u8, u8)>,
    pub given: Vec<Fragment>,
    /// Of pictures in which materials differ.
    pub material: Vec<MaterialSample>,
    /// Linear, from 0 to 1, and 1; where materials differ premultiplied, and their opacity.
    pub color: Vec<[f32; 4]>,
}

impl Fragments {
    /// Of a block whose pixels show as many triangles as they have samples.
    pub(super) const MOST: usize = super::samples::BLOCK_PIXELS * 4;

    pub(super) fn add(&mut self, pixel: usize, samples: usize, fragment: Fragment) {
        self.pixel[self.count] = (pixel as u8, samples as u8);
        self.given[self.count] = fragment;
        self.count += 1;
    }

    pub(super) fn add_with_material(
        &mut self,
        pixel: usize,
        samples: usize,
        (fragment, material): (Fragment, MaterialSample),
    ) {
        if self.material.is_empty() {
            // Most pictures need none.
            self.material.resize(Self::MOST, MaterialSample::default());
        }
        self.material[self.count] = material;
        self.add(pixel, samples, fragment);
    }
}

impl Default for Fragments {
    fn default() -> Self {
        Self {
            count: 0,
            pixel: vec![(0, 0); Self::MOST],
            given: vec![Fragment::default(); Self::MOST],
            material: Vec::new(),
            color: vec![[0.0; 4]; Self::MOST],
        }
    }
}

/// Colors all fragments. `HAS_MATERIALS`: each has a material; otherwise that of all is the one of `plain`.
#[inline(always)]
pub(super) fn shade<S: Simd, const HAS_MATERIALS: bool>(
    simd: S,
    view: &View,
    plain: &InstanceParams,
    fragments: &mut Fragments,
) {
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
        let is_lit = is_lit.simd_gt(0.0);
        let colors = if HAS_MATERIALS {
            let material = &fragments.material.as_chunks::<LANES>().0[group];
            let material = SampleLanes::load(simd, material);
            let lit = blinn_phong(simd, view, position, normal, diffuse, &material);
            let alpha = material.alpha;
            rows_of([
                is_lit.select(lit.x, saturate(red)) * alpha,
                is_lit.select(lit.y, saturate(green)) * alpha,
                is_lit.select(lit.z, saturate(blue)) * alpha,
                alpha,
            ])
        } else {
            let lit = blinn_phong(simd, view, position, normal, diffuse, plain);
            rows_of([
                is_lit.select(lit.x, red),
                is_lit.select(lit.y, green),
                is_lit.select(lit.z, blue),
                Lanes::splat(simd, 1.0),
            ])
        };
        let into = &mut fragments.color.as_chunks_mut::<LANES>().0[group];
        for lane in 0..LANES {
            into[lane] = colors[lane].to_array();
        }
    }
}

/// What is lit, beside what it scatters.
trait MaterialTerms<S: Simd> {
    fn has_highlight(&self) -> bool;

    /// As strong as it is by the square of the cosine between normal and halfway.
    fn highlight(&self, cosine_squared: Lanes<S>) -> Lanes<S>;

    /// What so strong a highlight of a light adds.
    fn specular_term(&self, highlight: Lanes<S>, radiance: [f32; 3]) -> Vectors<S>;

    /// Unit normals as a map leans them.
    fn perturbed(&self, normal: Vectors<S>) -> Vectors<S>;

    /// What an inverse-square light at this squared distance is divided by.
    fn at_least(&self, distance_squared: Lanes<S>) -> Lanes<S>;

    /// With what it gives off.
    fn with_emissive(&self, color: Vectors<S>) -> Vectors<S>;
}

/// All of an instance alike.
impl<S: Simd> MaterialTerms<S> for InstanceParams {
    #[inline(always)]
    fn has_highlight(&self) -> bool {
        self.specular.max_element() > 0.0
    }

    #[inline(always)]
    fn highlight(&self, cosine_squared: Lanes<S>) -> Lanes<S> {
        power(cosine_squared, self.shininess * 0.5)
    }

    #[inline(always)]
    fn specular_term(&self, highlight: Lanes<S>, [lr, lg, lb]: [f32; 3]) -> Vectors<S> {
        let [sr, sg, sb] = self.specular.to_array();
        Vectors {
            x: highlight * (sr * lr),
            y: highlight * (sg * lg),
            z: highlight * (sb * lb),
        }
    }

    #[inline(always)]
    fn perturbed(&self, normal: Vectors<S>) -> Vectors<S> {
        normal
    }

    #[inline(always)]
    fn at_least(&self, distance_squared: Lanes<S>) -> Lanes<S> {
        distance_squared.max(self.least_distance_squared)
    }

    #[inline(always)]
    fn with_emissive(&self, color: Vectors<S>) -> Vectors<S> {
        color
    }
}

/// Of as many fragments as there are lanes.
struct SampleLanes<S: Simd> {
    specular: Vectors<S>,
    shininess: Lanes<S>,
    emissive: Vectors<S>,
    alpha: Lanes<S>,
    mapped: Vectors<S>,
    is_mapped: Lanes<S>,
    right: Vectors<S>,
    up: Vectors<S>,
    least_distance_squared: Lanes<S>,
}

impl<S: Simd> SampleLanes<S> {
    #[inline(always)]
    fn load(simd: S, material: &[MaterialSample; LANES]) -> Self {
        let mut rows = [[f32x4::splat(simd, 0.0); LANES]; 5];
        for lane in 0..LANES {
            rows[0][lane] = f32x4::load_array(simd, material[lane].specular);
            rows[1][lane] = f32x4::load_array(simd, material[lane].emissive);
            rows[2][lane] = f32x4::load_array(simd, material[lane].mapped);
            rows[3][lane] = f32x4::load_array(simd, material[lane].right);
            rows[4][lane] = f32x4::load_array(simd, material[lane].up);
        }
        let (specular, shininess) = vectors(transposed(rows[0]));
        let (emissive, alpha) = vectors(transposed(rows[1]));
        let (mapped, is_mapped) = vectors(transposed(rows[2]));
        let (right, least_distance_squared) = vectors(transposed(rows[3]));
        Self {
            specular,
            shininess,
            emissive,
            alpha,
            mapped,
            is_mapped,
            right,
            up: vectors(transposed(rows[4])).0,
            least_distance_squared,
        }
    }
}

#[inline(always)]
fn vectors<S: Simd>([x, y, z, w]: [Lanes<S>; 4]) -> (Vectors<S>, Lanes<S>) {
    (Vectors { x, y, z }, w)
}

impl<S: Simd> MaterialTerms<S> for SampleLanes<S> {
    #[inline(always)]
    fn has_highlight(&self) -> bool {
        let Vectors { x, y, z } = self.specular;
        (x.simd_gt(0.0) | y.simd_gt(0.0) | z.simd_gt(0.0)).any_true()
    }

    #[inline(always)]
    fn highlight(&self, cosine_squared: Lanes<S>) -> Lanes<S> {
        powers(cosine_squared, self.shininess * 0.5)
    }

    #[inline(always)]
    fn specular_term(&self, highlight: Lanes<S>, [lr, lg, lb]: [f32; 3]) -> Vectors<S> {
        Vectors {
            x: highlight * (self.specular.x * lr),
            y: highlight * (self.specular.y * lg),
            z: highlight * (self.specular.z * lb),
        }
    }

    #[inline(always)]
    fn perturbed(&self, normal: Vectors<S>) -> Vectors<S> {
        let is_mapped = self.is_mapped.simd_gt(0.0);
        if !is_mapped.any_true() {
            return normal;
        }
        let right = across(self.right, normal).times(self.mapped.x);
        let up = across(self.up, normal).times(self.mapped.y);
        let out = normal.times(self.mapped.z);
        let leaning = right.plus(up).plus(out).unit_or(normal);
        Vectors {
            x: is_mapped.select(leaning.x, normal.x),
            y: is_mapped.select(leaning.y, normal.y),
            z: is_mapped.select(leaning.z, normal.z),
        }
    }

    #[inline(always)]
    fn at_least(&self, distance_squared: Lanes<S>) -> Lanes<S> {
        distance_squared.max(self.least_distance_squared)
    }

    #[inline(always)]
    fn with_emissive(&self, color: Vectors<S>) -> Vectors<S> {
        color.plus(self.emissive)
    }
}

/// What of a direction is perpendicular to a normal, of unit length; nothing of one along it.
#[inline(always)]
fn across<S: Simd>(direction: Vectors<S>, normal: Vectors<S>) -> Vectors<S> {
    let nothing = Vectors::splat(direction.x.token(), [0.0; 3]);
    let along = normal.times(normal.dot(direction));
    direction.minus(along).unit_or(nothing)
}

/// `ambient · diffuse + Σ radiance · (diffuse · max(n·l, 0) + [n·l > 0] · specular · max(n·h, 0)^shininess) + emissive`, clamped.
#[inline(always)]
fn blinn_phong<S: Simd, F: MaterialTerms<S>>(
    simd: S,
    view: &View,
    position: Vectors<S>,
    normal: Vectors<S>,
    diffuse: Vectors<S>,
    material: &F,
) -> Vectors<S> {
    let zero = Lanes::splat(simd, 0.0);
    let nothing = Vectors::splat(simd, [0.0; 3]);
    let toward_eye = toward(view.eye_in_world, position).unit_or(nothing);
    // A surface without a normal faces the eye.
    let normal = material.perturbed(normal.unit_or(toward_eye));
    let has_highlight = material.has_highlight();
    let [ar, ag, ab] = view.ambient.to_array();
    let mut color = Vectors {
        x: diffuse.x * ar,
        y: diffuse.y * ag,
        z: diffuse.z * ab,
    };
    for light in view.lights() {
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
            1.0 / material.at_least(distance_squared)
        } else {
            Lanes::splat(simd, 1.0)
        };
        let [cx, cy, cz, offset] = light.cone.to_array();
        let strength = if [cx, cy, cz] == [0.0; 3] {
            strength
        } else {
            let inside = saturate(l.dot(Vectors::splat(simd, [cx, cy, cz])) + offset);
            strength * (inside * inside)
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
            let highlight = material.highlight(cosine_squared) * strength;
            color = color.plus(material.specular_term(highlight, [lr, lg, lb]));
        }
    }
    let color = material.with_emissive(color);
    Vectors {
        x: saturate(color.x),
        y: saturate(color.y),
        z: saturate(color.z),
    }
}

/// From positions to a homogeneous point, or along it where it is infinitely far.
#[inline(always)]
fn toward<S: Simd>(point: Vec4, position: Vectors<S>) -> Vectors<S> {
    let simd = position.x.token();
    let [x, y, z, w] = point.to_array();
    Vectors::splat(simd, [x, y, z]).minus(position.times(Lanes::splat(simd, w)))
}
