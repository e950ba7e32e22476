//! A picture from plan to pixels, stage after stage. Never lives here: how a stage does its work.

use super::bin::Chunk;
use super::context::PictureContext;
use super::geometry::{Geometry, Paint, Surface};
use super::grid::{Grid, TILE};
use super::instance::DrawnInstance;
use super::lines;
use super::material::PartMaterial;
use super::project::{Projected, Projection};
use super::resolve::Resolve;
use super::samples::{Layer, Pattern};
use super::skinned::{Skinned, Vertices, meshes};
use super::{Cpu, PORTION, Parallelism};
use crate::frame::{ImageKind, Raster};
use crate::render::cull::{self, Culling};
use crate::render::instance_params::InstanceParams;
use crate::render::order::{PartPlace, blending_parts};
use crate::render::view::View;
use crate::render::{Instance, Plan, SkeletonView};
use crate::rig::{Mesh, Opacity, Part};
use crate::scene::{Bounds, Scene};
use bytemuck::Zeroable;
use fearless_simd::dispatch;
use std::ops::Range;

/// What there is to draw.
#[derive(Clone, Copy)]
struct Subject<'a> {
    plan: &'a Plan,
    scene: &'a Scene,
    /// The vertices of those instances whose skin is shown.
    skin: &'a Vertices,
}

/// Of the solids of all instances, in model space.
#[derive(Default)]
pub(super) struct SolidVertices {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
}

/// What one picture needs until it is drawn.
#[derive(Default)]
pub(super) struct PictureScratch {
    instances: Vec<DrawnInstance>,
    solids: SolidVertices,
    projected: Vec<Projected>,
    line_corners: Vec<[f32; 4]>,
    line_triangles: Vec<[u32; 3]>,
    chunks: Vec<Chunk>,
    /// Empty between pictures, as the next two.
    surfaces: Vec<Surface<'static>>,
    materials: Vec<PartMaterial<'static>>,
    meshes: Vec<SkinMesh<'static>>,
    /// Parts that blend, in their order.
    blending: Vec<(f64, PartPlace)>,
}

impl Cpu {
    /// The color picture of `plan`. `skinned` are at least the skins that it [shows](Plan::drawn). `None` where it was cancelled.
    pub(super) fn color(
        &self,
        plan: &Plan,
        scene: &Scene,
        skinned: &Skinned,
        parallelism: Parallelism<'_>,
    ) -> Option<Raster> {
        let subject = Subject {
            plan,
            scene,
            skin: skinned.vertices(),
        };
        let view = View::of(scene);
        let mut scratch = self.pictures.take();
        self.place(subject, &mut scratch, parallelism);
        let first = scratch.instances.first();
        let plain = first.map_or_else(InstanceParams::zeroed, |first| first.params);
        let mut chunks = std::mem::take(&mut scratch.chunks);
        blending_parts(plan, &mut scratch.blending);
        let lists = Lists {
            surfaces: emptied(std::mem::take(&mut scratch.surfaces)),
            materials: emptied(std::mem::take(&mut scratch.materials)),
            meshes: emptied(std::mem::take(&mut scratch.meshes)),
            first_blending: 0,
        };
        let Lists {
            surfaces,
            materials,
            meshes,
            first_blending,
        } = lists.filled(subject, &scratch);
        let geometry = Geometry {
            instances: &scratch.instances,
            surfaces: &surfaces,
            first_blending,
            materials: &materials,
            projected: &scratch.projected,
            line_corners: &scratch.line_corners,
        };

        let (grid, pattern) = (Grid::of(scene.size), Pattern::of(scene.samples));
        let triangles = geometry.triangle_count();
        let portions = parallelism.count(triangles, PORTION);
        if chunks.len() < portions {
            chunks.resize_with(portions, Chunk::default);
        }
        let portion = triangles.div_ceil(portions) as u32;
        parallelism.portions(&mut chunks[..portions], 1, |index, chunk| {
            let start = index as u32 * portion;
            let range = start..start + portion;
            chunk[0].fill(&geometry, range, &grid, pattern, parallelism);
        });

        let context = PictureContext {
            geometry,
            chunks: &chunks[..portions],
            grid,
            pattern,
            view: &view,
            plain: &plain,
            has_materials: !materials.is_empty() || !are_lit_alike(&scratch.instances),
            resolve: Resolve {
                background: scene.background.premultiplied().to_array(),
                sample_count: pattern.count(),
                opacity: layer_opacity(plan),
            },
            has_skin_layer: plan.is_translucent(),
            parallelism,
        };
        // Otherwise not everything was sorted.
        let color = (!parallelism.is_cancelled()).then(|| self.paint(&context, parallelism));
        let (surfaces, materials) = (emptied(surfaces), emptied(materials));
        (scratch.surfaces, scratch.materials, scratch.meshes) =
            (surfaces, materials, emptied(meshes));
        scratch.chunks = chunks;
        color.filter(|_| !parallelism.is_cancelled())
    }

