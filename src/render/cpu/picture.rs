//! A picture from plan to pixels, stage after stage. Never lives here: how a stage does its work.

use super::bin::{Chunk, Grid, TILE};
use super::coated::Coated;
use super::geometry::{Geometry, Layer, Paint, Surface};
use super::lines;
use super::project::{Projected, Projection};
use super::resolve::Resolve;
use super::room::Room;
use super::samples::Pattern;
use super::skinned::{Skinned, Vertices, in_order};
use super::tile::Picturing;
use super::{Cpu, PORTION, Spread};
use crate::frame::Frame;
use crate::render::cull::{self, Culling};
use crate::render::order::blending_parts;
use crate::render::view::View;
use crate::render::{Picture, Plan};
use crate::rig::{Mesh, Opacity, Part, Rig};
use crate::scene::Bounds;
use fearless_simd::dispatch;
use glam::Vec3;
use std::ops::Range;

/// What there is to draw.
#[derive(Clone, Copy)]
struct Subject<'a> {
    plan: &'a Plan,
    picture: &'a Picture,
    /// The vertices of those instances that are shown.
    skin: &'a Vertices,
}

impl Cpu {
    /// The `picture` that `plan` is of. `skinned` are its [shown instances](Plan::shown_instances). `None` where it was no longer wanted.
    pub fn draw(
        &self,
        plan: &Plan,
        picture: &Picture,
        skinned: &Skinned,
        spread: Spread<'_>,
    ) -> Option<Frame> {
        let subject = Subject {
            plan,
            picture,
            skin: skinned.vertices(),
        };
        let view = View::of(picture);
        let projection = Projection::of(&view);
        let mut room = self.rooms.take();
        self.place(subject, &projection, &mut room, spread);
        let mut chunks = std::mem::take(&mut room.chunks);
        blending_parts(plan, &mut room.blending);
        let lists = Lists {
            surfaces: emptied(std::mem::take(&mut room.surfaces)),
            coated: emptied(std::mem::take(&mut room.coated)),
            meshes: emptied(std::mem::take(&mut room.meshes)),
            first_blending: 0,
        };
        let Lists {
            surfaces,
            coated,
            meshes,
            first_blending,
        } = lists.filled(subject, &room);
        let geometry = Geometry {
            surfaces: &surfaces,
            first_blending,
            coated: &coated,
            projected: &room.projected,
            line_corners: &room.line_corners,
            projection: &projection,
        };

        let (grid, pattern) = (
            Grid::of(picture.scene.size),
            Pattern::of(picture.scene.samples),
        );
        let triangles = geometry.triangle_count();
        let portions = spread.count(triangles, PORTION);
        if chunks.len() < portions {
            chunks.resize_with(portions, Chunk::default);
        }
        let portion = triangles.div_ceil(portions) as u32;
        spread.portions(&mut chunks[..portions], 1, |index, chunk| {
            let start = index as u32 * portion;
            let range = start..start + portion;
            chunk[0].fill(&geometry, range, &grid, pattern, spread);
        });

        let picturing = Picturing {
            geometry,
            chunks: &chunks[..portions],
            grid,
            pattern,
            view: &view,
            resolve: Resolve {
                background: picture.scene.background.premultiplied().to_array(),
                sample_count: pattern.count(),
                opacity: view.opacity,
            },
            has_skin_layer: picture.is_translucent(),
            spread,
        };
        // Otherwise not everything was sorted.
        let frame = spread.is_wanted().then(|| self.paint(&picturing, spread));
        let (surfaces, coated) = (emptied(surfaces), emptied(coated));
        (room.surfaces, room.coated, room.meshes) = (surfaces, coated, emptied(meshes));
        room.chunks = chunks;
        frame.filter(|_| spread.is_wanted())
    }

    /// Every vertex onto the picture: of the skin, of solids, of lines.
    fn place(
        &self,
        subject: Subject<'_>,
        projection: &Projection,
        room: &mut Room,
        spread: Spread<'_>,
    ) {
        let skeleton = &subject.picture.skeleton;
        let Room {
            solids,
            projected,
            line_corners,
            line_triangles,
            ..
        } = room;
        lines::lay_out(&skeleton.lines, projection, line_corners, line_triangles);
        solids.positions.clear();
        solids.normals.clear();
        let of_solids = skeleton.solids.vertices.iter();
        solids
            .positions
            .extend(of_solids.clone().map(|vertex| vertex.position.to_array()));
        solids
            .normals
            .extend(of_solids.map(|vertex| vertex.normal.to_array()));
        let in_world = [&subject.skin.positions, &solids.positions];
        let all = in_world.map(Vec::len).iter().sum::<usize>() + line_corners.len();
        projected.resize(all, Projected::default());
        let mut rest = projected.as_mut_slice();
        for positions in in_world {
            let (own, others) = rest.split_at_mut(positions.len());
            spread.portions(own, PORTION, |index, projected| {
                let own = &positions[index * PORTION..][..projected.len()];
                projection.project(self.level, own, projected);
            });
            rest = others;
        }
        for (projected, corner) in rest.iter_mut().zip(line_corners) {
            *projected = projection.place_of(*corner);
        }
    }

