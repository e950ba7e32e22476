//! A picture from plan to pixels, stage after stage. Never lives here: how a stage does its work.

use super::bin::Chunk;
use super::context::PictureContext;
use super::geometry::Geometry;
use super::grid::{Grid, TILE};
use super::instance::DrawnInstance;
use super::lines;
use super::picture_scratch::{PictureScratch, Subject};
use super::project::Projection;
use super::resolve::Resolve;
use super::samples::Pattern;
use super::skinned::Skinned;
use super::surfaces::Surfaces;
use super::{Cpu, PORTION, Parallelism};
use crate::frame::{ImageKind, Raster};
use crate::render::Plan;
use crate::render::instance_params::InstanceParams;
use crate::render::order::blending_parts;
use crate::render::view::View;
use crate::scene::Scene;
use bytemuck::Zeroable;
use fearless_simd::dispatch;

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
        let Surfaces {
            surfaces,
            materials,
            first_blending,
            ..
        } = Surfaces::of(subject, &scratch);
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
        let mut bytes = self.bytes.take_list(kind.bytes(size));
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
