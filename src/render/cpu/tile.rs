//! One tile from empty samples to pixels: raster, lay over it what blends, then for each block gather, shade and resolve.
//! Never lives here: the stages themselves.

use super::alpha_test::AlphaTest;
use super::bin::seen;
use super::block::shade_shown;
use super::context::{PictureContext, TileCanvas};
use super::gather::{Drawn, Triangles};
use super::geometry::{Geometry, Paint, Place};
use super::grid::TILE;
use super::lanes::LANES;
use super::material::PartMaterial;
use super::overlay::{Overlay, Under};
use super::project::Projected;
use super::raster::{self, CoverageTest, Mark, Nearest, Opaque};
use super::resolve::Sums;
use super::samples::{BLOCK, BLOCK_COLUMNS, BLOCK_PIXELS, Layer, NONE, TileSamples};
use super::shade::Fragments;
use super::triangle::Corner;
use fearless_simd::prelude::*;

/// Triangles of a tile, of which there are thousands of samples: beyond that, hidden ones are forgotten.
const MOST_DRAWN: usize = 1 << 16;

/// What one thread draws tiles in. Kept from picture to picture.
#[derive(Default)]
pub(super) struct TileScratch {
    samples: TileSamples,
    triangles: Triangles,
    /// New numbers by old ones.
    renumbered: Vec<u32>,
    fragments: Fragments,
    overlay: Overlay,
    base: Sums,
    skin: Sums,
}

impl TileScratch {
    /// Draws tile (`column`, `row`) into `band`, the rows of the picture that tiles of that row cover.
    #[inline(always)]
    pub(super) fn draw<S: Simd>(
        &mut self,
        simd: S,
        picture: &PictureContext<'_>,
        [column, row]: [u32; 2],
        band: &mut [u8],
    ) {
        let corner = [column * TILE[0], row * TILE[1]];
        self.raster(simd, picture, [column, row]);
        if picture.geometry.blends() {
            let under = Under {
                samples: &mut self.samples,
                triangles: &mut self.triangles,
                fragments: &mut self.fragments,
            };
            self.overlay.draw(simd, picture, [column, row], under);
        }
        let size = picture.grid.size;
        let width = TILE[0].min(size.width - corner[0]);
        let height = TILE[1].min(size.height - corner[1]);
        let empty = [picture.resolve.empty(simd); BLOCK_PIXELS];
        for block_row in 0..height.div_ceil(BLOCK) {
            for block_column in 0..width.div_ceil(BLOCK) {
                let at = [block_column * BLOCK, block_row * BLOCK];
                let block = (block_row * BLOCK_COLUMNS + block_column) as usize;
                let at_in_picture = [corner[0] + at[0], corner[1] + at[1]];
                let mut pixels = empty;
                if self.sum_up(simd, picture, block, at_in_picture) {
                    let skin = picture.has_skin_layer.then_some(&self.skin);
                    let rows = pixels.as_chunks_mut::<LANES>().0.iter_mut();
                    for (index, rows) in rows.enumerate() {
                        *rows = picture.resolve.rows(simd, &self.base, skin, index);
                    }
                }
                let columns = BLOCK.min(width - at[0]) as usize;
                for row in 0..BLOCK.min(height - at[1]) {
                    let start =
                        (at[1] + row) as usize * size.width as usize + (corner[0] + at[0]) as usize;
                    let row = &pixels[(row * BLOCK) as usize..][..columns];
                    let into = &mut band[4 * start..4 * (start + columns)];
                    for (into, pixel) in into.as_chunks_mut::<4>().0.iter_mut().zip(row) {
                        *into = pixel.to_le_bytes();
                    }
                }
            }
        }
    }

    /// Every triangle of the tile that does not blend into its samples.
    #[inline(always)]
    fn raster<S: Simd>(&mut self, simd: S, picture: &PictureContext<'_>, [column, row]: [u32; 2]) {
        self.samples.clear(picture.pattern);
        self.triangles.clear();
        let canvas = TileCanvas::of(simd, picture, [column, row]);
        let geometry = &picture.geometry;
        for chunk in picture.chunks {
            let of_tile = chunk.of_tile([column, row], &picture.grid);
            for triangle in of_tile.before(geometry.first_blending) {
                if self.triangles.drawn.len() >= MOST_DRAWN {
                    if picture.parallelism.is_cancelled() {
                        return;
                    }
                    self.forget_hidden();
                }
                let place = geometry.place(triangle);
                let drawn = Drawn {
                    triangle,
                    piece: 0,
                    setup: NONE,
                };
                if let Some(material) = masked(geometry, place) {
                    self.masked(simd, &canvas, place, drawn, material);
                    continue;
                }
                let corners = geometry.projected_of(place);
                let [a, b, c] = corners;
                if !(a.is_beyond() || b.is_beyond() || c.is_beyond()) {
                    self.triangle(&canvas, place, drawn, corners, &Opaque);
                    continue;
                }
                for (piece, corners) in (0..).zip(geometry.pieces(place)) {
                    let drawn = Drawn { piece, ..drawn };
                    let corners = corners.map(|corner| corner.projected);
                    self.triangle(&canvas, place, drawn, corners, &Opaque);
                }
            }
        }
    }