    /// Every vertex onto the picture: of skins, of solids, of lines.
    fn place(
        &self,
        subject: Subject<'_>,
        scratch: &mut PictureScratch,
        parallelism: Parallelism<'_>,
    ) {
        scratch.lay_out(subject);
        let PictureScratch {
            instances,
            solids,
            projected,
            line_corners,
            ..
        } = scratch;
        let mut rest = projected.as_mut_slice();
        let mut project = |projection: &Projection, positions: &[[f32; 3]]| {
            let (own, others) = std::mem::take(&mut rest).split_at_mut(positions.len());
            parallelism.portions(own, PORTION, |index, projected| {
                let own = &positions[index * PORTION..][..projected.len()];
                projection.project(self.level, own, projected);
            });
            rest = others;
        };
        for instance in instances.iter() {
            project(
                &instance.projection,
                &subject.skin.positions[instance.skin.clone()],
            );
        }
        for instance in instances.iter() {
            project(
                &instance.projection,
                &solids.positions[instance.solids.clone()],
            );
        }
        for instance in instances.iter() {
            let corners = lines::corners(&instance.lines);
            let (own, others) = std::mem::take(&mut rest).split_at_mut(corners.len());
            for (projected, corner) in own.iter_mut().zip(&line_corners[corners]) {
                *projected = instance.projection.place_of(*corner);
            }
            rest = others;
        }
    }

    /// Tile by tile.
    fn paint(&self, context: &PictureContext<'_>, parallelism: Parallelism<'_>) -> Raster {
        let Grid { size, columns, .. } = context.grid;
        let kind = ImageKind::Color;
        let mut bytes = self.bytes.take(kind.bytes(size));
        let band_bytes = 4 * size.width as usize * TILE[1] as usize;
        parallelism.portions(&mut bytes, band_bytes, |row, band| {
            let mut tile = self.tiles.take();
            for column in (0..columns).take_while(|_| !parallelism.is_cancelled()) {
                let at = [column, row as u32];
                dispatch!(self.level, simd => tile.draw(simd, context, at, band));
            }
        });
        Raster { kind, size, bytes }
    }
}

impl PictureScratch {
    /// Says where the vertices of each instance stand, and lays out those of skeletons.
    fn lay_out(&mut self, subject: Subject<'_>) {
        let Subject { plan, scene, skin } = subject;
        let Self {
            instances,
            solids: SolidVertices { positions, normals },
            projected,
            line_corners,
            line_triangles,
            ..
        } = self;
        instances.clear();
        positions.clear();
        normals.clear();
        line_corners.clear();
        line_triangles.clear();
        let mut skin_vertices = 0;
        for instance in &plan.instances {
            let mut drawn = DrawnInstance::of(instance, scene);
            if instance.shows_skin() {
                drawn.skin = skin.range_of(instance.skin()).unwrap_or_default();
            }
            drawn.first_projected = skin_vertices;
            skin_vertices += drawn.skin.len();
            let SkeletonView { lines, solids } = instance.skeleton();
            let (first_line, first_solid) = (line_corners.len() / lines::CORNERS, positions.len());
            lines::add(lines, &drawn.projection, line_corners, line_triangles);
            let of_solids = solids.vertices.iter();
            positions.extend(of_solids.clone().map(|vertex| vertex.position.to_array()));
            normals.extend(of_solids.map(|vertex| vertex.normal.to_array()));
            drawn.lines = first_line..first_line + lines.len();
            drawn.solids = first_solid..positions.len();
            instances.push(drawn);
        }
        let all = skin_vertices + positions.len() + line_corners.len();
        projected.resize(all, Projected::default());
    }
}

/// Whether surfaces of all of them that have no material of their own are lit alike.
fn are_lit_alike(instances: &[DrawnInstance]) -> bool {
    instances.windows(2).all(|pair| {
        let [one, other] = [&pair[0].params, &pair[1].params];
        one.specular == other.specular
            && one.shininess == other.shininess
            && one.least_distance_squared == other.least_distance_squared
    })
}

/// How much of the layer of translucent skin hides what is behind it.
fn layer_opacity(plan: &Plan) -> f32 {
    let translucent = plan.drawn().find(|(_, instance)| instance.is_translucent());
    translucent.map_or(1.0, |(_, instance)| {
        instance.appearance().show.skin_opacity()
    })
}

/// All surfaces of a picture, and the materials of some of them.
struct Lists<'a> {
    surfaces: Vec<Surface<'a>>,
    materials: Vec<PartMaterial<'a>>,
    meshes: Vec<SkinMesh<'a>>,
    /// The first triangle of them that blends.
    first_blending: u32,
}

/// A mesh of an instance, ready to be drawn part by part.
pub(super) struct SkinMesh<'a> {
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

impl<'a> Lists<'a> {
    /// Skeletons first, then skins: what blends last, in its order.
    fn filled(mut self, subject: Subject<'a>, scratch: &'a PictureScratch) -> Self {
        self.add_skeletons(subject, scratch);
        self.find_meshes(subject, &scratch.instances);
        for index in 0..self.meshes.len() {
            let SkinMesh { instance, mesh, .. } = self.meshes[index];
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
                    self.add_part(subject, index, part, layer);
                }
            }
        }
        self.first_blending = self.surfaces.last().map_or(0, Surface::end);
        for (_, place) in &scratch.blending {
            let wanted = [place.instance, place.mesh];
            if let Ok(index) = self.meshes.binary_search_by_key(&wanted, |mesh| mesh.at) {
                let part = &self.meshes[index].mesh.parts()[place.part];
                self.add_part(subject, index, part, Layer::Base);
            }
        }
        self
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

/// A list without what is in it, as memory for another of the same kind, which may be of something that lives shorter or longer.
fn emptied<T, U>(mut list: Vec<T>) -> Vec<U> {
    list.clear();
    // Collected in place, for nothing changes its size.
    let nothing = list.into_iter();
    nothing.map(|_| unreachable!("it was cleared")).collect()
}
