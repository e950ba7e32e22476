//! One tile from empty samples to pixels: raster, then for each block gather, shade and resolve.
//! Never lives here: the stages themselves.

use super::bin::{Chunk, Grid, Rectangle, TILE, seen};
use super::gather::{Drawn, Gather, LookedUp};
use super::geometry::{Geometry, Layer, Place};
use super::lanes::LANES;
use super::project::Projected;
use super::raster::{self, Footprint};
use super::resolve::{Resolve, Sums};
use super::samples::{BLOCK, BLOCK_COLUMNS, BLOCK_PIXELS, NONE, Pattern, TileSamples};
use super::shade::{Fragments, shade};
use super::spread::Spread;
use crate::render::view::View;
use fearless_simd::prelude::*;

/// What every tile of a picture is drawn from.
pub(super) struct Picturing<'a> {
    pub geometry: Geometry<'a>,
    pub chunks: &'a [Chunk],
    pub grid: Grid,
    pub pattern: Pattern,
    pub view: &'a View,
    pub resolve: Resolve,
    pub has_skin_layer: bool,
    pub spread: Spread<'a>,
}

/// Triangles of a tile, of which there are thousands of samples: beyond that, hidden ones are forgotten.
const MOST_DRAWN: usize = 1 << 16;

/// The room that one thread draws tiles in. Kept from picture to picture.
#[derive(Default)]
pub(super) struct TileRoom {
    samples: TileSamples,
    /// By the numbers that samples keep.
    drawn: Vec<Drawn>,
    /// New numbers by old ones.
    renumbered: Vec<u32>,
    looked_up: Vec<LookedUp>,
    fragments: Fragments,
    base: Sums,
    skin: Sums,
}

impl TileRoom {
    /// Draws tile (`column`, `row`) into `band`, the rows of the picture that tiles of that row cover.
    #[inline(always)]
    pub fn draw<S: Simd>(
        &mut self,
        simd: S,
        picture: &Picturing<'_>,
        [column, row]: [u32; 2],
        band: &mut [u8],
    ) {
        let corner = [column * TILE[0], row * TILE[1]];
        self.raster(simd, picture, [column, row]);
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

    /// Every triangle of the tile into its samples.
    #[inline(always)]
    fn raster<S: Simd>(&mut self, simd: S, picture: &Picturing<'_>, [column, row]: [u32; 2]) {
        self.samples.clear(picture.pattern);
        self.drawn.clear();
        self.looked_up.clear();
        let footprint = Footprint::of(simd, picture.pattern);
        let corner = [column * TILE[0], row * TILE[1]];
        let last = [corner[0] + TILE[0] - 1, corner[1] + TILE[1] - 1];
        let tile = Rectangle {
            min: corner,
            max: last,
        };
        let geometry = &picture.geometry;
        for chunk in picture.chunks {
            for triangle in chunk.of_tile([column, row], &picture.grid) {
                if self.drawn.len() >= MOST_DRAWN {
                    if !picture.spread.is_wanted() {
                        return;
                    }
                    self.forget_hidden();
                }
                let place = geometry.place(triangle);
                let corners = geometry.projected_of(place);
                let [a, b, c] = corners;
                let drawn = Drawn {
                    triangle,
                    piece: 0,
                    looked_up: NONE,
                };
                if !(a.is_beyond() || b.is_beyond() || c.is_beyond()) {
                    self.triangle(&footprint, picture, tile, place, drawn, corners);
                    continue;
                }
                for (piece, corners) in (0..).zip(geometry.pieces(place)) {
                    let drawn = Drawn { piece, ..drawn };
                    let corners = corners.map(|corner| corner.projected);
                    self.triangle(&footprint, picture, tile, place, drawn, corners);
                }
            }
        }
    }

    /// A triangle, or a piece of one, into the samples of the tile.
    #[inline(always)]
    fn triangle<S: Simd>(
        &mut self,
        footprint: &Footprint<S>,
        picture: &Picturing<'_>,
        tile: Rectangle,
        place: Place<'_>,
        drawn: Drawn,
        corners: [Projected; 3],
    ) {
        let Some(reached) = seen(corners, place, &picture.grid, picture.pattern) else {
            return;
        };
        let reached = reached.within(tile.min, tile.max);
        if reached.is_empty() {
            return;
        }
        let number = self.drawn.len() as u32;
        self.drawn.push(drawn);
        let (samples, layer) = (&mut self.samples, place.surface.layer);
        raster::draw(
            footprint, samples, tile.min, layer, number, corners, reached,
        );
    }

    /// Numbers those triangles anew that samples show.
    fn forget_hidden(&mut self) {
        let Self {
            samples,
            drawn,
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
        picture: &Picturing<'_>,
        block: usize,
        at: [u32; 2],
    ) -> bool {
        let layers = [(Layer::Base, true), (Layer::Skin, picture.has_skin_layer)];
        for (layer, is_drawn) in layers {
            if !is_drawn {
                continue;
            }
            let Some(shown) = self.samples.shown(block, layer) else {
                return false;
            };
            self.fragments.count = 0;
            let mut gather = Gather {
                picture,
                at,
                drawn: &mut self.drawn,
                looked_up: &mut self.looked_up,
                fragments: &mut self.fragments,
            };
            match picture.pattern.count() {
                1 => gather.block::<S, 1>(simd, shown),
                _ => gather.block::<S, 4>(simd, shown),
            }
            shade(simd, picture.view, &mut self.fragments);
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