    /// A triangle, or a piece of one, into the samples of the tile.
    #[inline(always)]
    fn triangle<S: Simd, P: CoverageTest>(
        &mut self,
        canvas: &TileCanvas<'_, S>,
        place: Place<'_>,
        drawn: Drawn,
        corners: [Projected; 3],
        test: &P,
    ) {
        let TileCanvas {
            footprint, tile, ..
        } = canvas;
        let Some(reached) = canvas.reached(corners, place) else {
            return;
        };
        let mark = Mark {
            layer: place.surface.layer,
            number: self.triangles.drawn.len() as u32,
        };
        self.triangles.drawn.push(drawn);
        let target = Nearest {
            tile: &mut self.samples,
            mark,
        };
        raster::draw(footprint, target, tile.min, corners, reached, test);
    }

    /// A triangle with holes, whole or in pieces. By itself, so that it does not lie in the way of all those without.
    #[inline(never)]
    fn masked<S: Simd>(
        &mut self,
        simd: S,
        canvas: &TileCanvas<'_, S>,
        place: Place<'_>,
        drawn: Drawn,
        material: &PartMaterial<'_>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let TileCanvas { picture, .. } = canvas;
                let geometry = &picture.geometry;
                let whole = geometry.corners_of_whole(place);
                let mut draw = |drawn: Drawn, corners: [Corner; 3]| {
                    let projected = corners.map(|corner| corner.projected);
                    if seen(projected, place, &picture.grid, picture.pattern).is_some() {
                        let alpha_test = AlphaTest::of(simd, material, &corners);
                        self.triangle(canvas, place, drawn, projected, &alpha_test);
                    }
                };
                if whole.iter().any(|corner| corner.projected.is_beyond()) {
                    for (piece, corners) in (0..).zip(geometry.pieces(place)) {
                        draw(Drawn { piece, ..drawn }, corners);
                    }
                } else {
                    draw(drawn, whole);
                }
            },
        );
    }

    /// Numbers those triangles anew that samples show.
    fn forget_hidden(&mut self) {
        let Self {
            samples,
            triangles: Triangles { drawn, .. },
            renumbered,
            ..
        } = self;
        renumbered.clear();
        renumbered.resize(drawn.len(), NONE);
        for number in samples.shown_mut() {
            // Which one is found out below.
            renumbered[*number as usize] = 0;
        }
        let mut kept = 0;
        for (old, new) in renumbered.iter_mut().enumerate() {
            if *new != NONE {
                drawn[kept] = drawn[old];
                *new = kept as u32;
                kept += 1;
            }
        }
        drawn.truncate(kept);
        for number in samples.shown_mut() {
            *number = renumbered[*number as usize];
        }
    }

    /// Sums up what the samples of a block show, `at` the picture's pixel of its upper left corner; whether there is anything.
    #[inline(always)]
    fn sum_up<S: Simd>(
        &mut self,
        simd: S,
        picture: &PictureContext<'_>,
        block: usize,
        at: [u32; 2],
    ) -> bool {
        if picture.geometry.blends() {
            let samples = picture.pattern.count();
            if let Some(colors) = self.overlay.colors(block, samples) {
                self.base = Sums::of_samples(simd, samples, colors);
                return true;
            }
        }
        let layers = [(Layer::Base, true), (Layer::Skin, picture.has_skin_layer)];
        for (layer, is_drawn) in layers {
            if !is_drawn {
                continue;
            }
            let Some(shown) = self.samples.shown(block, layer) else {
                return false;
            };
            let gather = self.triangles.gather(picture, at, &mut self.fragments);
            shade_shown(simd, picture, gather, shown);
            let sums = match layer {
                Layer::Base => &mut self.base,
                Layer::Skin => &mut self.skin,
            };
            sums.clear();
            sums.add(simd, &self.fragments);
        }
        true
    }
}

/// The material of a triangle's surface, if that has holes.
#[inline(always)]
fn masked<'a>(geometry: &Geometry<'a>, place: Place<'_>) -> Option<&'a PartMaterial<'a>> {
    match place.surface.paint {
        Paint::Material(material) => {
            let material = &geometry.materials[material as usize];
            material.has_holes().then_some(material)
        }
        _ => None,
    }
}
