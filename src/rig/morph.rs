//! Morph targets: what they are called here, what they do to each vertex beside [`Mesh`](super::Mesh).

use glam::Vec3;

/// A shape that a mesh can be pulled towards, by a DOF of its own.
#[derive(Debug, Clone)]
pub struct Morph {
    /// Unique in its rig.
    pub name: String,
    /// Index into [`Rig::meshes`](super::Rig::meshes).
    pub mesh: usize,
    /// Vertices that it moves or turns.
    pub vertex_count: usize,
    /// Weight in the file's own pose.
    pub rest: f64,
}

/// What a morph target at weight 1 adds to one vertex, in bind space.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct MorphDisplacement {
    /// Index into [`Rig::morphs`](super::Rig::morphs).
    pub morph: u32,
    /// Added to the vertex's position, in the rig's units.
    pub position: Vec3,
    /// Added to the unit normal.
    pub normal: Vec3,
}
