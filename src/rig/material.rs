//! What a mesh is made of, as far as a file says.

use super::Texture;
use std::sync::Arc;

/// A named surface. Colors and shininess are the frame request's: none of the formats read so far gives any.
#[derive(Debug, Clone)]
pub struct Material {
    pub name: String,
    /// Multiplies the diffuse color.
    pub texture: Option<Arc<Texture>>,
}
