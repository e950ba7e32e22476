//! One tile from empty samples to pixels: raster, then for each block gather what its pixels show, shade it, and resolve.
//! Never lives here: the stages themselves.

use super::bin::{Chunk, Grid, Rectangle, TILE, pixels, side};
use super::geometry::{Entry, Geometry, Layer, Paint};
use super::interpolate::Planes;
use super::lanes::LANES;
use super::raster::{self, Footprint};
use super::resolve::{Resolve, Sums};
use super::samples::{BLOCK, BLOCK_COLUMNS, BLOCK_PIXELS, EIGHTHS, NONE, Pattern, TileSamples};
use super::shade::{Fragment, Fragments, shade};
use super::texture;
use crate::render::cull::Side;
use crate::render::view::View;
use crate::rig::Texture;
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
}

/// The room that one thread draws tiles in. Kept from picture to picture.
#[derive(Default)]
pub(super) struct TileRoom {
    samples: TileSamples,
    /// By the numbers that samples keep.
    drawn: Vec<Drawn>,
    looked_up: Vec<LookedUp>,
    fragments: Fragments,
    base: Sums,
    skin: Sums,
}

/// A triangle that reaches the tile.
#[derive(Clone, Copy)]
struct Drawn {
    chunk: u32,
    entry: Entry,
    /// Index into what was looked up, or [`NONE`] where it has not been seen yet.
    looked_up: u32,
}

/// A triangle that is seen.
struct LookedUp {
    planes: Planes,
    color: Scatter,
}

/// What a triangle scatters.
#[derive(Clone, Copy)]
enum Scatter {
    Everywhere([f32; 4]),
    /// The texture of the surface of this number.
    Texture(u32),
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
        let tile = (row * picture.grid.columns + column) as usize;
        for (index, chunk) in picture.chunks.iter().enumerate() {
            for &entry in &chunk.bins[tile] {
                let (place, corners) = picture.geometry.found(entry, &chunk.clipped);
                let Some(reached) = pixels(corners, picture.grid.size, picture.pattern) else {
                    continue;
                };
                let reached = Rectangle {
                    min: [0, 1].map(|axis| reached.min[axis].max(corner[axis])),
                    max: [0, 1].map(|axis| reached.max[axis].min(last[axis])),
                };
                let number = self.drawn.len() as u32;
                self.drawn.push(Drawn {
                    chunk: index as u32,
                    entry,
                    looked_up: NONE,
                });
                let samples = &mut self.samples;
                let layer = place.surface.layer;
                raster::draw(&footprint, samples, corner, layer, number, corners, reached);
            }
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

/// From samples to fragments.
struct Gather<'a> {
    picture: &'a Picturing<'a>,
    at: [u32; 2],
    drawn: &'a mut [Drawn],
    looked_up: &'a mut Vec<LookedUp>,
    fragments: &'a mut Fragments,
}

impl Gather<'_> {
    #[inline(always)]
    fn block<S: Simd, const SAMPLES: usize>(&mut self, simd: S, shown: &[u32]) {
        let positions = self.picture.pattern.positions();
        for (pixel, samples) in shown.as_chunks::<SAMPLES>().0.iter().enumerate() {
            let first = samples[0];
            if *samples == [first; SAMPLES] {
                if first != NONE {
                    self.fragment(simd, pixel, first, SAMPLES, [EIGHTHS / 2; 2]);
                }
                continue;
            }
            for (sample, &number) in samples.iter().enumerate() {
                if number != NONE && !samples[..sample].contains(&number) {
                    let count = samples.iter().filter(|other| **other == number).count();
                    // Shaded where the triangle is for certain: at the first of its samples.
                    self.fragment(simd, pixel, number, count, positions[sample]);
                }
            }
        }
    }

