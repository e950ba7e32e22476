//! What came out of a renderer: rasters and vertices, not yet encoded. The table of [kinds](ImageKind) says what a pixel of each is.

mod pool;

pub use pool::{Pool, Pooled};

use crate::scene::{Bounds, Size};

/// What the pixels of a raster tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ImageKind {
    /// The lit picture.
    Color,
}

/// How a pixel is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TexelFormat {
    /// Red, green, blue and alpha, a byte each: sRGB, straight alpha.
    Rgba8Srgb,
}

impl ImageKind {
    /// How the pixels of a raster of this kind are stored.
    pub fn texel_format(self) -> TexelFormat {
        match self {
            Self::Color => TexelFormat::Rgba8Srgb,
        }
    }

    /// Of a raster of this kind.
    pub fn bytes(self, size: Size) -> usize {
        self.texel_format().bytes() * size.pixels()
    }
}

impl TexelFormat {
    /// Of one pixel.
    pub fn bytes(self) -> usize {
        match self {
            Self::Rgba8Srgb => 4,
        }
    }
}

/// One value for each pixel of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// What its pixels tell, and so how they are stored.
    pub kind: ImageKind,
    /// In pixels.
    pub size: Size,
    /// [As many](ImageKind::bytes) as the kind takes: rows from the top, without padding.
    pub bytes: Pooled<Vec<u8>>,
}

/// What a plan came to: all that it asked for, and nothing else.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outputs {
    /// One for each kind that was asked for, in the order of the kinds.
    pub images: Vec<Raster>,
    /// One for each query, in their order.
    pub vertices: Vec<SkinnedVertices>,
}

/// Skinned vertices of one mesh, or of a range of it, in the file's own order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SkinnedVertices {
    /// Vertices of the mesh or of the range that was asked for.
    pub vertex_count: usize,
    /// `3 * vertex_count` numbers in model space, where asked for.
    pub positions: Option<Pooled<Vec<f32>>>,
    /// `3 * vertex_count` numbers in model space, of unit length, where asked for.
    pub normals: Option<Pooled<Vec<f32>>>,
}

impl SkinnedVertices {
    /// Of the positions. `None` where there are none.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of_positions(self.positions.as_ref()?)
    }
}
