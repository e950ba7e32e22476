//! A picture from plan to pixels, stage after stage. Never lives here: how a stage does its work.

use super::bin::{Chunk, Grid, TILE};
use super::geometry::{Geometry, Layer, Paint, Surface};
use super::lines;
use super::project::{Projected, Projection};
use super::resolve::Resolve;
use super::room::Room;
use super::samples::Pattern;
use super::skin::SkinJob;
use super::tile::Picturing;
use super::{Cpu, PORTION, Spread};
use crate::frame::Frame;
use crate::render::cull;
use crate::render::view::View;
use crate::render::{Instance, Picture};
use crate::rig::Mesh;
use crate::scene::Bounds;
use fearless_simd::dispatch;
use glam::Vec3;

/// What there is to draw.
#[derive(Clone, Copy)]
struct Subject<'a> {
    instances: &'a [Instance],
    picture: &'a Picture,
}

impl<'a> Subject<'a> {
    /// The meshes that are shown.
    fn skin(self) -> impl Iterator<Item = (&'a Instance, &'a Mesh)> {
        let is_shown = self.picture.skin_is_shown;
        let instances = self.instances.iter().filter(move |_| is_shown);
        instances.flat_map(|instance| {
            let meshes = instance.rig().meshes().iter();
            meshes.map(move |mesh| (instance, mesh))
        })
    }

    fn skin_vertices(self) -> usize {
        self.skin().map(|(_, mesh)| mesh.vertex_count()).sum()
    }

    fn is_translucent(self) -> bool {
        self.picture.skin_is_shown && self.picture.scene.show.skin_opacity() < 1.0
    }
}

impl Cpu {
    /// `None` where it was no longer wanted.
    pub(super) fn draw(
        &self,
        instances: &[Instance],
        picture: &Picture,
        spread: Spread<'_>,
    ) -> Option<Frame> {
        let subject = Subject { instances, picture };
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
            positions: &room.positions,
            normals: &room.normals,
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

    /// Every vertex: of the skin, of solids, of lines.
    fn place(
        &self,
        subject: Subject<'_>,
        projection: &Projection,
        room: &mut Room,
        spread: Spread<'_>,
    ) {
        let skeleton = &subject.picture.skeleton;
        let skin_vertices = subject.skin_vertices();
        let in_world = skin_vertices + skeleton.solids.vertices.len();
        lines::lay_out(
            &skeleton.lines,
            projection,
            &mut room.line_corners,
            &mut room.line_triangles,
        );
        let (positions, normals) = (&mut room.positions, &mut room.normals);
        positions.resize(in_world, [0.0; 3]);
        normals.resize(in_world, [0.0; 3]);
        let mut first = 0;
        for (instance, mesh) in subject.skin() {
            let own = first..first + mesh.vertex_count();
            let job = SkinJob::new(instance, mesh);
            self.skin(
                &job,
                0,
                &mut positions[own.clone()],
                &mut normals[own.clone()],
                spread,
            );
            first = own.end;
        }
        for (index, vertex) in (skin_vertices..).zip(&skeleton.solids.vertices) {
            positions[index] = vertex.position.to_array();
            normals[index] = vertex.normal.to_array();
        }
        let all = in_world + room.line_corners.len();
        room.projected.resize(all, Projected::default());
        let (of_world, of_lines) = room.projected.split_at_mut(in_world);
        let positions = &*positions;
        spread.portions(of_world, PORTION, |index, projected| {
            let own = &positions[index * PORTION..][..projected.len()];
            projection.project(self.level, own, projected);
        });
        for (projected, corner) in of_lines.iter_mut().zip(&room.line_corners) {
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
    let mut add = |triangles: &'a [[u32; 3]], first_vertex: usize, paint, layer, culled| {
        let first_triangle = list.last().map_or(0, Surface::end);
        list.extend((!triangles.is_empty()).then_some(Surface {
            triangles,
            first_triangle,
            first_vertex: first_vertex as u32,
            paint,
            layer,
            culled,
        }));
    };
    let skeleton = &subject.picture.skeleton;
    let (lines, solids) = (&skeleton.lines, &skeleton.solids);
    let (of_lines, of_solids) = (room.positions.len(), subject.skin_vertices());
    add(
        &room.line_triangles,
        of_lines,
        Paint::Lines(lines),
        Layer::Base,
        None,
    );
    add(
        &solids.triangles,
        of_solids,
        Paint::Solids(&solids.vertices),
        Layer::Base,
        None,
    );
    let layer = if subject.is_translucent() {
        Layer::Skin
    } else {
        Layer::Base
    };
    let mut first = 0;
    for (instance, mesh) in subject.skin() {
        let end = first + mesh.vertex_count();
        // Where no box is known beforehand, the vertices themselves tell.
        let bounds = cull::reach(instance, mesh).or_else(|| {
            let skinned = room.positions[first..end].iter();
            Bounds::of(skinned.map(|position| Vec3::from_array(*position).as_dvec3()))
        });
        let paint = Paint::of(instance.rig(), mesh);
        for part in cull::parts(instance, mesh, &subject.picture.scene, bounds) {
            let triangles = &mesh.draw_triangles()[part.triangles];
            add(triangles, first, paint, layer, part.culled);
        }
        first = end;
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
