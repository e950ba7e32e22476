//! The picture without a GPU, stage by stage the twin of `gpu` and `shaders/`: skin, project, sort by tiles, raster, shade, resolve.
//! The same bytes for the same plan on every machine, whatever its threads and its vector unit: see `lanes`.

mod bin;
mod clip;
mod geometry;
mod interpolate;
mod lanes;
mod lines;
mod project;
mod raster;
mod resolve;
mod room;
mod samples;
mod shade;
mod skin;
mod texture;
mod tile;

pub use skin::skin_mesh;

use super::cull;
use super::view::View;
use super::{AdapterInfo, AdapterKind, Capabilities};
use super::{Instance, Outputs, Picture, Plan, Wanted};
use crate::frame::{Frame, SkinnedVertices, SparePixels};
use crate::rig::Mesh;
use crate::scene::{Bounds, VertexQuery};
use bin::{Chunk, Grid, TILE};
use fearless_simd::{Level, dispatch};
use geometry::{Geometry, Layer, Paint, Surface};
use glam::Vec3;
use project::{Projected, Projection};
use rayon::prelude::*;
use resolve::Resolve;
use room::{Room, Rooms};
use samples::Pattern;
use skin::SkinJob;
use std::sync::Arc;
use tile::{Picturing, TileRoom};

/// How many cores one plan is worked on by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// This thread's: for many plans at a time.
    OneCore,
    /// All of the thread pool that the caller runs in: for a lone one.
    AllCores,
}

/// Vertices or triangles that one core takes at a time.
const PORTION: usize = 4096;

/// A renderer. Any number of threads may use it at a time; what it keeps is room to work in.
pub struct Cpu {
    level: Level,
    rooms: Rooms<Room>,
    tile_rooms: Rooms<TileRoom>,
    pixels: Arc<SparePixels>,
}

impl Default for Cpu {
    fn default() -> Self {
        Self::with(Level::new())
    }
}

impl Cpu {
    /// With the vector unit of `level`.
    fn with(level: Level) -> Self {
        Self {
            level,
            rooms: Rooms::default(),
            tile_rooms: Rooms::default(),
            pixels: Arc::default(),
        }
    }

    /// Sides are bounded by what fixed point holds.
    pub const CAPABILITIES: Capabilities = Capabilities {
        side: 16_384,
        buffer_bytes: None,
    };

    /// What it says of itself, with so many threads.
    pub fn info(threads: usize) -> AdapterInfo {
        let level = format!("{:?}", Level::new()).to_lowercase();
        let unit = level.split('(').next().unwrap_or_default();
        let plural = if threads == 1 { "" } else { "s" };
        AdapterInfo {
            name: "rigd's own renderer".to_owned(),
            backend: "cpu",
            kind: AdapterKind::Cpu,
            driver: format!(
                "rigd {}, {unit}, {threads} thread{plural}",
                env!("CARGO_PKG_VERSION")
            ),
            why: None,
        }
    }

    pub fn render(&self, plan: &Plan, spread: Spread) -> Outputs {
        match &plan.wanted {
            Wanted::Picture(picture) => {
                Outputs::Picture(self.picture(&plan.instances, picture, spread))
            }
            Wanted::Vertices(queries) => {
                let of_query =
                    |query: &VertexQuery| self.vertices(&plan.instances[0], query, spread);
                Outputs::Vertices(queries.iter().map(of_query).collect())
            }
        }
    }

    fn vertices(
        &self,
        instance: &Instance,
        query: &VertexQuery,
        spread: Spread,
    ) -> SkinnedVertices {
        let mut positions = vec![0.0f32; 3 * query.count];
        let mut normals = positions.clone();
        self.skin(
            &SkinJob::new(instance, &instance.rig().meshes()[query.mesh]),
            query.start,
            bytemuck::cast_slice_mut(&mut positions),
            bytemuck::cast_slice_mut(&mut normals),
            spread,
        );
        SkinnedVertices {
            vertex_count: query.count,
            positions: query.positions.then_some(positions),
            normals: query.normals.then_some(normals),
        }
    }

