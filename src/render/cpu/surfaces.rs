//! The surfaces of a picture in the order in which they are drawn, with their materials. Never lives here: what becomes of their triangles.

use super::geometry::{Paint, Surface};
use super::instance::DrawnInstance;
use super::lines;
use super::material::PartMaterial;
use super::picture_scratch::{PictureScratch, Subject};
use super::samples::Layer;
use super::skinned::meshes;
use crate::render::cull::{self, Culling};
use crate::render::{Instance, Plan};
use crate::rig::{Mesh, Opacity, Part};
use crate::scene::Bounds;
use std::ops::Range;

/// All surfaces of a picture, and the materials of some of them.
pub(super) struct Surfaces<'a> {
    pub surfaces: Vec<Surface<'a>>,
    pub materials: Vec<PartMaterial<'a>>,
    meshes: Vec<SkinMesh<'a>>,
    /// The first triangle of them that blends.
    pub first_blending: u32,
}

/// A mesh of an instance, ready to be drawn part by part.
struct SkinMesh<'a> {
    /// Indices of both.
    at: [usize; 2],
    instance: &'a Instance,
    mesh: &'a Mesh,
    /// Which of the skinned vertices are its own.
    own: Range<usize>,
    /// Where its vertices start among all that is projected.
    first_projected: usize,
    culling: Culling,
}

impl<'a> Surfaces<'a> {
    fn with_capacity_for(plan: &Plan) -> Self {
        let meshes = plan.drawn().map(|(_, instance)| instance.rig().meshes());
        let parts: usize = meshes
            .clone()
            .flatten()
            .map(|mesh| mesh.parts().len())
            .sum();
        Self {
            // Lines and solids of each instance; a part may be cut in two.
            surfaces: Vec::with_capacity(2 * (plan.instances.len() + parts)),
            materials: Vec::with_capacity(parts),
            meshes: Vec::with_capacity(meshes.map(<[Mesh]>::len).sum()),
            first_blending: 0,
        }
    }

    /// Skeletons first, then skins: what blends last, in its order.
    pub(super) fn of(subject: Subject<'a>, scratch: &'a PictureScratch) -> Self {
        let mut list = Self::with_capacity_for(subject.plan);
        list.add_skeletons(subject, scratch);
        list.find_meshes(subject, &scratch.instances);
        for index in 0..list.meshes.len() {
            let SkinMesh { instance, mesh, .. } = list.meshes[index];
            let is_translucent = instance.is_translucent();
            let layer = if is_translucent {
                Layer::Skin
            } else {
                Layer::Base
            };
            for part in mesh.parts() {
                let variant = instance.appearance().surface.variant;
                let material = instance.rig().material_of(part, variant);
                let blends = material.is_some_and(|it| it.opacity == Opacity::Blend);
                if is_translucent || !blends {
                    list.add_part(subject, index, part, layer);
                }
            }
        }
        list.first_blending = list.surfaces.last().map_or(0, Surface::end);
        for (_, place) in &scratch.blending {
            let wanted = [place.instance, place.mesh];
            if let Ok(index) = list.meshes.binary_search_by_key(&wanted, |mesh| mesh.at) {
                let part = &list.meshes[index].mesh.parts()[place.part];
                list.add_part(subject, index, part, Layer::Base);
            }
        }
        list
    }

    fn add_skeletons(&mut self, subject: Subject<'a>, scratch: &'a PictureScratch) {
        let solids = &scratch.solids;
        let first_line = (scratch.projected.len() - scratch.line_corners.len()) as u32;
        let first_solid = first_line - solids.positions.len() as u32;
        for (index, (instance, drawn)) in subject
            .plan
            .instances
            .iter()
            .zip(&scratch.instances)
            .enumerate()
        {
            let skeleton = instance.skeleton();
            let instance = index as u32;
            self.add(Surface {
                triangles: &scratch.line_triangles[lines::triangles(&drawn.lines)],
                instance,
                positions: &[],
                normals: &[],
                first_vertex: first_line,
                paint: Paint::Lines(&skeleton.lines),
                ..Surface::default()
            });
            self.add(Surface {
                triangles: &skeleton.solids.triangles,
                instance,
                positions: &solids.positions[drawn.solids.clone()],
                normals: &solids.normals[drawn.solids.clone()],
                first_vertex: first_solid + drawn.solids.start as u32,
                paint: Paint::Solids(&skeleton.solids.vertices),
                ..Surface::default()
            });
        }
    }

    /// Every mesh of a skin that has something to draw.
    fn find_meshes(&mut self, subject: Subject<'a>, drawn: &[DrawnInstance]) {
        let Subject { plan, scene, skin } = subject;
        for (index, instance) in plan.drawn() {
            let DrawnInstance {
                skin: ref own,
                first_projected,
                ..
            } = drawn[index];
            let first = own.start;
            for (mesh_index, (mesh, own)) in meshes(instance.skin(), first).enumerate() {
                if mesh.parts().is_empty() {
                    continue;
                }
                // Where no box is known beforehand, the vertices themselves tell.
                let bounds = cull::reach(instance.skin(), mesh)
                    .or_else(|| Bounds::of_positions(skin.positions[own.clone()].as_flattened()));
                self.meshes.push(SkinMesh {
                    at: [index, mesh_index],
                    instance,
                    mesh,
                    first_projected: first_projected + own.start - first,
                    own,
                    culling: Culling::of(instance, mesh, &scene.camera, bounds),
                });
            }
        }
    }

    /// A part of the mesh of this index.
    fn add_part(&mut self, subject: Subject<'a>, mesh: usize, part: &Part, layer: Layer) {
        let SkinMesh {
            at: [index, _],
            instance,
            mesh,
            ref own,
            first_projected,
            culling,
        } = self.meshes[mesh];
        let own = own.clone();
        let skin = subject.skin;
        let (rig, surface) = (instance.rig(), &instance.appearance().surface);
        let material = PartMaterial::of(rig, mesh, part, surface);
        let paint = match material {
            Some(_) => Paint::Material(self.materials.len() as u32),
            None => Paint::of(rig, mesh, part, surface.variant),
        };
        self.materials.extend(material);
        for piece in culling.pieces(part) {
            self.add(Surface {
                triangles: &mesh.draw_triangles()[piece.triangles],
                instance: index as u32,
                positions: &skin.positions[own.clone()],
                normals: &skin.normals[own.clone()],
                first_vertex: first_projected as u32,
                paint,
                layer,
                culled: piece.culled,
                ..Surface::default()
            });
        }
    }

    fn add(&mut self, surface: Surface<'a>) {
        let first_triangle = self.surfaces.last().map_or(0, Surface::end);
        self.surfaces
            .extend((!surface.triangles.is_empty()).then_some(Surface {
                first_triangle,
                ..surface
            }));
    }
}
