//! What came out of a renderer: pixels and vertices, not yet encoded.

use crate::scene::Size;

/// A picture: RGBA8, sRGB, straight alpha, rows from the top, no padding.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    pub size: Size,
    /// `4 * width * height` bytes.
    pub pixels: Vec<u8>,
}

/// Skinned vertices of one mesh, or of a range of it, in the file's own order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SkinnedVertices {
    pub vertex_count: usize,
    /// `3 * vertex_count` numbers in world space, where asked for.
    pub positions: Option<Vec<f32>>,
    /// `3 * vertex_count` numbers, unit length, where asked for.
    pub normals: Option<Vec<f32>>,
}
