//! Which 256 colors stand for those of a frame. Never lives here: a file format.

use super::png::Compression;
use color_quant::NeuQuant;
use std::collections::HashMap;

/// A picture of at most 256 colors.
pub(super) struct Indexed {
    /// Red, green and blue of each.
    pub palette: Vec<u8>,
    /// The one that stands for nothing.
    pub transparent: Option<u8>,
    /// One for each pixel.
    pub indices: Vec<u8>,
}

type Rgb = [u8; 3];

/// Entries of a palette.
const MOST: usize = 256;
/// Pixels that the network learns from at least, where there are as many: from fewer it learns too little, and these take milliseconds.
const LEAST_SAMPLES: usize = 10_000;
/// Pixels less opaque than this are not there at all.
const OPAQUE: u8 = 128;

impl Indexed {
    /// `pixels` are RGBA8. Colors are kept where there are few enough of them; else the most frequent one is, which is that of a plain
    /// background, and so does not flicker from frame to frame.
    pub(super) fn new(pixels: &[u8], compression: Compression) -> Self {
        let counts = count(pixels);
        let has_holes = pixels
            .as_chunks()
            .0
            .iter()
            .any(|pixel| color(*pixel).is_none());
        let room = MOST - usize::from(has_holes);
        let (mut palette, index_of) = if counts.len() <= room {
            exact(&counts)
        } else {
            reduced(pixels, &counts, room, compression)
        };
        let transparent = has_holes.then(|| {
            palette.extend([0; 3]);
            // Room was left for it.
            (palette.len() / 3 - 1) as u8
        });
        if palette.is_empty() {
            palette.extend([0; 3]);
        }
        let hole = transparent.unwrap_or_default();
        let indices = pixels.as_chunks().0.iter();
        let indices = indices.map(|pixel| color(*pixel).map_or(hole, |color| index_of[&color]));
        Self {
            indices: indices.collect(),
            palette,
            transparent,
        }
    }
}

fn color([r, g, b, a]: [u8; 4]) -> Option<Rgb> {
    (a >= OPAQUE).then_some([r, g, b])
}

/// The colors of the pixels that are there, the most frequent one first.
fn count(pixels: &[u8]) -> Vec<(Rgb, usize)> {
    let mut counts = HashMap::<Rgb, usize>::new();
    for color in pixels
        .as_chunks()
        .0
        .iter()
        .filter_map(|pixel| color(*pixel))
    {
        *counts.entry(color).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    // Also by color, so that the same frame always makes the same file.
    counts.sort_unstable_by_key(|&(color, count)| (std::cmp::Reverse(count), color));
    counts
}

fn exact(counts: &[(Rgb, usize)]) -> (Vec<u8>, HashMap<Rgb, u8>) {
    let palette = counts.iter().flat_map(|(color, _)| *color).collect();
    let indices = counts
        .iter()
        .zip(0..=u8::MAX)
        .map(|((color, _), index)| (*color, index));
    (palette, indices.collect())
}

/// `room` colors for more than that.
fn reduced(
    pixels: &[u8],
    counts: &[(Rgb, usize)],
    room: usize,
    compression: Compression,
) -> (Vec<u8>, HashMap<Rgb, u8>) {
    let kept = counts[0].0;
    let rest = pixels
        .as_chunks()
        .0
        .iter()
        .filter_map(|pixel| color(*pixel));
    let rest: Vec<u8> = rest
        .filter(|color| *color != kept)
        .flat_map(|[r, g, b]| [r, g, b, 255])
        .collect();
    // One of so many pixels teaches the network; it is made for 1 to 30.
    let sparsest = match compression {
        Compression::Fast => 30,
        Compression::Balanced => 10,
        Compression::Best => 1,
    };
    let affordable = i32::try_from(rest.len() / 4 / LEAST_SAMPLES).unwrap_or(i32::MAX);
    let sampled = affordable.clamp(1, sparsest);
    let network = NeuQuant::new(sampled, room - 1, &rest);
    let mut palette = network.color_map_rgb();
    let last = (palette.len() / 3) as u8;
    palette.extend(kept);
    let index_of = |&([r, g, b], _): &(Rgb, usize)| {
        // The network has fewer than 256 colors.
        let index = network.index_of(&[r, g, b, 255]) as u8;
        ([r, g, b], if [r, g, b] == kept { last } else { index })
    };
    (palette, counts.iter().map(index_of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_of_few_colors_keeps_them() {
        for colors in [1, 2, 255, 256] {
            let pixels: Vec<u8> = (0..512_u32)
                .flat_map(|i| [(i % colors) as u8, 7, 9, 255])
                .collect();
            let indexed = Indexed::new(&pixels, Compression::Fast);
            assert_eq!(indexed.palette.len(), 3 * colors as usize);
            assert_eq!(indexed.transparent, None);
            for (pixel, index) in pixels.chunks(4).zip(&indexed.indices) {
                let at = 3 * usize::from(*index);
                assert_eq!(pixel[..3], indexed.palette[at..at + 3]);
            }
        }
    }

    #[test]
    fn a_hole_takes_one_of_the_256_colors() {
        for colors in [0, 255, 256, 1000] {
            let opaque = (0..colors).flat_map(|i: u32| [(i % 256) as u8, (i / 256) as u8, 9, 255]);
            let pixels: Vec<u8> = opaque.chain([1, 2, 3, 127]).collect();
            let indexed = Indexed::new(&pixels, Compression::Fast);
            assert!(indexed.palette.len() <= 3 * 256, "{colors}");
            let hole = indexed.transparent.unwrap();
            let (last, others) = indexed.indices.split_last().unwrap();
            assert_eq!(*last, hole);
            assert!(!others.contains(&hole), "{colors}");
            assert!(usize::from(hole) < indexed.palette.len() / 3);
        }
    }
}
