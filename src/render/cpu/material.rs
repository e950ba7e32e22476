//! Parts of meshes whose material has parameters of its own: what it is at a pixel. In parity with `shaders/material.wgsl`. Never lives here: light.

use super::interpolate::{Plane, Planes};
use super::shade::{Fragment, MaterialSample};
use super::texture;
use super::triangle::{Corner, Slope};
use crate::render::instance_params::InstanceParams;
use crate::render::material_params::MaterialParams;
use crate::rig::{Material, Mesh, Part, Rig, TexturePlace};
use crate::scene::Surface;
use fearless_simd::prelude::*;
use glam::{Vec2, Vec3, Vec4};

/// The material of a part, and what its vertices have.
#[derive(Clone, Copy)]
pub(super) struct PartMaterial<'a> {
    pub params: MaterialParams,
    material: Option<&'a Material>,
    /// One for each vertex of the mesh, as the colors are. Without them, texture coordinates are 0.
    pub texcoords: Option<&'a [Vec2]>,
    /// Without them, white.
    pub colors: Option<&'a [Vec4]>,
}

/// A triangle of one, ready to be looked up.
#[derive(Clone, Copy)]
pub(super) struct MaterialTriangle {
    /// Which of the picture's [`PartMaterial`] it is of.
    pub material: u32,
    /// The vertex color over w.
    color: Plane,
    /// In its plane, in which the place on the normal map moves to the right and up, of unit length; none where it does not move, or where
    /// no normal is mapped.
    tangents: Option<[Vec3; 2]>,
}

impl<'a> PartMaterial<'a> {
    /// `None` of a part that has none.
    pub(super) fn of(rig: &'a Rig, mesh: &'a Mesh, part: &Part, surface: &Surface) -> Option<Self> {
        let material = rig.material_of(part, surface.variant);
        Some(Self {
            params: MaterialParams::of(mesh, part, material, surface)?,
            material,
            texcoords: mesh.texcoords(),
            colors: mesh.colors(),
        })
    }

    fn texture(&self) -> Option<&'a TexturePlace> {
        self.material?.texture.as_ref()
    }

    fn emissive_texture(&self) -> Option<&'a TexturePlace> {
        self.material?.emissive_texture.as_ref()
    }

    fn normal_map(&self) -> Option<&'a TexturePlace> {
        self.material?.normal_map.as_ref().map(|map| &map.place)
    }

    /// Whether there are pixels that triangles cover and leave out.
    pub(super) fn has_holes(&self) -> bool {
        self.params.least_alpha > 0.0
    }

    /// Color and opacity of the material where its texture and its vertices have these.
    #[inline(always)]
    fn color<S: Simd>(&self, simd: S, texcoords: &Texcoords, vertex: [f32; 4]) -> [f32; 4] {
        let own = self.params.color.to_array();
        let texel = match self.texture() {
            Some(laid) => sample_transformed(simd, laid, &self.params.color_place, texcoords),
            None => [1.0; 4],
        };
        [0, 1, 2, 3].map(|channel| own[channel] * texel[channel] * vertex[channel])
    }

    /// Opacity in the middle of a pixel.
    #[inline(always)]
    pub(super) fn alpha<S: Simd>(
        &self,
        simd: S,
        [texcoord, color]: [&Plane; 2],
        origin: [f32; 2],
        pixel: [f32; 2],
    ) -> f32 {
        let texcoords = Texcoords::around(simd, texcoord, origin, pixel);
        let middle = middle(origin, pixel);
        let vertex = self.vertex_color(simd, color, middle, texcoords.inverse_w);
        self.color(simd, &texcoords, vertex)[3]
    }

    /// Held to 0..1; `from_origin` in pixels.
    #[inline(always)]
    fn vertex_color<S: Simd>(
        &self,
        simd: S,
        color: &Plane,
        from_origin: [f32; 2],
        inverse_w: f32,
    ) -> [f32; 4] {
        match self.colors {
            Some(_) => {
                let over_w = color.at(simd, from_origin).to_array();
                over_w.map(|channel| saturate(channel / inverse_w))
            }
            None => [1.0; 4],
        }
    }
}

