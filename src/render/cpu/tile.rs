//! One tile from empty samples to pixels: raster, lay over it what blends, then for each block gather, shade and resolve.
//! Never lives here: the stages themselves.

use super::alpha_test::AlphaTest;
use super::bin::{Chunk, Grid, Rectangle, TILE, seen};
use super::gather::{Drawn, Gather, Triangles};
use super::geometry::{Corner, Geometry, Layer, Paint, Place};
use super::lanes::LANES;
use super::material::PartMaterial;
use super::overlay::{Overlay, Under};
use super::project::Projected;
use super::raster::{self, CoverageTest, Footprint, Mark, Nearest, Opaque};
use super::resolve::{Resolve, Sums};
use super::samples::{BLOCK, BLOCK_COLUMNS, BLOCK_PIXELS, NONE, Pattern, TileSamples};
use super::shade::{Fragments, shade};
use super::spread::Spread;
use crate::render::instance_params::InstanceParams;
use crate::render::view::View;
use fearless_simd::prelude::*;

/// What every tile of a picture is drawn from.
pub(super) struct Picturing<'a> {
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
    pub spread: Spread<'a>,
}

/// Triangles of a tile, of which there are thousands of samples: beyond that, hidden ones are forgotten.
const MOST_DRAWN: usize = 1 << 16;

/// The room that one thread draws tiles in. Kept from picture to picture.
#[derive(Default)]
pub(super) struct TileRoom {
    samples: TileSamples,
    triangles: Triangles,
    /// New numbers by old ones.
    renumbered: Vec<u32>,
    fragments: Fragments,
    overlay: Overlay,
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
    fn raster<S: Simd>(&mut self, simd: S, picture: &Picturing<'_>, [column, row]: [u32; 2]) {
        self.samples.clear(picture.pattern);
        self.triangles.clear();
        let canvas = Canvas::of(simd, picture, [column, row]);
        let geometry = &picture.geometry;
        for chunk in picture.chunks {
            let of_tile = chunk.of_tile([column, row], &picture.grid);
            for triangle in of_tile.before(geometry.first_blending) {
                if self.triangles.drawn.len() >= MOST_DRAWN {
                    if !picture.spread.is_wanted() {
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
        canvas: &Canvas<'_, S>,
        place: Place<'_>,
        drawn: Drawn,
        corners: [Projected; 3],
        test: &P,
    ) {
        let Canvas {
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
        canvas: &Canvas<'_, S>,
        place: Place<'_>,
        drawn: Drawn,
        material: &PartMaterial<'_>,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let Canvas { picture, .. } = canvas;
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
        picture: &Picturing<'_>,
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

/// What triangles of a tile are drawn on.
pub(super) struct Canvas<'a, S: Simd> {
    pub picture: &'a Picturing<'a>,
    pub footprint: Footprint<S>,
    /// The picture's pixels.
    pub tile: Rectangle,
}

impl<'a, S: Simd> Canvas<'a, S> {
    /// Of tile (`column`, `row`).
    #[inline(always)]
    pub fn of(simd: S, picture: &'a Picturing<'a>, [column, row]: [u32; 2]) -> Self {
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
    pub fn reached(&self, corners: [Projected; 3], place: Place<'_>) -> Option<Rectangle> {
        let Self { picture, tile, .. } = self;
        let reached = seen(corners, place, &picture.grid, picture.pattern)?;
        let reached = reached.within(tile.min, tile.max);
        (!reached.is_empty()).then_some(reached)
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

/// Gathers and shades what the samples of a block show.
#[inline(always)]
pub(super) fn shade_shown<S: Simd>(
    simd: S,
    picture: &Picturing<'_>,
    mut gather: Gather<'_>,
    shown: &[u32],
) {
    if !picture.has_materials {
        match picture.pattern.count() {
            1 => gather.block::<S, 1, false>(simd, shown),
            _ => gather.block::<S, 4, false>(simd, shown),
        }
        shade::<S, false>(simd, picture.view, picture.plain, gather.fragments);
    } else {
        shade_materials(simd, picture, gather, shown);
    }
}

/// Gathers and shades a block that may show surfaces with materials of their own. By itself, so that it does not lie in the way of pictures without.
#[inline(never)]
fn shade_materials<S: Simd>(
    simd: S,
    picture: &Picturing<'_>,
    mut gather: Gather<'_>,
    shown: &[u32],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            match picture.pattern.count() {
                1 => gather.block::<S, 1, true>(simd, shown),
                _ => gather.block::<S, 4, true>(simd, shown),
            }
            shade::<S, true>(simd, picture.view, picture.plain, gather.fragments);
        },
    );
}
