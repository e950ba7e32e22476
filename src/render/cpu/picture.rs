//! A picture from plan to pixels, stage after stage. Never lives here: how a stage does its work.

use super::bin::{Chunk, Grid, TILE};
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
use crate::render::cull;
use crate::render::view::View;
use crate::render::{Picture, Plan};
use crate::scene::Bounds;
use fearless_simd::dispatch;
use glam::Vec3;

/// What there is to draw.
#[derive(Clone, Copy)]
struct Subject<'a> {
    plan: &'a Plan,
    picture: &'a Picture,
    /// The vertices of those instances that are shown.
    skin: &'a Vertices,
}

impl Subject<'_> {
    fn is_translucent(self) -> bool {
        self.picture.skin_is_shown && self.picture.scene.show.skin_opacity() < 1.0
    }
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
        let list = emptied(std::mem::take(&mut room.surfaces));
        let surfaces = surfaces(subject, &room, list);
        let geometry = Geometry {
            surfaces: &surfaces,
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
            has_skin_layer: subject.is_translucent(),
            spread,
        };
        // Otherwise not everything was sorted.
        let frame = spread.is_wanted().then(|| self.paint(&picturing, spread));
        let kept = emptied(surfaces);
        (room.chunks, room.surfaces) = (chunks, kept);
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

/// The skeleton first, then the skin, in the memory of `list`.
fn surfaces<'a>(
    subject: Subject<'a>,
    room: &'a Room,
    mut list: Vec<Surface<'a>>,
) -> Vec<Surface<'a>> {
    let mut add = |surface: Surface<'a>| {
        let first_triangle = list.last().map_or(0, Surface::end);
        list.extend((!surface.triangles.is_empty()).then_some(Surface {
            first_triangle,
            ..surface
        }));
    };
    let skeleton = &subject.picture.skeleton;
    let (skin, solids) = (subject.skin, &room.solids);
    let first_solid = skin.positions.len() as u32;
    add(Surface {
        triangles: &room.line_triangles,
        positions: &[],
        normals: &[],
        first_vertex: first_solid + solids.positions.len() as u32,
        paint: Paint::Lines(&skeleton.lines),
        ..Surface::default()
    });
    add(Surface {
        triangles: &skeleton.solids.triangles,
        positions: &solids.positions,
        normals: &solids.normals,
        first_vertex: first_solid,
        paint: Paint::Solids(&skeleton.solids.vertices),
        ..Surface::default()
    });
    let layer = if subject.is_translucent() {
        Layer::Skin
    } else {
        Layer::Base
    };
    for (instance, mesh, own) in in_order(subject.plan.shown_instances()) {
        let positions = &skin.positions[own.clone()];
        // Where no box is known beforehand, the vertices themselves tell.
        let bounds = cull::reach(instance, mesh).or_else(|| {
            let skinned = positions.iter();
            Bounds::of(skinned.map(|position| Vec3::from_array(*position).as_dvec3()))
        });
        for part in cull::parts(instance, mesh, &subject.picture.scene, bounds) {
            add(Surface {
                triangles: &mesh.draw_triangles()[part.triangles],
                positions,
                normals: &skin.normals[own.clone()],
                first_vertex: own.start as u32,
                paint: Paint::of(instance.rig(), mesh),
                layer,
                culled: part.culled,
                ..Surface::default()
            });
        }
    }
    list
}

/// A list without what is in it, as memory for another.
fn emptied<'a>(mut surfaces: Vec<Surface<'_>>) -> Vec<Surface<'a>> {
    surfaces.clear();
    // Collected in place, for nothing changes its size.
    let nothing = surfaces.into_iter();
    nothing.map(|_| unreachable!("it was cleared")).collect()
}
