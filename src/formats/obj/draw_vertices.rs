//! The vertices that an OBJ is drawn with. There, normals and texture coordinates belong to corners of faces; here, to draw vertices: those of
//! the file, and a copy for whatever else a corner at one of them has. Never lives here: statements.

use crate::limits::{LimitExceeded, Limits};
use glam::{DVec3, Vec2, Vec3};
use std::collections::{HashMap, HashSet};

/// What a corner of a face has besides its position.
#[derive(Debug, Clone, Copy)]
pub(super) struct CornerAttributes {
    pub texcoord: Option<Vec2>,
    pub normal: Normal,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Normal {
    /// Of all faces around the vertex.
    Smooth,
    /// Of those around the vertex that are of this smoothing group.
    OfGroup(u32),
    Given(Vec3),
}

/// The bits of them, to compare by: exporters write equal values many times over, so that their indices say nothing.
type Key = [u32; 6];

#[derive(Debug, Default)]
pub(super) struct DrawVertices {
    /// What the first corner at each vertex of the file has; `None` of one that is of no face.
    first: Vec<Option<CornerAttributes>>,
    /// What other corners have, each with its vertex.
    copies: Vec<(u32, CornerAttributes)>,
    numbers: HashMap<(u32, Key), u32>,
    /// Sums of area vectors, by vertex and smoothing group.
    groups: HashMap<(u32, u32), DVec3>,
}

/// What becomes of all corners.
pub(super) struct Split {
    /// As in [`MeshDraft`](crate::rig::MeshDraft).
    pub copies: Vec<u32>,
    /// Of no length where the mesh is to compute one. `None` where it is to compute all.
    pub normals: Option<Vec<Vec3>>,
    pub texcoords: Option<Vec<Vec2>>,
}

/// In place of a vertex, that what follows is the number of a copy: no file has as many vertices.
const COPY: u32 = 1 << 31;

impl DrawVertices {
    /// The draw vertex of a corner, as [`finish`](Self::finish) takes it.
    ///
    /// # Errors
    /// At the first copy too many, where the file has `vertex_count` vertices so far.
    pub(super) fn of_corner(
        &mut self,
        vertex: u32,
        corner: CornerAttributes,
        vertex_count: usize,
        limits: &Limits,
    ) -> Result<u32, LimitExceeded> {
        let index = vertex as usize;
        if self.first.len() <= index {
            self.first.resize(index + 1, None);
        }
        let first = *self.first[index].get_or_insert(corner);
        if first.key() == corner.key() {
            return Ok(vertex);
        }
        let next = self.copies.len() as u32;
        let number = *self.numbers.entry((vertex, corner.key())).or_insert(next);
        if number == next {
            limits.vertices(vertex_count + self.copies.len() + 1)?;
            self.copies.push((vertex, corner));
        }
        Ok(COPY | number)
    }

    /// Adds a face to what is smooth in its group at one of its vertices.
    pub(super) fn add_to_group(&mut self, vertex: u32, group: u32, area_vector: DVec3) {
        *self.groups.entry((vertex, group)).or_default() += area_vector;
    }

    /// `triangles` name draw vertices as [`of_corner`](Self::of_corner) gave them, and are renumbered.
    pub(super) fn finish(mut self, vertex_count: usize, triangles: &mut [[u32; 3]]) -> Split {
        self.first.resize(vertex_count, None);
        let moved = self.set_apart();
        if !self.copies.is_empty() {
            for corner in triangles.as_flattened_mut() {
                let copy = match *corner & COPY {
                    0 => moved.get(corner).copied(),
                    _ => Some(*corner & !COPY),
                };
                if let Some(copy) = copy {
                    *corner = vertex_count as u32 + copy;
                }
            }
        }
        let Self {
            first,
            copies,
            groups,
            ..
        } = self;
        let corners = || {
            let of_file = (0..).zip(&first).map(|(vertex, corner)| (vertex, *corner));
            of_file.chain(
                copies
                    .iter()
                    .map(|(vertex, corner)| (*vertex, Some(*corner))),
            )
        };
        let normal = |(vertex, corner): (u32, Option<CornerAttributes>)| match corner
            .map(|corner| corner.normal)
        {
            None | Some(Normal::Smooth) => Vec3::ZERO,
            Some(Normal::Given(normal)) => normal,
            Some(Normal::OfGroup(group)) => {
                let sum = groups.get(&(vertex, group)).copied();
                sum.unwrap_or_default().normalize_or_zero().as_vec3()
            }
        };
        let texcoord = |(_, corner): (u32, Option<CornerAttributes>)| {
            corner.and_then(|corner| corner.texcoord)
        };
        let has_texcoords = corners().any(|it| texcoord(it).is_some());
        let is_given = |corner: CornerAttributes| !matches!(corner.normal, Normal::Smooth);
        let has_normals = corners().any(|(_, corner)| corner.is_some_and(is_given));
        Split {
            normals: has_normals.then(|| corners().map(normal).collect()),
            texcoords: has_texcoords.then(|| {
                corners()
                    .map(|it| texcoord(it).unwrap_or_default())
                    .collect()
            }),
            copies: copies.iter().map(|(vertex, _)| *vertex).collect(),
        }
    }

    /// A vertex whose corners have several normals is smooth itself, whatever the first of them has, which a copy takes on. Returns those
    /// copies by vertex.
    fn set_apart(&mut self) -> HashMap<u32, u32> {
        let mut several = HashSet::new();
        for (vertex, corner) in &self.copies {
            let first = self.first[*vertex as usize];
            if first.is_some_and(|first| first.normal.key() != corner.normal.key()) {
                several.insert(*vertex);
            }
        }
        let mut moved = HashMap::new();
        for (vertex, slot) in (0..).zip(&mut self.first) {
            let Some(first) = slot.as_mut().filter(|_| several.contains(&vertex)) else {
                continue;
            };
            if !matches!(first.normal, Normal::Smooth) {
                moved.insert(vertex, self.copies.len() as u32);
                self.copies.push((vertex, *first));
                first.normal = Normal::Smooth;
            }
        }
        moved
    }
}

impl CornerAttributes {
    fn key(&self) -> Key {
        let [kind, x, y, z] = self.normal.key();
        // No number that is read is NaN.
        let Vec2 { x: u, y: v } = self.texcoord.unwrap_or(Vec2::NAN);
        [kind, x, y, z, bits(u), bits(v)]
    }
}

impl Normal {
    fn key(&self) -> [u32; 4] {
        match *self {
            Self::Smooth => [0; 4],
            Self::OfGroup(group) => [1, group, 0, 0],
            Self::Given(Vec3 { x, y, z }) => [2, bits(x), bits(y), bits(z)],
        }
    }
}

/// The two zeros are one.
fn bits(number: f32) -> u32 {
    (number + 0.0).to_bits()
}
