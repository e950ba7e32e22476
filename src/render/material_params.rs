//! The material of a part of a mesh, as numbers of 32 bits, which both renderers read: a file's material and what a frame request says
//! instead. It mirrors `MaterialParams` in `shaders/material.wgsl`; a test beside the other mirrors compares every offset.

use crate::rig::{Material, Mesh, Opacity, Part, TextureTransform, Wrap};
use crate::scene::{Color, Surface};
use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

/// Colors are linear RGB.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct MaterialParams {
    /// What is scattered, and opacity: before texture and vertex color.
    pub color: Vec4,
    pub specular: Vec3,
    pub shininess: f32,
    pub emissive: Vec3,
    /// Nothing is there where alpha is less. 0 leaves everything there.
    pub least_alpha: f32,
    /// Rows of the affine map from (u, 1 − v, 1) to a place on the texture of the color, of what is emitted, of normals.
    pub color_place: [Vec4; 2],
    pub emissive_place: [Vec4; 2],
    pub normal_place: [Vec4; 2],
    pub normal_scale: f32,
    /// 1: alpha lets through what is behind.
    pub is_translucent: u32,
    /// 0: shown as it is, whatever light falls on it.
    pub is_lit: u32,
    /// 1: lit by each triangle's own normal.
    pub is_flat: u32,
}

impl MaterialParams {
    /// `None` where the frame request's own surface, and perhaps a texture that is repeated as texture coordinates have it, say it all.
    pub(super) fn of(
        mesh: &Mesh,
        part: &Part,
        material: Option<&Material>,
        surface: &Surface,
    ) -> Option<Self> {
        let is_plain = mesh.colors().is_none() && !part.is_flat && material.is_none_or(is_plain);
        if is_plain {
            return None;
        }
        let unnamed = Material::named(String::new());
        let material = material.unwrap_or(&unnamed);
        let given = surface.diffuse.map(Color::rgb);
        let own = material.color.unwrap_or_else(|| {
            let is_colored = material.texture.is_some() || mesh.colors().is_some();
            let color = if is_colored {
                Color::WHITE
            } else {
                Surface::DIFFUSE
            };
            color.rgb().extend(1.0)
        });
        let highlight = material.highlight.as_ref();
        let place = |place: Option<&crate::rig::TexturePlace>| {
            rows(place.map_or(TextureTransform::IDENTITY, |it| it.picture_from_texcoord))
        };
        let normal_map = material.normal_map.as_ref();
        Some(Self {
            color: given.unwrap_or(own.truncate()).extend(own.w),
            specular: surface.specular.map(Color::rgb).unwrap_or_else(|| {
                highlight.map_or(Surface::SPECULAR.rgb(), |highlight| highlight.specular)
            }),
            shininess: surface.shininess.unwrap_or_else(|| {
                highlight.map_or(Surface::SHININESS, |highlight| highlight.shininess)
            }),
            emissive: material.emissive,
            least_alpha: match material.opacity {
                Opacity::Mask(least) => least,
                Opacity::Opaque | Opacity::Blend => 0.0,
            },
            color_place: place(material.texture.as_ref()),
            emissive_place: place(material.emissive_texture.as_ref()),
            normal_place: place(normal_map.map(|map| &map.place)),
            normal_scale: normal_map.map_or(0.0, |map| map.scale),
            is_translucent: u32::from(material.opacity == Opacity::Blend),
            is_lit: u32::from(!material.is_unlit),
            is_flat: u32::from(part.is_flat),
        })
    }
}

fn is_plain(material: &Material) -> bool {
    let is_laid_plainly = material.texture.as_ref().is_none_or(|place| {
        place.wrap == [Wrap::Repeat; 2] && place.picture_from_texcoord == TextureTransform::IDENTITY
    });
    material.color.is_none()
        && material.highlight.is_none()
        && material.emissive == Vec3::ZERO
        && material.normal_map.is_none()
        && material.opacity == Opacity::Opaque
        && !material.is_unlit
        && is_laid_plainly
}

fn rows(transform: TextureTransform) -> [Vec4; 2] {
    let TextureTransform {
        columns: [u, v],
        offset,
    } = transform;
    [
        Vec4::new(u.x, v.x, offset.x, 0.0),
        Vec4::new(u.y, v.y, offset.y, 0.0),
    ]
}