impl MaterialTriangle {
    /// `is_bare`: lit by its own normal, whatever a map says.
    #[inline(always)]
    pub(super) fn of<S: Simd>(
        simd: S,
        material: u32,
        of: &PartMaterial<'_>,
        corners: &[Corner; 3],
        is_bare: bool,
    ) -> Self {
        let slope = Slope::of(corners.map(|corner| corner.projected));
        let is_mapped = !is_bare && of.normal_map().is_some() && of.params.normal_scale != 0.0;
        Self {
            material,
            color: Plane::of_colors(simd, &slope, corners),
            tangents: is_mapped
                .then(|| tangents(corners, &of.params.normal_place))
                .flatten(),
        }
    }

    /// What the triangle shows of a pixel: its base color and place, and the rest of the material. `from_origin` is where it is shaded, in pixels.
    #[inline(always)]
    pub(super) fn shown<S: Simd>(
        &self,
        simd: S,
        of: &PartMaterial<'_>,
        planes: &Planes,
        from_origin: [f32; 2],
        pixel: [f32; 2],
        instance: &InstanceParams,
    ) -> (Fragment, MaterialSample) {
        let params = &of.params;
        let texcoords = Texcoords::around(simd, &planes.texcoord, planes.origin, pixel);
        let normal = planes.normal.at(simd, from_origin).to_array();
        // A mask leaves out whole pixels, so alpha is that of their middles, whatever it is for.
        let [r, g, b, _] = of.vertex_color(simd, &self.color, from_origin, normal[3]);
        let middle = middle(planes.origin, pixel);
        let alpha = of.vertex_color(simd, &self.color, middle, texcoords.inverse_w)[3];
        let [r, g, b, alpha] = of.color(simd, &texcoords, [r, g, b, alpha]);
        let fragment = Fragment {
            normal,
            position: planes.position.at(simd, from_origin).to_array(),
            diffuse: [r, g, b, params.is_lit as f32],
        };
        let emissive = match of.emissive_texture() {
            Some(laid) => {
                let [r, g, b, _] =
                    sample_transformed(simd, laid, &params.emissive_place, &texcoords);
                params.emissive * Vec3::new(r, g, b)
            }
            None => params.emissive,
        };
        let alpha = if params.is_translucent == 1 {
            saturate(alpha)
        } else {
            1.0
        };
        let mut material = MaterialSample {
            specular: params.specular.extend(params.shininess).to_array(),
            emissive: emissive.extend(alpha).to_array(),
            right: [0.0, 0.0, 0.0, instance.least_distance_squared],
            ..MaterialSample::default()
        };
        if let (Some([right, up]), Some(map)) = (self.tangents, of.normal_map()) {
            let [x, y, z, _] = sample_transformed(simd, map, &params.normal_place, &texcoords);
            let [x, y, z] = [x, y, z].map(|number| 2.0 * number - 1.0);
            material.mapped = [x * params.normal_scale, y * params.normal_scale, z, 1.0];
            material.right = right.extend(instance.least_distance_squared).to_array();
            material.up = up.extend(0.0).to_array();
        }
        (fragment, material)
    }
}

/// Texture coordinates in the middles of a pixel and of two others of its square of four.
pub(super) struct Texcoords {
    pub here: [f32; 2],
    pub beside: [f32; 2],
    pub below: [f32; 2],
    /// Here.
    inverse_w: f32,
}

