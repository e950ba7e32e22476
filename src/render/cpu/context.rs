//! What the tiles of a picture are drawn from, and on. Never lives here: how.

use super::bin::{Chunk, seen};
use super::geometry::{Geometry, Place};
use super::grid::{Grid, Rectangle, TILE};
use super::parallelism::Parallelism;
use super::project::Projected;
use super::raster::Footprint;
use super::resolve::Resolve;
use super::samples::Pattern;
use crate::render::instance_params::InstanceParams;
use crate::render::view::View;
use fearless_simd::prelude::*;

/// What every tile of a picture is drawn from.
pub(super) struct PictureContext<'a> {
    pub geometry: Geometry<'a>,
    pub chunks: &'a [Chunk],
    pub grid: Grid,
    pub pattern: Pattern,
    pub view: &'a View,
    /// What surfaces without a material of their own have in common, where `has_materials` does not hold.
    pub plain: &'a InstanceParams,
    /// Whether each fragment has a material of its own.
    pub has_materials: bool,
    pub resolve: Resolve,
    pub has_skin_layer: bool,
    pub parallelism: Parallelism<'a>,
}

/// What triangles of a tile are drawn on.
pub(super) struct TileCanvas<'a, S: Simd> {
    pub picture: &'a PictureContext<'a>,
    pub footprint: Footprint<S>,
    /// The picture's pixels.
    pub tile: Rectangle,
}

impl<'a, S: Simd> TileCanvas<'a, S> {
    /// Of tile (`column`, `row`).
    #[inline(always)]
    pub(super) fn of(simd: S, picture: &'a PictureContext<'a>, [column, row]: [u32; 2]) -> Self {
        let corner = [column * TILE[0], row * TILE[1]];
        Self {
            picture,
            footprint: Footprint::of(simd, picture.pattern),
            tile: Rectangle {
                min: corner,
                max: [corner[0] + TILE[0] - 1, corner[1] + TILE[1] - 1],
            },
        }
    }

    /// The pixels of the tile that a triangle may cover, if there are any.
    #[inline(always)]
    pub(super) fn reached(&self, corners: [Projected; 3], place: Place<'_>) -> Option<Rectangle> {
        let Self { picture, tile, .. } = self;
        let reached = seen(corners, place, &picture.grid, picture.pattern)?;
        let reached = reached.within(tile.min, tile.max);
        (!reached.is_empty()).then_some(reached)
    }
}
