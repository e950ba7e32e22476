//! Which vertices of a rig to ask for, and in which form.

/// Which form of a rig's skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Posed,
    /// As it was modelled, whatever the pose.
    Bind,
}

/// A range of one mesh's vertices, inside the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VertexQuery {
    pub mesh: usize,
    pub start: usize,
    pub count: usize,
    pub positions: bool,
    pub normals: bool,
}
