//! Surfaces in bind space and what they are bound to.

use super::MorphDisplacement;
use glam::{DAffine3, Vec2, Vec3, Vec4};
use std::collections::BTreeMap;
use std::ops::Range;

/// What a vertex can be bound to: a joint in its bind pose, or the world itself.
#[derive(Debug, Clone, Copy)]
pub struct Binding {
    /// `None` leaves what is bound to it where it was modelled.
    pub joint: Option<usize>,
    /// The inverse bind matrix.
    pub joint_from_bind: DAffine3,
}

impl Binding {
    pub(super) const WORLD: Self = Self {
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
pub struct BindingBounds {
    /// Index into [`Rig::bindings`](super::Rig::bindings).
    pub binding: u32,
    /// The smallest coordinates, in the rig's units.
    pub min: Vec3,
    /// The largest coordinates, in the rig's units.
    pub max: Vec3,
}

/// Triangles of a mesh that are made of one material, and how they are ordered for drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Among the mesh's triangles, and among its draw triangles, which are the same ones in another order.
    pub triangles: Range<usize>,
    /// Index into [`Rig::materials`](super::Rig::materials).
    pub material: Option<usize>,
    /// What it is instead in some of the rig's variants, by their index.
    pub(super) in_variants: BTreeMap<usize, Look>,
    /// Lit by each triangle's own normal, whatever is asked for.
    pub is_flat: bool,
    /// Which of them can be seen with the file's own choice of materials.
    pub sides: Sides,
    /// The mean of its triangles' corners, in bind space.
    pub center: Vec3,
    /// Index into [`Rig::bindings`](super::Rig::bindings): what these corners follow most.
    pub follows: u32,
}

/// What a part is made of, and what follows from that.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Look {
    /// Index into [`Rig::materials`](super::Rig::materials).
    pub material: Option<usize>,
    /// Which sides can be seen of what is made of it.
    pub sides: Sides,
}

impl Part {
    /// In a variant, an index into [`Rig::variants`](super::Rig::variants); `None` is the file's own choice.
    pub fn look(&self, variant: Option<usize>) -> Look {
        let in_variant = variant.and_then(|variant| self.in_variants.get(&variant));
        in_variant.copied().unwrap_or(Look {
            material: self.material,
            sides: self.sides,
        })
    }

    fn memory_bytes(&self) -> usize {
        size_of::<Self>() + self.in_variants.len() * size_of::<(usize, Look)>()
    }

    /// The file's own first, then those of variants.
    pub(super) fn materials(&self) -> impl Iterator<Item = Option<usize>> {
        let in_variants = self.in_variants.values().map(|look| look.material);
        std::iter::once(self.material).chain(in_variants)
    }

    /// By what it is made of.
    pub(super) fn set_sides(&mut self, of: impl Fn(Option<usize>) -> Sides) {
        self.sides = of(self.material);
        for look in self.in_variants.values_mut() {
            look.sides = of(look.material);
        }
    }

    /// Its draw triangles in one or two runs, each of which is culled alike whatever the variant.
    pub fn halves(&self) -> [Range<usize>; 2] {
        let Range { start, end } = self.triangles;
        let in_variants = self.in_variants.values().map(|look| look.sides);
        let mut looks = std::iter::once(self.sides).chain(in_variants);
        let split = looks.find_map(Sides::first_count);
        let middle = split.map_or(end, |count| start + count);
        [start..middle, middle..end]
    }
}

/// Which sides of a surface there are to be seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Front and back of each triangle.
    Both,
    /// It is part of what encloses a volume, whatever the pose. The first so many draw triangles are wound counter-clockwise seen from
    /// outside, the rest seen from within.
    Outside {
        /// Draw triangles of the part that are wound counter-clockwise seen from outside.
        count: usize,
    },
    /// Its material is single-sided. The first so many draw triangles are wound counter-clockwise seen from the front, the rest seen
    /// from the back.
    Front {
        /// Draw triangles of the part that are wound counter-clockwise seen from the front.
        count: usize,
    },
}

impl Sides {
    /// How many draw triangles stand before those that are wound the other way.
    fn first_count(self) -> Option<usize> {
        match self {
            Self::Both => None,
            Self::Outside { count } | Self::Front { count } => Some(count),
        }
    }

    /// Of what encloses a volume, how many draw triangles are wound counter-clockwise seen from outside.
    pub fn outward_count(self) -> Option<usize> {
        match self {
            Self::Outside { count } => Some(count),
            Self::Both | Self::Front { .. } => None,
        }
    }
}

