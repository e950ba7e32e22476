//! What of a tile blends, one surface after another laid over the base, sample by sample. Never lives here: which samples a triangle
//! covers, and light.

use super::block::shade_shown;
use super::context::{PictureContext, TileCanvas};
use super::gather::{Drawn, Triangles};
use super::geometry::Place;
use super::project::Projected;
use super::raster::{self, Opaque, Target};
use super::samples::{
    BLOCK, BLOCK_COLUMNS, BLOCK_PIXELS, BLOCKS, EIGHTHS, GROUP, Layer, NONE, TileSamples,
};
use super::shade::{Fragments, shade};

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8, mask32x8};

/// The most that are gathered before they are shaded: a few times what one triangle has of a tile, and the work of about a millisecond,
/// however many there are.
const MOST_HITS: usize = 1 << 13;
/// Triangles from one check for cancellation to the next: most may be hidden.
const ASK_AFTER: u32 = 1 << 12;

/// Kept from tile to tile.
#[derive(Default)]
pub(super) struct Overlay {
    /// Those that are hit.
    triangles: Triangles,
    /// In the order in which they are laid over what is there.
    hits: Vec<Hit>,
    /// Of each block, whether it has colors of its own for each sample.
    is_open: [bool; BLOCKS],
    /// Of each sample of the tile, block by block: linear and premultiplied, without the background, and how much of that they hide.
    colors: Vec<[f32; 4]>,
}

/// Samples of one pixel at which a triangle is nearer than the base.
#[derive(Clone, Copy)]
struct Hit {
    block: u8,
    /// Of the block.
    pixel: u8,
    /// A bit for each.
    samples: u8,
    /// Of the triangle.
    number: u32,
}

/// The base of a tile, and the scratch memory to shade it in.
pub(super) struct Under<'a> {
    pub samples: &'a mut TileSamples,
    pub triangles: &'a mut Triangles,
    pub fragments: &'a mut Fragments,
}

impl Overlay {
    /// Everything that blends in tile (`column`, `row`). By itself, so that it does not lie in the way of pictures without.
    #[inline(never)]
    pub(super) fn draw<S: Simd>(
        &mut self,
        simd: S,
        picture: &PictureContext<'_>,
        [column, row]: [u32; 2],
        mut under: Under<'_>,
    ) {
        self.is_open = [false; BLOCKS];
        self.hits.clear();
        self.triangles.clear();
        let canvas = TileCanvas::of(simd, picture, [column, row]);
        let corner = canvas.tile.min;
        let geometry = &picture.geometry;
        let mut met = 0u32;
        for chunk in picture.chunks {
            let of_tile = chunk.of_tile([column, row], &picture.grid);
            for triangle in of_tile.from(geometry.first_blending) {
                met = met.wrapping_add(1);
                if met.is_multiple_of(ASK_AFTER) && picture.parallelism.is_cancelled() {
                    return;
                }
                let place = geometry.place(triangle);
                let whole = geometry.projected_of(place);
                let is_cut = whole.iter().any(|corner| corner.is_beyond());
                let pieces = is_cut.then(|| geometry.pieces(place));
                let pieces = pieces.into_iter().flatten();
                let pieces = pieces.map(|piece| piece.map(|corner| corner.projected));
                let whole = (!is_cut).then_some(whole);
                for (piece, corners) in (0..).zip(whole.into_iter().chain(pieces)) {
                    if self.is_full() {
                        self.lay(simd, picture, corner, &mut under);
                        if picture.parallelism.is_cancelled() {
                            return;
                        }
                    }
                    let drawn = Drawn {
                        triangle,
                        piece,
                        setup: NONE,
                    };
                    self.record(simd, &canvas, under.samples, place, drawn, corners);
                }
            }
        }
        self.lay(simd, picture, corner, &mut under);
    }

    /// Of a block whose samples have colors of their own.
    pub(super) fn colors(&self, block: usize, samples: usize) -> Option<&[[f32; 4]]> {
        let length = BLOCK_PIXELS * samples;
        self.is_open[block].then(|| &self.colors[block * length..][..length])
    }

    /// Whether another triangle might hit more than there is to be.
    fn is_full(&self) -> bool {
        self.hits.len() + BLOCKS * BLOCK_PIXELS > MOST_HITS
    }

