//! What a mesh is made of, as far as a file says. Never lives here: what a frame request says instead, and light.

use super::Texture;
use glam::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// A named surface. A color or number that is `None` is the frame request's.
#[derive(Debug, Clone)]
pub struct Material {
    /// Unique in a built rig; empty in a draft where the file gives none.
    pub name: String,
    /// Linear RGB and opacity.
    pub color: Option<Vec4>,
    /// Multiplies the color.
    pub texture: Option<TexturePlace>,
    /// What it mirrors of lights.
    pub highlight: Option<Highlight>,
    /// Linear RGB that it gives off by itself.
    pub emissive: Vec3,
    /// Multiplies `emissive`.
    pub emissive_texture: Option<TexturePlace>,
    /// Bends the normals that it is lit by; `None` leaves those of the vertices.
    pub normal_map: Option<NormalMap>,
    /// Whether and where it lets through what is behind it.
    pub opacity: Opacity,
    /// Whether it is seen from the front alone, the side from which the file winds triangles counter-clockwise.
    pub is_single_sided: bool,
    /// Shown as it is, whatever light falls on it.
    pub is_unlit: bool,
}

/// The mirror-like part of Blinn-Phong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Highlight {
    /// Linear RGB, each channel 0..1.
    pub specular: Vec3,
    /// The exponent on n·h.
    pub shininess: f32,
}

/// A texture and how it lies on a surface.
#[derive(Debug, Clone)]
pub struct TexturePlace {
    /// Shared where several places show the same texels.
    pub texture: Arc<Texture>,
    /// What happens beyond its left and right edges, and beyond its upper and lower ones.
    pub wrap: [Wrap; 2],
    /// Of a point (u, 1 − v), from the picture's upper left corner to its lower right one at (1, 1).
    pub picture_from_texcoord: TextureTransform,
}

/// An affine map of texture coordinates: the columns of its matrix, and what is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureTransform {
    /// What one unit of u and of v comes to.
    pub columns: [Vec2; 2],
    /// Where (0, 0) comes to lie.
    pub offset: Vec2,
}

/// What lies beyond the edges of a texture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Wrap {
    /// The texture again, as often as it takes.
    #[default]
    Repeat,
    /// Again, every other time mirrored.
    Mirror,
    /// The texels at its edge.
    Clamp,
}

/// Directions in tangent space: red to the right of the picture, green up, blue out of the surface.
#[derive(Debug, Clone)]
pub struct NormalMap {
    /// The picture that holds the directions, read as numbers and not as colors.
    pub place: TexturePlace,
    /// Multiplies what leans to the right and up.
    pub scale: f32,
}

/// What becomes of the alpha of color and texture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Opacity {
    /// It counts for nothing.
    #[default]
    Opaque,
    /// Nothing is there where it is less than this, and all is opaque elsewhere.
    Mask(f32),
    /// It lets through what is behind.
    Blend,
}

impl Material {
    /// One of which only the name is known.
    pub fn named(name: String) -> Self {
        Self {
            name,
            color: None,
            texture: None,
            highlight: None,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            normal_map: None,
            opacity: Opacity::Opaque,
            is_single_sided: false,
            is_unlit: false,
        }
    }

    /// All that it wears.
    pub fn textures(&self) -> impl Iterator<Item = &TexturePlace> {
        let of_normals = self.normal_map.as_ref().map(|map| &map.place);
        [
            self.texture.as_ref(),
            self.emissive_texture.as_ref(),
            of_normals,
        ]
        .into_iter()
        .flatten()
    }
}

impl TexturePlace {
    /// As texture coordinates have it, over and over.
    pub fn plain(texture: Arc<Texture>) -> Self {
        Self {
            texture,
            wrap: [Wrap::Repeat; 2],
            picture_from_texcoord: TextureTransform::IDENTITY,
        }
    }
}

impl TextureTransform {
    /// Leaves every point where it is.
    pub const IDENTITY: Self = Self {
        columns: [Vec2::X, Vec2::Y],
        offset: Vec2::ZERO,
    };
}
