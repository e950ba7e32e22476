//! What a mesh is made of, as far as a file says.

use std::sync::Arc;

/// A named surface. Colors and shininess are the frame request's: none of the formats read so far gives any.
#[derive(Debug, Clone)]
pub struct Material {
    pub name: String,
    pub texture: Option<Texture>,
}

/// A picture as the file has it, still encoded.
#[derive(Debug, Clone)]
pub struct Texture {
    /// The name by which the rig's file calls it.
    pub file: String,
    pub encoded: Arc<[u8]>,
}