    /// `place` is where in the pixel it is shaded, in eighths.
    #[inline(always)]
    fn fragment<S: Simd>(
        &mut self,
        simd: S,
        pixel: usize,
        number: u32,
        samples: usize,
        place: [i32; 2],
    ) {
        let looked_up = self.look_up(simd, number);
        let LookedUp { planes, color } = &self.looked_up[looked_up];
        let of_block = [pixel as u32 % BLOCK, pixel as u32 / BLOCK];
        let pixel_at = [0, 1].map(|axis| (self.at[axis] + of_block[axis]) as f32);
        let from_origin = [0, 1]
            .map(|axis| pixel_at[axis] + place[axis] as f32 / EIGHTHS as f32 - planes.origin[axis]);
        let diffuse = match *color {
            Scatter::Everywhere(color) => color,
            Scatter::Texture(surface) => {
                let Paint::Textured(texture, _) =
                    self.picture.geometry.surfaces[surface as usize].paint
                else {
                    unreachable!("only textured surfaces are looked up as such");
                };
                let [r, g, b, _] = textured(simd, texture, planes, pixel_at);
                let by = self.picture.view.textured_diffuse;
                [r * by.x, g * by.y, b * by.z, 1.0]
            }
        };
        let fragment = Fragment {
            normal: planes.normal.at(simd, from_origin).to_array(),
            position: planes.position.at(simd, from_origin).to_array(),
            diffuse,
        };
        self.fragments.add(pixel, samples, fragment);
    }

    /// What is interpolated over a triangle is worked out when it is first seen.
    #[inline(always)]
    fn look_up<S: Simd>(&mut self, simd: S, number: u32) -> usize {
        let Drawn {
            chunk,
            entry,
            looked_up,
        } = self.drawn[number as usize];
        if looked_up != NONE {
            return looked_up as usize;
        }
        let geometry = &self.picture.geometry;
        let clipped = &self.picture.chunks[chunk as usize].clipped;
        let (place, projected) = geometry.found(entry, clipped);
        let view = self.picture.view;
        let is_flat = match place.surface.paint {
            Paint::Plain | Paint::Textured(..) => view.flat_normals == 1,
            Paint::Lines(_) | Paint::Solids(_) => false,
        };
        // It has samples, so it is no line.
        let side = side(projected).unwrap_or(Side::Front);
        let color = match place.surface.paint {
            Paint::Lines(segments) => {
                Scatter::Everywhere(segments[place.triangle / 2].color.extend(0.0).to_array())
            }
            Paint::Solids(vertices) => {
                let first = place.surface.triangles[place.triangle][0];
                Scatter::Everywhere(vertices[first as usize].color.extend(1.0).to_array())
            }
            Paint::Plain => Scatter::Everywhere(view.diffuse.extend(1.0).to_array()),
            Paint::Textured(..) => {
                let surfaces = geometry.surfaces;
                let index =
                    surfaces.partition_point(|it| it.first_triangle < place.surface.first_triangle);
                Scatter::Texture(index as u32)
            }
        };
        let planes = Planes::of(simd, geometry.corners(entry, clipped), side, is_flat);
        let index = self.looked_up.len();
        self.looked_up.push(LookedUp { planes, color });
        self.drawn[number as usize].looked_up = index as u32;
        index
    }
}

/// The texture at the middle of a pixel, as far apart as the middles of the pixels of its square of four.
#[inline(always)]
fn textured<S: Simd>(simd: S, texture: &Texture, planes: &Planes, pixel: [f32; 2]) -> [f32; 4] {
    let [x, y] = pixel;
    let here = texcoord(simd, planes, pixel);
    let beside = texcoord(simd, planes, [neighbour(x), y]);
    let below = texcoord(simd, planes, [x, neighbour(y)]);
    let by_x = [beside[0] - here[0], beside[1] - here[1]];
    let by_y = [below[0] - here[0], below[1] - here[1]];
    texture::sample(simd, texture, here, by_x, by_y)
}

/// At the middle of a pixel, inside the triangle or beside it.
#[inline(always)]
fn texcoord<S: Simd>(simd: S, planes: &Planes, pixel: [f32; 2]) -> [f32; 2] {
    let middle = [0, 1].map(|axis| pixel[axis] + 0.5 - planes.origin[axis]);
    let [u, v, inverse_w, _] = planes.texcoord.at(simd, middle).to_array();
    [u / inverse_w, v / inverse_w]
}

/// The other one of its pair.
fn neighbour(pixel: f32) -> f32 {
    (pixel as u32 ^ 1) as f32
}