impl Texcoords {
    /// Inside the triangle or beside it. `origin` is where `plane` starts.
    #[inline(always)]
    pub(super) fn around<S: Simd>(
        simd: S,
        plane: &Plane,
        origin: [f32; 2],
        pixel: [f32; 2],
    ) -> Self {
        let [x, y] = pixel;
        let (here, inverse_w) = texcoord(simd, plane, origin, pixel);
        Self {
            here,
            beside: texcoord(simd, plane, origin, [neighbour(x), y]).0,
            below: texcoord(simd, plane, origin, [x, neighbour(y)]).0,
            inverse_w,
        }
    }
}

/// In the middle of a pixel, with 1 / w.
#[inline(always)]
fn texcoord<S: Simd>(simd: S, plane: &Plane, origin: [f32; 2], pixel: [f32; 2]) -> ([f32; 2], f32) {
    let [u, v, inverse_w, _] = plane.at(simd, middle(origin, pixel)).to_array();
    ([u / inverse_w, v / inverse_w], inverse_w)
}

/// Of a pixel, from `origin`.
#[inline(always)]
fn middle(origin: [f32; 2], [x, y]: [f32; 2]) -> [f32; 2] {
    [x + 0.5 - origin[0], y + 0.5 - origin[1]]
}

/// The other one of its pair.
fn neighbour(pixel: f32) -> f32 {
    (pixel as u32 ^ 1) as f32
}

/// What a texture has at a pixel, where `rows` lay it.
#[inline(always)]
fn sample_transformed<S: Simd>(
    simd: S,
    laid: &TexturePlace,
    rows: &[Vec4; 2],
    texcoords: &Texcoords,
) -> [f32; 4] {
    let here = place(rows, texcoords.here);
    let beside = place(rows, texcoords.beside);
    let below = place(rows, texcoords.below);
    let by_x = [beside[0] - here[0], beside[1] - here[1]];
    let by_y = [below[0] - here[0], below[1] - here[1]];
    texture::sample_wrapped(simd, laid, here, by_x, by_y)
}

/// On a picture, from its upper left corner.
#[inline(always)]
fn place(rows: &[Vec4; 2], [u, v]: [f32; 2]) -> [f32; 2] {
    let down = 1.0 - v;
    rows.map(|row| row.x * u + row.y * down + row.z)
}

/// The directions in a triangle's plane in which the place on a picture moves to the right and up.
fn tangents(corners: &[Corner; 3], rows: &[Vec4; 2]) -> Option<[Vec3; 2]> {
    let at = corners.map(|corner| place(rows, corner.texcoord));
    let [from, one, other] = corners.map(|corner| Vec3::from_array(corner.position));
    let (one, other) = (one - from, other - from);
    // The picture's rows run downward.
    let moved = |to: [f32; 2]| [to[0] - at[0][0], at[0][1] - to[1]];
    let ([one_right, one_up], [other_right, other_up]) = (moved(at[1]), moved(at[2]));
    let area = one_right * other_up - other_right * one_up;
    // Places on a line still tremble by some steps of float32.
    let furthest = |numbers: &[f32]| {
        let of_each = numbers.iter().map(|number| number.abs());
        of_each.fold(0.0, f32::max)
    };
    let moved = furthest(&[one_right, one_up, other_right, other_up]);
    if area.abs() <= 1e-6 * furthest(at.as_flattened()) * moved || !area.is_finite() {
        return None;
    }
    let sign = 1f32.copysign(area);
    let right = (one * other_up - other * one_up) * sign;
    let up = (other * one_right - one * other_right) * sign;
    Some([right, up].map(|direction| direction.normalize_or_zero()))
}