    /// Where a triangle, or a piece of one, is nearer than the base.
    #[inline(never)]
    fn record<S: Simd>(
        &mut self,
        simd: S,
        canvas: &TileCanvas<'_, S>,
        samples: &mut TileSamples,
        place: Place<'_>,
        drawn: Drawn,
        corners: [Projected; 3],
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let TileCanvas {
                    picture,
                    footprint,
                    tile,
                } = canvas;
                let Some(reached) = canvas.reached(corners, place) else {
                    return;
                };
                let before = self.hits.len();
                let target = Recording {
                    samples,
                    bits: picture.pattern.count(),
                    hits: &mut self.hits,
                    number: self.triangles.drawn.len() as u32,
                };
                raster::draw(footprint, target, tile.min, corners, reached, &Opaque);
                // So that no more are kept than there are hits.
                if self.hits.len() > before {
                    self.triangles.drawn.push(drawn);
                }
            },
        );
    }

    /// Shades all hits and lays them over what is there, in their order; then there are none.
    #[inline(never)]
    fn lay<S: Simd>(
        &mut self,
        simd: S,
        picture: &PictureContext<'_>,
        corner: [u32; 2],
        under: &mut Under<'_>,
    ) {
        let samples = picture.pattern.count();
        let all = BLOCKS * BLOCK_PIXELS * samples;
        if self.colors.len() < all {
            self.colors.resize(all, [0.0; 4]);
        }
        for index in 0..self.hits.len() {
            let block = usize::from(self.hits[index].block);
            if !self.is_open[block] {
                self.open(simd, picture, block, corner, under);
            }
        }
        simd.vectorize(
            #[inline(always)]
            || {
                for hits in self.hits.chunks(Fragments::MOST) {
                    let mut gather = self.triangles.gather(picture, corner, under.fragments);
                    for hit in hits {
                        let count = hit.samples.count_ones() as usize;
                        let place = if count == samples {
                            [EIGHTHS / 2; 2]
                        } else {
                            picture.pattern.positions()[hit.samples.trailing_zeros() as usize]
                        };
                        gather.at = block_corner(corner, hit.block.into());
                        let pixel = usize::from(hit.pixel);
                        gather.fragment::<S, true>(simd, pixel, hit.number, count, place);
                    }
                    shade::<S, true>(simd, picture.view, picture.plain, under.fragments);
                    for (hit, color) in hits.iter().zip(&under.fragments.color) {
                        let first = usize::from(hit.block) * BLOCK_PIXELS + usize::from(hit.pixel);
                        let there = &mut self.colors[first * samples..][..samples];
                        let over = f32x4::load_array(simd, *color);
                        let through = 1.0 - color[3];
                        for (sample, there) in there.iter_mut().enumerate() {
                            if hit.samples & (1 << sample) != 0 {
                                let behind = f32x4::load_array(simd, *there);
                                (over + behind * through).store_array(there);
                            }
                        }
                    }
                }
            },
        );
        self.hits.clear();
        self.triangles.clear();
    }

    /// Gives the samples of a block the colors of its base.
    fn open<S: Simd>(
        &mut self,
        simd: S,
        picture: &PictureContext<'_>,
        block: usize,
        corner: [u32; 2],
        under: &mut Under<'_>,
    ) {
        self.is_open[block] = true;
        let samples = picture.pattern.count();
        let length = BLOCK_PIXELS * samples;
        let colors = &mut self.colors[block * length..][..length];
        let Some(shown) = under.samples.shown(block, Layer::Base) else {
            return colors.fill([0.0; 4]);
        };
        let at = block_corner(corner, block as u32);
        let gather = under.triangles.gather(picture, at, under.fragments);
        shade_shown(simd, picture, gather, shown);
        // In the order in which they were gathered: by pixel, and there by the first sample that shows them.
        let mut shaded = under.fragments.color.iter();
        let pixels = shown.chunks_exact(samples);
        for (shown, colors) in pixels.zip(colors.chunks_exact_mut(samples)) {
            for (sample, number) in shown.iter().enumerate() {
                let same = shown[..sample].iter().position(|other| other == number);
                colors[sample] = match same {
                    _ if *number == NONE => [0.0; 4],
                    Some(same) => colors[same],
                    None => shaded.next().copied().unwrap_or_default(),
                };
            }
        }
    }
}

/// The picture's pixel at the upper left corner of a block of the tile that has this one there.
fn block_corner(tile: [u32; 2], block: u32) -> [u32; 2] {
    [
        tile[0] + block % BLOCK_COLUMNS * BLOCK,
        tile[1] + block / BLOCK_COLUMNS * BLOCK,
    ]
}

/// Samples stay as they are.
struct Recording<'a> {
    samples: &'a mut TileSamples,
    /// Samples of a pixel.
    bits: usize,
    hits: &'a mut Vec<Hit>,
    /// Of the triangle.
    number: u32,
}

impl Target for Recording<'_> {
    const HIDES: bool = false;

    #[inline(always)]
    fn samples(&mut self) -> &mut TileSamples {
        self.samples
    }

    #[inline(always)]
    fn show<S: Simd>(
        &mut self,
        [x, y]: [u32; 2],
        covered: mask32x8<S>,
        nearness: f32x8<S>,
        present: impl FnOnce(mask32x8<S>) -> mask32x8<S>,
    ) {
        let there = f32x8::load_array(nearness.token(), self.samples.depth([x, y]));
        let mut left = present(covered & nearness.simd_gt(there)).to_bitmask();
        let block = y / BLOCK * BLOCK_COLUMNS + x / BLOCK;
        let first = y % BLOCK * BLOCK + x % BLOCK;
        for pixel in first..first + (GROUP / self.bits) as u32 {
            let samples = left & ((1 << self.bits) - 1);
            left >>= self.bits;
            if samples != 0 {
                self.hits.push(Hit {
                    block: block as u8,
                    pixel: pixel as u8,
                    samples: samples as u8,
                    number: self.number,
                });
            }
        }
    }
}
