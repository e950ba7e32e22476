//! Surfaces in bind space and what they are bound to.

use super::MorphDisplacement;
use glam::{DAffine3, Vec2, Vec3};

/// What a vertex can be bound to: a joint as it stood when the mesh was bound, or the world itself.
#[derive(Debug, Clone, Copy)]
pub struct Binding {
    /// `None` leaves what is bound to it where it was modelled.
    pub joint: Option<usize>,
    /// The inverse bind matrix.
    pub joint_from_bind: DAffine3,
}

impl Binding {
    pub const WORLD: Self = Self {
        joint: None,
        joint_from_bind: DAffine3::IDENTITY,
    };
}

/// A share of a vertex that follows one binding.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Influence {
    /// Index into [`Rig::bindings`](super::Rig::bindings).
    pub binding: u32,
    /// Weights of one vertex sum to 1.
    pub weight: f32,
}

/// Where in bind space the vertices are that follow one binding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Followers {
    /// Index into [`Rig::bindings`](super::Rig::bindings).
    pub binding: u32,
    pub min: Vec3,
    pub max: Vec3,
}

/// A triangle mesh in bind space, vertices in the file's own order.
#[derive(Debug)]
pub struct Mesh {
    pub(super) name: String,
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) texcoords: Option<Vec<Vec2>>,
    pub(super) influence_starts: Vec<u32>,
    pub(super) influences: Vec<Influence>,
    pub(super) morph_starts: Vec<u32>,
    pub(super) morph_displacements: Vec<MorphDisplacement>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) draw_triangles: Vec<[u32; 3]>,
    pub(super) material: Option<usize>,
    pub(super) outward_count: Option<usize>,
    pub(super) has_negative_weights: bool,
    pub(super) followers: Vec<Followers>,
    pub(super) morph_reach: Vec<(usize, f32)>,
}

impl Mesh {
    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Unit length, one per vertex.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// One per vertex; `v` is 0 at the bottom of the picture.
    pub fn texcoords(&self) -> Option<&[Vec2]> {
        self.texcoords.as_deref()
    }

    /// `vertex_count + 1` indices into [`Mesh::influences`]: those of vertex `v` are `starts[v]..starts[v + 1]`, never empty.
    pub fn influence_starts(&self) -> &[u32] {
        &self.influence_starts
    }

    /// Those of every vertex, one vertex after another; those of one vertex heaviest first, of equal ones the lowest joint first.
    pub fn influences(&self) -> &[Influence] {
        &self.influences
    }

    pub fn influences_of(&self, vertex: usize) -> &[Influence] {
        &self.influences
            [self.influence_starts[vertex] as usize..self.influence_starts[vertex + 1] as usize]
    }

    /// `vertex_count + 1` indices into [`Mesh::morph_displacements`], or none where no morph target moves this mesh.
    pub fn morph_starts(&self) -> &[u32] {
        &self.morph_starts
    }

    /// What morph targets do to every vertex, one vertex after another.
    pub fn morph_displacements(&self) -> &[MorphDisplacement] {
        &self.morph_displacements
    }

    /// What morph targets do to one vertex.
    pub fn morph_displacements_of(&self, vertex: usize) -> &[MorphDisplacement] {
        match self.morph_starts.get(vertex..vertex + 2) {
            Some(&[start, end]) => &self.morph_displacements[start as usize..end as usize],
            _ => &[],
        }
    }

    /// With the file's own winding.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The same triangles, each wound counter-clockwise about its vertices' normals; in another order where the mesh
    /// [is closed](Self::outward_count).
    pub fn draw_triangles(&self) -> &[[u32; 3]] {
        &self.draw_triangles
    }

    /// Index into [`Rig::materials`](super::Rig::materials).
    pub fn material(&self) -> Option<usize> {
        self.material
    }

    /// Of a mesh that encloses a volume, whatever the pose: how many [draw triangles](Self::draw_triangles) are wound counter-clockwise
    /// seen from outside. They come first; the rest are wound counter-clockwise seen from within.
    pub fn outward_count(&self) -> Option<usize> {
        self.outward_count
    }

    /// Where not, a vertex lies between the places that what it follows would put it.
    pub fn has_negative_weights(&self) -> bool {
        self.has_negative_weights
    }

    /// One for each binding that vertices follow, by binding.
    pub fn followers(&self) -> &[Followers] {
        &self.followers
    }

    /// `(index into [`Rig::morphs`](super::Rig::morphs), how far it moves a vertex at the most at weight 1)` of each that moves this mesh.
    pub fn morph_reach(&self) -> &[(usize, f32)] {
        &self.morph_reach
    }

    pub(super) fn memory_bytes(&self) -> usize {
        let texcoords = self
            .texcoords
            .as_ref()
            .map_or(0, |texcoords| size_of_val(texcoords.as_slice()));
        size_of_val(self.positions.as_slice())
            + size_of_val(self.normals.as_slice())
            + texcoords
            + size_of_val(self.influence_starts.as_slice())
            + size_of_val(self.influences.as_slice())
            + size_of_val(self.morph_starts.as_slice())
            + size_of_val(self.morph_displacements.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.draw_triangles.as_slice())
            + size_of_val(self.followers.as_slice())
    }
}