/// Between 0 and 1; 0 of what is no number.
fn saturate(number: f32) -> f32 {
    if number > 0.0 { number.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::tests::levels;
    use super::super::{Cores, Cpu, Parallelism};
    use crate::limits::Limits;
    use crate::pose::{Pose, Posed, Skinning};
    use crate::random::Random;
    use crate::render::Plan;
    use crate::rig::{
        Draft, Encoding, Material, MeshDraft, NormalMap, Opacity, PartDraft, Texture, TextureLevel,
        TexturePlace, Wrap,
    };
    use crate::scene::{
        Appearance, Background, Bounds, Camera, Color, Light, Orbit, Samples, Scene, Size,
    };
    use glam::{DVec3, Vec2, Vec3, Vec4};
    use std::sync::Arc;

    /// Random triangles of masked, blending, bumpy and plain parts, some of which reach behind the eye.
    fn tangle(samples: Samples) -> Plan {
        let mut random = Random(9);
        let mut texture = |encoding| {
            let texels = (0..64).map(|_| [0; 4].map(|_| (255.0 * random.unit()) as u8));
            let (width, height) = (8, 8);
            let texels = texels.collect();
            let level = TextureLevel {
                width,
                height,
                texels,
            };
            TexturePlace {
                wrap: [Wrap::Mirror, Wrap::Clamp],
                ..TexturePlace::plain(Arc::new(Texture::new(String::new(), encoding, level)))
            }
        };
        let named = || Material::named(String::new());
        let picture = texture(Encoding::Srgb);
        let place = texture(Encoding::Linear);
        let materials = vec![
            Material {
                texture: Some(picture.clone()),
                opacity: Opacity::Mask(0.3),
                ..named()
            },
            Material {
                texture: Some(picture.clone()),
                opacity: Opacity::Blend,
                ..named()
            },
            Material {
                normal_map: Some(NormalMap { place, scale: 1.0 }),
                emissive: Vec3::splat(0.1),
                emissive_texture: Some(picture),
                ..named()
            },
            named(),
        ];
        let count = 60 * materials.len();
        let mut vectors = |length: usize| -> Vec<Vec3> {
            let vector = |_| Vec3::from_array([0; 3].map(|_| random.within(1.0) as f32));
            (0..length).map(vector).collect()
        };
        let corners = 3 * count;
        let part = |material| PartDraft {
            triangle_count: 60,
            material: Some(material),
            is_flat: false,
        };
        let colors = vectors(corners);
        let mesh = MeshDraft {
            positions: vectors(corners),
            texcoords: Some(
                vectors(corners)
                    .iter()
                    .map(|it| Vec2::new(it.x, it.y))
                    .collect(),
            ),
            colors: Some(
                colors
                    .iter()
                    .map(|it| Vec4::new(1.0, it.x, it.y, 0.5 + it.z))
                    .collect(),
            ),
            triangles: (0..count as u32)
                .map(|at| [3 * at, 3 * at + 1, 3 * at + 2])
                .collect(),
            parts: (0..materials.len()).map(part).collect(),
            ..MeshDraft::default()
        };
        let draft = Draft {
            meshes: vec![mesh],
            materials,
            ..Draft::default()
        };
        let rig = Arc::new(draft.build(&Limits::default()).unwrap());
        let posed = Arc::new(Posed::new(&Pose::rest(&rig)).unwrap());
        let size = Size {
            width: 203,
            height: 117,
        };
        let bounds = Bounds {
            min: DVec3::splat(-0.4),
            max: DVec3::splat(0.4),
        };
        let scene = Scene {
            size,
            samples,
            camera: Camera::orbit(Orbit::default(), &bounds, size).unwrap(),
            lights: Light::default_pair(),
            ambient: Color::WHITE,
            background: Background::default(),
        };
        Plan::picture(posed, Skinning::Linear, Appearance::default(), scene, 1.0)
    }

    #[test]
    fn materials_are_the_same_on_every_vector_unit() {
        for samples in [Samples::One, Samples::Four] {
            let plan = tangle(samples);
            let draw = |cpu: Cpu| cpu.render(&plan, Parallelism::uncancelled(Cores::One));
            let wanted = draw(Cpu::default());
            assert!(wanted.is_some());
            for level in levels() {
                assert!(draw(Cpu::with(level)) == wanted, "{samples:?}, {level:?}");
            }
        }
    }
}
