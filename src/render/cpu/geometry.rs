//! What a picture is made of: triangles over one numbering of vertices, and how each surface is painted. Triangles are numbered in the
//! order in which they are drawn: where two are equally near, the first one shows; those that blend come last. Never lives here: where triangles fall.

use super::clip::{Unplaced, clip};
use super::instance::DrawnInstance;
use super::material::PartMaterial;
use super::project::Projected;
use super::samples::Layer;
use super::triangle::Corner;
use crate::render::cull::Side;
use crate::render::{Segment, SolidVertex};
use crate::rig::{Mesh, Part, Rig, Texture};
use glam::Vec2;

/// Triangles that are painted alike.
#[derive(Clone, Copy, Default)]
pub(super) struct Surface<'a> {
    /// Of three of its own vertices each.
    pub triangles: &'a [[u32; 3]],
    pub first_triangle: u32,
    /// Index into [`Geometry::instances`].
    pub instance: u32,
    /// In model space, one for each of its vertices; lines have none.
    pub positions: &'a [[f32; 3]],
    pub normals: &'a [[f32; 3]],
    /// Where among all that are projected its vertices start.
    pub first_vertex: u32,
    pub paint: Paint<'a>,
    pub layer: Layer,
    /// Triangles seen from this side are left out.
    pub culled: Option<Side>,
}

/// Which color a surface scatters.
#[derive(Clone, Copy, Default)]
pub(super) enum Paint<'a> {
    /// Each segment's own color, unlit; two triangles to a segment.
    Lines(&'a [Segment]),
    /// Each triangle's own color.
    Solids(&'a [SolidVertex]),
    #[default]
    Plain,
    Textured(&'a Texture, &'a [Vec2]),
    /// By number.
    Material(u32),
}

/// Everything that is drawn, projected.
#[derive(Clone, Copy)]
pub(super) struct Geometry<'a> {
    pub instances: &'a [DrawnInstance],
    /// In the order of their triangles.
    pub surfaces: &'a [Surface<'a>],
    /// From this triangle on they blend: one after another is laid over the base.
    pub first_blending: u32,
    /// What some of them are painted with.
    pub materials: &'a [PartMaterial<'a>],
    /// Every vertex.
    pub projected: &'a [Projected],
    /// Of the vertices of lines.
    pub line_corners: &'a [[f32; 4]],
}

/// Where a triangle's surface is, and which of its triangles it is.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub surface: &'a Surface<'a>,
    pub triangle: usize,
}

impl<'a> Paint<'a> {
    /// Of a part of a mesh of `rig` without a material of its own.
    pub(super) fn of(rig: &'a Rig, mesh: &'a Mesh, part: &Part, variant: Option<usize>) -> Self {
        let texture = rig
            .material_of(part, variant)
            .and_then(|material| material.texture.as_ref())
            .map(|place| &*place.texture);
        match (texture, mesh.texcoords()) {
            (Some(texture), Some(texcoords)) => Self::Textured(texture, texcoords),
            _ => Self::Plain,
        }
    }
}

impl Surface<'_> {
    pub(super) fn end(&self) -> u32 {
        self.first_triangle + self.triangles.len() as u32
    }
}

impl<'a> Geometry<'a> {
    pub(super) fn triangle_count(&self) -> usize {
        self.surfaces.last().map_or(0, |last| last.end() as usize)
    }

    /// Whether any of them blend.
    pub(super) fn blends(&self) -> bool {
        (self.first_blending as usize) < self.triangle_count()
    }

    /// Of a triangle's number.
    #[inline(always)]
    pub(super) fn place(&self, triangle: u32) -> Place<'a> {
        let after = self
            .surfaces
            .partition_point(|surface| surface.first_triangle <= triangle);
        // The first surface starts at 0.
        let surface = &self.surfaces[after - 1];
        Place {
            surface,
            triangle: (triangle - surface.first_triangle) as usize,
        }
    }

    /// The instance that a triangle is of.
    #[inline(always)]
    pub(super) fn instance_of(&self, place: Place<'_>) -> &'a DrawnInstance {
        &self.instances[place.surface.instance as usize]
    }

    /// Where the corners of a whole triangle fall.
    #[inline(always)]
    pub(super) fn projected_of(&self, place: Place<'a>) -> [Projected; 3] {
        // Written out: a closure would be called, for each triangle.
        let [a, b, c] = place.vertices();
        [self.projected[a], self.projected[b], self.projected[c]]
    }

    /// Of a triangle with a corner that [is beyond](Projected::is_beyond).
    pub(super) fn pieces(&self, place: Place<'a>) -> impl Iterator<Item = [Corner; 3]> {
        let whole = self.corners_of_whole(place);
        let Surface {
            triangles,
            positions,
            paint,
            ..
        } = place.surface;
        let own = triangles[place.triangle].map(|own| own as usize);
        let projection = &self.instance_of(place).projection;
        let unplaced = [0, 1, 2].map(|corner| Unplaced {
            clip: match paint {
                Paint::Lines(_) => self.line_corners[own[corner]],
                _ => projection.clip_of(positions[own[corner]]),
            },
            corner: whole[corner],
        });
        clip(unplaced, projection)
    }

    /// Of piece number `piece` of a triangle, or of one that is whole.
    pub(super) fn corners(&self, place: Place<'a>, piece: u32) -> [Corner; 3] {
        let whole = self.corners_of_whole(place);
        if whole.iter().any(|corner| corner.projected.is_beyond()) {
            let mut pieces = self.pieces(place);
            // The same ones whenever it is cut.
            pieces.nth(piece as usize).unwrap_or(whole)
        } else {
            whole
        }
    }

    /// Of a whole triangle, also where they are beyond what can be drawn.
    #[inline(always)]
    pub(super) fn corners_of_whole(&self, place: Place<'a>) -> [Corner; 3] {
        let Surface {
            triangles,
            positions,
            normals,
            paint,
            ..
        } = place.surface;
        let own = triangles[place.triangle].map(|own| own as usize);
        let instance = self.instance_of(place);
        let mut corners = [Corner::default(); 3];
        for ((corner, vertex), own) in corners.iter_mut().zip(place.vertices()).zip(own) {
            corner.projected = self.projected[vertex];
            // Lines have neither.
            if let (Some(position), Some(normal)) = (positions.get(own), normals.get(own)) {
                corner.position = instance.position_in_world(*position);
                corner.normal = instance.normal_in_world(*normal);
            }
            match *paint {
                Paint::Lines(_) | Paint::Solids(_) | Paint::Plain => {}
                Paint::Textured(_, texcoords) => corner.texcoord = texcoords[own].to_array(),
                Paint::Material(material) => {
                    let PartMaterial {
                        texcoords, colors, ..
                    } = self.materials[material as usize];
                    if let Some(texcoords) = texcoords {
                        corner.texcoord = texcoords[own].to_array();
                    }
                    if let Some(colors) = colors {
                        corner.color = colors[own].to_array();
                    }
                }
            }
        }
        corners
    }
}

impl Place<'_> {
    /// In the numbering of all.
    #[inline(always)]
    pub(super) fn vertices(&self) -> [usize; 3] {
        let first = self.surface.first_vertex;
        let [a, b, c] = self.surface.triangles[self.triangle];
        [
            (first + a) as usize,
            (first + b) as usize,
            (first + c) as usize,
        ]
    }
}
