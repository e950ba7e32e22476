//! Where a pixel is sampled, and the samples of one tile: how near, and of which triangle. Never lives here: what covers them.

use super::grid::TILE;
use crate::scene::Samples;

/// Pixels of a block's side. A tile is made of blocks, whose samples lie one behind the other.
pub(super) const BLOCK: u32 = 8;
pub(super) const BLOCK_PIXELS: usize = (BLOCK * BLOCK) as usize;
/// Samples that are tested at once.
pub(super) const GROUP: usize = 8;
/// Blocks in a row of a tile.
pub(super) const BLOCK_COLUMNS: u32 = TILE[0] / BLOCK;
pub(super) const BLOCKS: usize = (BLOCK_COLUMNS * TILE[1] / BLOCK) as usize;

/// Sample positions lie on a grid of eighths of a pixel.
pub(super) const EIGHTHS: i32 = 8;
/// Steps of fixed point to an eighth.
pub(super) const STEPS_IN_EIGHTH: i32 = super::project::STEPS / EIGHTHS;

/// Where in a pixel its samples are: Vulkan's and Direct3D's standard positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pattern(Samples);

impl Pattern {
    pub(super) const fn of(samples: Samples) -> Self {
        Self(samples)
    }

    /// In eighths of a pixel from its upper left corner.
    pub(super) fn positions(self) -> &'static [[i32; 2]] {
        match self.0 {
            Samples::One => &[[4, 4]],
            Samples::Four => &[[3, 1], [7, 3], [1, 5], [5, 7]],
        }
    }

    pub(super) fn count(self) -> usize {
        self.positions().len()
    }

    /// The first step, on either axis, at or after this one on which there is a sample.
    #[inline(always)]
    pub(super) fn first_at(self, step: i32) -> i32 {
        let (offset, bits) = self.spacing();
        ((step - offset + (1 << bits) - 1) >> bits << bits) + offset
    }

    /// The last one at or before it.
    #[inline(always)]
    pub(super) fn last_at(self, step: i32) -> i32 {
        let (offset, bits) = self.spacing();
        ((step - offset) >> bits << bits) + offset
    }

    /// On each axis: the first sample's distance from the pixel's edge in steps, and how many bits the distance of samples from each
    /// other has.
    #[inline(always)]
    fn spacing(self) -> (i32, u32) {
        let eighth = STEPS_IN_EIGHTH.ilog2();
        match self.0 {
            Samples::One => (4 * STEPS_IN_EIGHTH, eighth + 3),
            Samples::Four => (STEPS_IN_EIGHTH, eighth + 1),
        }
    }
}

/// What a sample is kept in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Layer {
    #[default]
    Base,
    /// A translucent skin, laid over the base at the end.
    Skin,
}

/// Nothing was drawn over a sample.
pub(super) const NONE: u32 = u32::MAX;

/// The samples of one tile. Within a block pixels go row by row, and the samples of a pixel lie side by side.
pub(super) struct TileSamples {
    pattern: Pattern,
    depth: Vec<f32>,
    /// Numbers of triangles, as the tile gives them, or [`NONE`].
    base: Vec<u32>,
    skin: Vec<u32>,
    /// Of each block, whether anything was drawn there since the last [`clear`](Self::clear).
    touched: [bool; BLOCKS],
    /// Of each block, how near all of its samples are at least.
    least_depth: [f32; BLOCKS],
}

impl Default for TileSamples {
    fn default() -> Self {
        Self {
            pattern: Pattern::of(Samples::One),
            depth: Vec::new(),
            base: Vec::new(),
            skin: Vec::new(),
            touched: [false; BLOCKS],
            least_depth: [0.0; BLOCKS],
        }
    }
}

/// Samples that are tested at once, of one layer.
pub(super) struct Group<'a> {
    pub depth: &'a mut [f32; GROUP],
    pub triangle: &'a mut [u32; GROUP],
}

impl TileSamples {
    pub(super) fn clear(&mut self, pattern: Pattern) {
        self.pattern = pattern;
        self.touched = [false; BLOCKS];
        self.least_depth = [0.0; BLOCKS];
        // Blocks are cleared as they are met: most of a picture is often empty.
        let samples = BLOCKS * BLOCK_PIXELS * pattern.count();
        self.depth.resize(samples, 0.0);
        self.base.resize(samples, NONE);
        self.skin.resize(samples, NONE);
    }

    /// The group of a pixel of the tile and those beside it, to be drawn into. A group never leaves its block.
    #[inline(always)]
    pub(super) fn group(&mut self, [x, y]: [u32; 2], layer: Layer) -> Group<'_> {
        let samples = self.pattern.count();
        let block = (y / BLOCK * BLOCK_COLUMNS + x / BLOCK) as usize;
        if !self.touched[block] {
            self.touch(block);
        }
        let pixel = (y % BLOCK * BLOCK + x % BLOCK) as usize;
        let index = (block * BLOCK_PIXELS + pixel) * samples / GROUP;
        let triangle = match layer {
            Layer::Base => &mut self.base,
            Layer::Skin => &mut self.skin,
        };
        Group {
            depth: &mut self.depth.as_chunks_mut().0[index],
            triangle: &mut triangle.as_chunks_mut().0[index],
        }
    }

    fn touch(&mut self, block: usize) {
        let length = BLOCK_PIXELS * self.pattern.count();
        let range = block * length..(block + 1) * length;
        self.touched[block] = true;
        self.depth[range.clone()].fill(0.0);
        self.base[range.clone()].fill(NONE);
        self.skin[range].fill(NONE);
    }

    /// How near all samples of the block of a pixel are at least: what is no nearer anywhere in it is hidden.
    pub(super) fn least_depth(&mut self, [x, y]: [u32; 2]) -> &mut f32 {
        &mut self.least_depth[(y / BLOCK * BLOCK_COLUMNS + x / BLOCK) as usize]
    }

    /// How near what is drawn is at each sample of the group of a pixel of the tile.
    #[inline(always)]
    pub(super) fn depth(&mut self, at: [u32; 2]) -> [f32; GROUP] {
        *self.group(at, Layer::Base).depth
    }

    /// Of every sample that shows a triangle, which one.
    pub(super) fn shown_mut(&mut self) -> impl Iterator<Item = &mut u32> {
        let length = BLOCK_PIXELS * self.pattern.count();
        let blocks = self
            .base
            .chunks_exact_mut(length)
            .zip(self.skin.chunks_exact_mut(length));
        let touched = blocks.zip(self.touched).filter(|(_, touched)| *touched);
        let numbers = touched.flat_map(|((base, skin), _)| base.iter_mut().chain(skin));
        numbers.filter(|number| **number != NONE)
    }

    /// Of each sample of a block which triangle it shows; `None` where nothing was drawn.
    pub(super) fn shown(&self, block: usize, layer: Layer) -> Option<&[u32]> {
        let length = BLOCK_PIXELS * self.pattern.count();
        let triangle = match layer {
            Layer::Base => &self.base,
            Layer::Skin => &self.skin,
        };
        self.touched[block].then(|| &triangle[block * length..(block + 1) * length])
    }
}