    fn skin(
        &self,
        job: &SkinJob<'_>,
        first: usize,
        positions: &mut [[f32; 3]],
        normals: &mut [[f32; 3]],
        spread: Spread,
    ) {
        if spread == Spread::OneCore || positions.len() <= PORTION {
            return job.run(self.level, first, positions, normals);
        }
        let portions = positions
            .par_chunks_mut(PORTION)
            .zip(normals.par_chunks_mut(PORTION));
        portions
            .enumerate()
            .for_each(|(index, (positions, normals))| {
                job.run(self.level, first + index * PORTION, positions, normals);
            });
    }

    fn picture(&self, instances: &[Instance], picture: &Picture, spread: Spread) -> Frame {
        let view = View::of(picture);
        let projection = Projection::of(&view);
        let mut room = self.rooms.take();
        let Room {
            positions,
            normals,
            projected,
            line_corners,
            line_triangles,
            chunks,
            surfaces,
        } = &mut *room;

        // Vertices: of skin, of solids, of lines.
        let shown = || {
            let shown = instances.iter().filter(|_| picture.skin_is_shown);
            shown.flat_map(|instance| {
                instance
                    .rig()
                    .meshes()
                    .iter()
                    .map(move |mesh| (instance, mesh))
            })
        };
        let solids = &picture.skeleton.solids;
        let skin_vertices: usize = shown().map(|(_, mesh)| mesh.vertex_count()).sum();
        let in_world = skin_vertices + solids.vertices.len();
        lines::lay_out(
            &picture.skeleton.lines,
            &projection,
            line_corners,
            line_triangles,
        );
        positions.resize(in_world, [0.0; 3]);
        normals.resize(in_world, [0.0; 3]);
        projected.resize(in_world + line_corners.len(), Projected::default());
        let mut first = 0;
        for (instance, mesh) in shown() {
            let end = first + mesh.vertex_count();
            let job = SkinJob::new(instance, mesh);
            self.skin(
                &job,
                0,
                &mut positions[first..end],
                &mut normals[first..end],
                spread,
            );
            first = end;
        }
        for (index, vertex) in (skin_vertices..).zip(&solids.vertices) {
            positions[index] = vertex.position.to_array();
            normals[index] = vertex.normal.to_array();
        }
        let (of_world, of_lines) = projected.split_at_mut(in_world);
        match spread {
            Spread::OneCore => projection.project(self.level, positions, of_world),
            Spread::AllCores => {
                let portions = positions
                    .par_chunks(PORTION)
                    .zip(of_world.par_chunks_mut(PORTION));
                portions.for_each(|(positions, projected)| {
                    projection.project(self.level, positions, projected);
                });
            }
        }
        for (projected, corner) in of_lines.iter_mut().zip(&*line_corners) {
            *projected = projection.place_of(*corner);
        }

        // Triangles: the skeleton first, then the skin.
        let is_translucent = picture.skin_is_shown && picture.scene.show.skin_opacity() < 1.0;
        let mut list: Vec<Surface<'_>> = emptied(std::mem::take(surfaces));
        let mut add = |triangles, first_vertex: usize, paint, layer, culled| {
            let first_triangle = list.last().map_or(0, Surface::end);
            let is_empty = <[[u32; 3]]>::is_empty(triangles);
            list.extend((!is_empty).then_some(Surface {
                triangles,
                first_triangle,
                first_vertex: first_vertex as u32,
                paint,
                layer,
                culled,
            }));
        };
        add(
            line_triangles,
            in_world,
            Paint::Lines(&picture.skeleton.lines),
            Layer::Base,
            None,
        );
        add(
            &solids.triangles,
            skin_vertices,
            Paint::Solids(&solids.vertices),
            Layer::Base,
            None,
        );
        let layer = if is_translucent {
            Layer::Skin
        } else {
            Layer::Base
        };
        let mut first = 0;
        for (instance, mesh) in shown() {
            let end = first + mesh.vertex_count();
            // Where no box is known beforehand, the vertices themselves tell.
            let bounds = cull::reach(instance, mesh).or_else(|| {
                let skinned = positions[first..end].iter();
                Bounds::of(skinned.map(|position| Vec3::from_array(*position).as_dvec3()))
            });
            let culled = cull::unseen(instance, mesh, &picture.scene, bounds);
            add(
                mesh.draw_triangles(),
                first,
                Paint::of(instance.rig(), mesh),
                layer,
                culled,
            );
            first = end;
        }
        let geometry = Geometry {
            surfaces: &list,
            projected,
            positions,
            normals,
            line_corners,
        };

        let grid = Grid::of(picture.scene.size);
        let pattern = Pattern::of(picture.scene.samples);
        let triangles = geometry.triangle_count();
        let portions = match spread {
            Spread::OneCore => 1,
            Spread::AllCores => triangles
                .div_ceil(PORTION)
                .clamp(1, 4 * rayon::current_num_threads()),
        };
        let portion = triangles.div_ceil(portions).max(1) as u32;
        if chunks.len() < portions {
            chunks.resize_with(portions, Chunk::default);
        }
        let chunks = &mut chunks[..portions];
        let fill = |(index, chunk): (usize, &mut Chunk)| {
            let start = index as u32 * portion;
            chunk.fill(
                &geometry,
                start..start + portion,
                &projection,
                &grid,
                pattern,
            );
        };
        match spread {
            Spread::OneCore => chunks.iter_mut().enumerate().for_each(fill),
            Spread::AllCores => chunks.par_iter_mut().enumerate().for_each(fill),
        }

        let picturing = Picturing {
            geometry,
            chunks,
            grid,
            pattern,
            view: &view,
            resolve: Resolve {
                background: picture.scene.background.premultiplied().to_array(),
                sample_count: pattern.count(),
                opacity: view.opacity,
            },
            has_skin_layer: is_translucent,
        };
        let size = picture.scene.size;
        let mut pixels = self.pixels.take(4 * size.pixels());
        let band_bytes = 4 * size.width as usize * TILE[1] as usize;
        let draw = |tile_room: &mut TileRoom, (row, band): (usize, &mut [u8])| {
            for column in 0..grid.columns {
                dispatch!(self.level, simd => tile_room.draw(simd, &picturing, [column, row as u32], band));
            }
        };
        match spread {
            Spread::OneCore => {
                let mut tile_room = self.tile_rooms.take();
                let bands = pixels.chunks_mut(band_bytes).enumerate();
                bands.for_each(|band| draw(&mut tile_room, band));
            }
            Spread::AllCores => {
                let bands = pixels.par_chunks_mut(band_bytes).enumerate();
                bands.for_each_init(
                    || self.tile_rooms.take(),
                    |tile_room, band| draw(tile_room, band),
                );
            }
        }
        *surfaces = emptied(list);
        Frame { size, pixels }
    }

    /// Lets go of memory that is kept for pictures to come.
    pub fn sweep(&self) {
        self.rooms.clear();
        self.tile_rooms.clear();
    }
}

/// A list without what is in it, as memory for another.
fn emptied<'a>(mut surfaces: Vec<Surface<'_>>) -> Vec<Surface<'a>> {
    surfaces.clear();
    // Collected in place, for nothing changes its size.
    let nothing = surfaces.into_iter();
    nothing.map(|_| unreachable!("it was cleared")).collect()
}

impl<'a> SkinJob<'a> {
    fn new(instance: &'a Instance, mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            palette: &instance.palette,
            morph_weights: &instance.morph_weights,
        }
    }
}

#[cfg(test)]
mod tests;