/// A triangle mesh in bind space, vertices in the file's own order. Where a place of its surface has several normals, texture coordinates
/// or colors, copies of the vertex there follow behind the file's last vertex. Copies are drawn; only the file's vertices are counted.
#[derive(Debug)]
pub struct Mesh {
    pub(super) name: String,
    pub(super) positions: Vec<Vec3>,
    pub(super) copies: Vec<u32>,
    pub(super) normals: Vec<Vec3>,
    pub(super) texcoords: Option<Vec<Vec2>>,
    pub(super) colors: Option<Vec<Vec4>>,
    pub(super) influence_starts: Vec<u32>,
    pub(super) influences: Vec<Influence>,
    pub(super) morph_starts: Vec<u32>,
    pub(super) morph_displacements: Vec<MorphDisplacement>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) draw_triangles: Vec<[u32; 3]>,
    pub(super) parts: Vec<Part>,
    pub(super) has_negative_weights: bool,
    pub(super) binding_bounds: Vec<BindingBounds>,
    pub(super) morph_reach: Vec<(usize, f32)>,
}

impl Mesh {
    /// Unique in its rig.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Those of the file.
    pub fn vertex_count(&self) -> usize {
        self.positions.len() - self.copies.len()
    }

    /// Those of the file and copies of them.
    pub fn draw_vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Which vertex of the file a draw vertex is, or is a copy of.
    pub fn original_of(&self, vertex: u32) -> u32 {
        let copy = (vertex as usize).checked_sub(self.vertex_count());
        copy.map_or(vertex, |copy| self.copies[copy])
    }

    /// One per draw vertex.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Unit length, one per draw vertex.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// One per draw vertex; `v` is 0 at the bottom of the picture.
    pub fn texcoords(&self) -> Option<&[Vec2]> {
        self.texcoords.as_deref()
    }

    /// One per vertex of the file; `None` where a vertex has several.
    pub fn shared_texcoords(&self) -> Option<&[Vec2]> {
        let (own, of_copies) = self.texcoords()?.split_at(self.vertex_count());
        let mut copies = self.copies.iter().zip(of_copies);
        let is_shared = copies.all(|(&original, of_copy)| own[original as usize] == *of_copy);
        is_shared.then_some(own)
    }

    /// Linear RGB and opacity, one per draw vertex: they multiply the material's.
    pub fn colors(&self) -> Option<&[Vec4]> {
        self.colors.as_deref()
    }

    /// `draw_vertex_count + 1` indices into [`Mesh::influences`]: those of vertex `v` are `starts[v]..starts[v + 1]`, never empty.
    pub fn influence_starts(&self) -> &[u32] {
        &self.influence_starts
    }

    /// Those of every vertex, one vertex after another; those of one vertex heaviest first, of equal ones the lowest joint first.
    pub fn influences(&self) -> &[Influence] {
        &self.influences
    }

    /// Those of one draw vertex, never empty.
    pub fn influences_of(&self, vertex: usize) -> &[Influence] {
        &self.influences
            [self.influence_starts[vertex] as usize..self.influence_starts[vertex + 1] as usize]
    }

    /// `draw_vertex_count + 1` indices into [`Mesh::morph_displacements`], or none where no morph target moves this mesh.
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

    /// Of draw vertices, with the file's own order and winding.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The same triangles, of the file's vertices.
    pub fn file_triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let original = |vertex| self.original_of(vertex);
        self.triangles
            .iter()
            .map(move |corners| corners.map(original))
    }

    /// The same triangles, each wound counter-clockwise about its vertices' normals; within a [part](Self::parts) in the order that its
    /// [sides](Part::sides) say.
    pub fn draw_triangles(&self) -> &[[u32; 3]] {
        &self.draw_triangles
    }

    /// All triangles, one part after another. At least one.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Where not, a vertex lies between the places that what it follows would put it.
    pub fn has_negative_weights(&self) -> bool {
        self.has_negative_weights
    }

    /// One for each binding that vertices follow, by binding.
    pub fn binding_bounds(&self) -> &[BindingBounds] {
        &self.binding_bounds
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
        let colors = self
            .colors
            .as_ref()
            .map_or(0, |colors| size_of_val(colors.as_slice()));
        size_of_val(self.positions.as_slice())
            + size_of_val(self.copies.as_slice())
            + colors
            + size_of_val(self.normals.as_slice())
            + texcoords
            + size_of_val(self.influence_starts.as_slice())
            + size_of_val(self.influences.as_slice())
            + size_of_val(self.morph_starts.as_slice())
            + size_of_val(self.morph_displacements.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.draw_triangles.as_slice())
            + self.parts.iter().map(Part::memory_bytes).sum::<usize>()
            + size_of_val(self.binding_bounds.as_slice())
    }
}
