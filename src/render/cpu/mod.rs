//! The picture without a GPU, stage by stage the twin of `gpu` and `shaders/`: skin, project, sort by tiles, raster, shade, resolve.
//! The same bytes for the same plan on every machine, whatever its threads and its vector unit: see `lanes`.

mod bin;
mod clip;
mod coated;
mod cutout;
mod gather;
mod geometry;
mod interpolate;
mod lanes;
mod lines;
mod overlay;
mod picture;
mod project;
mod raster;
mod resolve;
mod room;
mod samples;
mod shade;
mod skin;
mod skinned;
mod spread;
mod texture;
mod tile;

pub use skin::skin_mesh;
pub use skinned::Skinned;
pub use spread::{Cores, Spread};

use super::{AdapterInfo, AdapterKind, Capabilities, Instance, Outputs, Plan, Wanted};
use crate::frame::{SkinnedVertices, Spare};
use crate::rig::Mesh;
use crate::scene::VertexQuery;
use fearless_simd::Level;
use room::{Room, Rooms};
use skin::SkinJob;
use skinned::Vertices;
use std::sync::Arc;
use tile::TileRoom;

/// Vertices or triangles that one core takes at a time.
const PORTION: usize = 4096;

/// A renderer. Any number of threads may use it at a time; what it keeps is room to work in.
pub struct Cpu {
    level: Level,
    skins: Arc<Rooms<Vertices>>,
    rooms: Arc<Rooms<Room>>,
    tile_rooms: Arc<Rooms<TileRoom>>,
    pixels: Arc<Spare<u8>>,
    numbers: Arc<Spare<f32>>,
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
            skins: Arc::default(),
            rooms: Arc::default(),
            tile_rooms: Arc::default(),
            pixels: Arc::default(),
            numbers: Arc::default(),
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

    /// `None` where it was no longer wanted.
    pub fn render(&self, plan: &Plan, spread: Spread<'_>) -> Option<Outputs> {
        match &plan.wanted {
            Wanted::Picture(picture) => {
                let skinned = self.skin(plan.shown_instances(), spread)?;
                let frame = self.draw(plan, picture, &skinned, spread)?;
                Some(Outputs::Picture(frame))
            }
            Wanted::Vertices(queries) => {
                let of_query =
                    |query: &VertexQuery| self.vertices(&plan.instances[0], query, spread);
                let vertices = queries.iter().map(of_query).collect();
                spread.is_wanted().then_some(Outputs::Vertices(vertices))
            }
        }
    }

    fn vertices(
        &self,
        instance: &Instance,
        query: &VertexQuery,
        spread: Spread<'_>,
    ) -> SkinnedVertices {
        let mut positions = self.numbers.take(3 * query.count);
        let mut normals = query.normals.then(|| self.numbers.take(3 * query.count));
        self.skin_range(
            &SkinJob::new(instance, &instance.rig().meshes()[query.mesh]),
            query.start,
            bytemuck::cast_slice_mut(&mut positions),
            normals.as_deref_mut().map(bytemuck::cast_slice_mut),
            spread,
        );
        SkinnedVertices {
            vertex_count: query.count,
            positions: query.positions.then_some(positions),
            normals,
        }
    }

    fn skin_range(
        &self,
        job: &SkinJob<'_>,
        first: usize,
        positions: &mut [[f32; 3]],
        normals: Option<&mut [[f32; 3]]>,
        spread: Spread<'_>,
    ) {
        let start = |index: usize| first + index * PORTION;
        match normals {
            Some(normals) => {
                spread.pairs_of_portions(
                    positions,
                    normals,
                    PORTION,
                    |index, positions, normals| {
                        job.run(self.level, start(index), positions, Some(normals));
                    },
                );
            }
            None => spread.portions(positions, PORTION, |index, positions| {
                job.run(self.level, start(index), positions, None);
            }),
        }
    }

    /// Lets go of memory that is kept for pictures to come.
    pub fn sweep(&self) {
        self.skins.clear();
        self.rooms.clear();
        self.tile_rooms.clear();
    }
}

impl<'a> SkinJob<'a> {
    fn new(instance: &'a Instance, mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            palette: instance.palette(),
            morph_weights: instance.morph_weights(),
        }
    }
}

#[cfg(test)]
mod tests;
