//! The picture without a GPU, stage by stage in parity with `gpu` and `shaders/`: skin, project, sort by tiles, raster, shade, resolve.
//! The same bytes for the same plan on every machine, whatever its threads and its vector unit: see `lanes`.

mod alpha_test;
mod bin;
mod block;
mod clip;
mod context;
mod gather;
mod geometry;
mod grid;
mod instance;
mod interpolate;
mod lanes;
mod lines;
mod material;
mod overlay;
mod parallelism;
mod picture;
mod picture_scratch;
mod project;
mod raster;
mod resolve;
mod samples;
mod shade;
mod skin;
mod skinned;
mod surfaces;
mod texture;
mod tile;
mod triangle;

pub use parallelism::{Cores, Parallelism};
pub use skin::skin_mesh;
pub use skinned::Skinned;

use super::{Capabilities, Plan, Skin};
use crate::adapter::{AdapterInfo, AdapterKind};
use crate::frame::{ImageKind, Outputs, Pool, SkinnedVertices};
use crate::rig::Mesh;
use crate::scene::VertexQuery;
use fearless_simd::Level;
use picture_scratch::PictureScratch;
use skin::SkinJob;
use skinned::Vertices;
use std::sync::Arc;
use tile::TileScratch;

/// Vertices or triangles that one core takes at a time.
const PORTION: usize = 4096;

/// A renderer. Any number of threads may use it at a time; what it keeps is scratch memory.
pub struct Cpu {
    level: Level,
    skins: Arc<Pool<Vertices>>,
    pictures: Arc<Pool<PictureScratch>>,
    tiles: Arc<Pool<TileScratch>>,
    bytes: Arc<Pool<Vec<u8>>>,
    numbers: Arc<Pool<Vec<f32>>>,
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
            pictures: Arc::default(),
            tiles: Arc::default(),
            bytes: Arc::new(Pool::of_lists()),
            numbers: Arc::new(Pool::of_lists()),
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

    /// `None` where it was cancelled.
    pub fn render(&self, plan: &Plan, parallelism: Parallelism<'_>) -> Option<Outputs> {
        let skinned = match plan.image {
            Some(_) => Some(self.skin(plan, parallelism)?),
            None => None,
        };
        self.outputs(plan, skinned.as_ref(), parallelism)
    }

    /// Of a plan with a picture, `skinned` are at least the skins that this [shows](Plan::drawn). Queries read them too, as far as they
    /// ask for the same skins. `None` where it was cancelled.
    pub fn outputs(
        &self,
        plan: &Plan,
        skinned: Option<&Skinned>,
        parallelism: Parallelism<'_>,
    ) -> Option<Outputs> {
        let mut outputs = Outputs::default();
        if let (Some(image), Some(skinned)) = (&plan.image, skinned) {
            for kind in &image.outputs {
                outputs.images.push(match kind {
                    ImageKind::Color => self.color(plan, &image.scene, skinned, parallelism)?,
                });
            }
        }
        for query in &plan.vertices {
            let skin = plan.instances[query.instance].skin();
            outputs
                .vertices
                .push(self.vertices(skin, query, skinned, parallelism));
        }
        (!parallelism.is_cancelled()).then_some(outputs)
    }

    fn vertices(
        &self,
        skin: &Skin,
        query: &VertexQuery,
        skinned: Option<&Skinned>,
        parallelism: Parallelism<'_>,
    ) -> SkinnedVertices {
        let kept = skinned.and_then(|skinned| {
            let vertices = skinned.vertices();
            let own = vertices.range_of(skin)?;
            let (_, of_mesh) = skinned::meshes(skin, own.start).nth(query.mesh)?;
            let first = of_mesh.start + query.start;
            let range = first..first + query.count;
            Some((&vertices.positions[range.clone()], &vertices.normals[range]))
        });
        let copied = |from: &[[f32; 3]]| {
            let mut numbers = self.numbers.take_list(from.as_flattened().len());
            numbers.copy_from_slice(from.as_flattened());
            numbers
        };
        match kept {
            Some((positions, normals)) => SkinnedVertices {
                vertex_count: query.count,
                positions: query.positions.then(|| copied(positions)),
                normals: query.normals.then(|| copied(normals)),
            },
            None => self.skin_query(skin, query, parallelism),
        }
    }

    /// Positions and normals of the vertices that are asked for, and of no others.
    fn skin_query(
        &self,
        skin: &Skin,
        query: &VertexQuery,
        parallelism: Parallelism<'_>,
    ) -> SkinnedVertices {
        let mut positions = self.numbers.take_list(3 * query.count);
        let mut normals = query
            .normals
            .then(|| self.numbers.take_list(3 * query.count));
        self.skin_range(
            &SkinJob::new(skin, &skin.rig().meshes()[query.mesh]),
            query.start,
            bytemuck::cast_slice_mut(&mut positions),
            normals
                .as_deref_mut()
                .map(|normals| bytemuck::cast_slice_mut(normals)),
            parallelism,
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
        parallelism: Parallelism<'_>,
    ) {
        let start = |index: usize| first + index * PORTION;
        match normals {
            Some(normals) => {
                parallelism.pairs_of_portions(
                    positions,
                    normals,
                    PORTION,
                    |index, positions, normals| {
                        job.run(self.level, start(index), positions, Some(normals));
                    },
                );
            }
            None => parallelism.portions(positions, PORTION, |index, positions| {
                job.run(self.level, start(index), positions, None);
            }),
        }
    }

    /// Lets go of memory that is kept for pictures to come.
    pub fn sweep(&self) {
        self.skins.clear();
        self.pictures.clear();
        self.tiles.clear();
        self.bytes.clear();
        self.numbers.clear();
    }
}

impl<'a> SkinJob<'a> {
    fn new(skin: &'a Skin, mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            palette: skin.palette(),
            morph_weights: skin.morph_weights(),
        }
    }
}

#[cfg(test)]
mod tests;