    /// Tile by tile.
    fn paint(&self, picturing: &Picturing<'_>, spread: Spread<'_>) -> Frame {
        let Grid { size, columns, .. } = picturing.grid;
        let mut pixels = self.pixels.take(4 * size.pixels());
        let band_bytes = 4 * size.width as usize * TILE[1] as usize;
        spread.portions(&mut pixels, band_bytes, |row, band| {
            let mut room = self.tile_rooms.take();
            for column in (0..columns).take_while(|_| spread.is_wanted()) {
                let at = [column, row as u32];
                dispatch!(self.level, simd => room.draw(simd, picturing, at, band));
            }
        });
        Frame { size, pixels }
    }
}

/// All surfaces of a picture, and the coats of some of them.
struct Lists<'a> {
    surfaces: Vec<Surface<'a>>,
    coated: Vec<Coated<'a>>,
    meshes: Vec<SkinMesh<'a>>,
    /// The first triangle of them that blends.
    first_blending: u32,
}

/// A mesh of an instance, ready to be drawn part by part.
pub(super) struct SkinMesh<'a> {
    /// Indices of both.
    at: [usize; 2],
    rig: &'a Rig,
    mesh: &'a Mesh,
    /// Which vertices of the skin are its own.
    own: Range<usize>,
    culling: Culling,
}

impl<'a> Lists<'a> {
    /// The skeleton first, then the skin: what blends last, in its order.
    fn filled(mut self, subject: Subject<'a>, room: &'a Room) -> Self {
        let skeleton = &subject.picture.skeleton;
        let solids = &room.solids;
        let first_solid = subject.skin.positions.len() as u32;
        self.add(Surface {
            triangles: &room.line_triangles,
            positions: &[],
            normals: &[],
            first_vertex: first_solid + solids.positions.len() as u32,
            paint: Paint::Lines(&skeleton.lines),
            ..Surface::default()
        });
        self.add(Surface {
            triangles: &skeleton.solids.triangles,
            positions: &solids.positions,
            normals: &solids.normals,
            first_vertex: first_solid,
            paint: Paint::Solids(&skeleton.solids.vertices),
            ..Surface::default()
        });
        self.find_meshes(subject);
        let is_translucent = subject.picture.is_translucent();
        let layer = if is_translucent {
            Layer::Skin
        } else {
            Layer::Base
        };
        for index in 0..self.meshes.len() {
            let SkinMesh { rig, mesh, .. } = self.meshes[index];
            for part in mesh.parts() {
                let material = rig.material_of(part, subject.picture.scene.surface.variant);
                let blends = material.is_some_and(|it| it.opacity == Opacity::Blend);
                if is_translucent || !blends {
                    self.add_part(subject, index, part, layer);
                }
            }
        }
        self.first_blending = self.surfaces.last().map_or(0, Surface::end);
        for (_, place) in &room.blending {
            let wanted = [place.instance, place.mesh];
            if let Ok(index) = self.meshes.binary_search_by_key(&wanted, |mesh| mesh.at) {
                let part = &self.meshes[index].mesh.parts()[place.part];
                self.add_part(subject, index, part, Layer::Base);
            }
        }
        self
    }

    /// Every mesh of the skin that has something to draw.
    fn find_meshes(&mut self, subject: Subject<'a>) {
        let Subject {
            plan,
            picture,
            skin,
        } = subject;
        for (at, instance, mesh, own) in in_order(plan.shown_instances()) {
            if mesh.parts().is_empty() {
                continue;
            }
            // Where no box is known beforehand, the vertices themselves tell.
            let bounds = cull::reach(instance, mesh).or_else(|| {
                let skinned = skin.positions[own.clone()].iter();
                Bounds::of(skinned.map(|position| Vec3::from_array(*position).as_dvec3()))
            });
            self.meshes.push(SkinMesh {
                at,
                rig: instance.rig(),
                mesh,
                own,
                culling: Culling::of(instance, mesh, &picture.scene, bounds),
            });
        }
    }

    /// A part of the mesh of this index.
    fn add_part(&mut self, subject: Subject<'a>, mesh: usize, part: &Part, layer: Layer) {
        let SkinMesh {
            rig,
            mesh,
            ref own,
            culling,
            ..
        } = self.meshes[mesh];
        let own = own.clone();
        let Subject { picture, skin, .. } = subject;
        let coated = Coated::of(rig, mesh, part, &picture.scene.surface);
        let paint = match coated {
            Some(_) => Paint::Coated(self.coated.len() as u32),
            None => Paint::of(rig, mesh, part, picture.scene.surface.variant),
        };
        self.coated.extend(coated);
        for piece in culling.pieces(part) {
            self.add(Surface {
                triangles: &mesh.draw_triangles()[piece.triangles],
                positions: &skin.positions[own.clone()],
                normals: &skin.normals[own.clone()],
                first_vertex: own.start as u32,
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
