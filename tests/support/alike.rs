//! How far pictures of the two renderers may be off each other, and where. Never lives here: what is drawn.

use super::adapters::wgpu_adapter;
use super::pictures::{Image, Tolerance, difference, matches};
use std::path::PathBuf;

/// Rounding to 8 bits may fall either way. What is further off lies on edges, where one sample may go to the other side: of four, white
/// over black, that is linear 0.25, which is 137 in sRGB.
/// Over all pictures one channel in a thousand may be; a single picture that is all edges has more.
pub const ALIKE: Tolerance = Tolerance {
    channel: 1,
    share: 0.004,
    most: 140,
};

/// As [`ALIKE`], of a driver that rounds corners to 1/16 of a pixel, the coarsest that Vulkan allows. Nearly all round to 1/256, as rigd's
/// own renderer does. Along edges more samples then fall to the other side, and what is interpolated is moved as well.
const ALIKE_COARSELY: Tolerance = Tolerance {
    channel: 1,
    share: 0.03,
    most: 255,
};

pub fn has_coarse_corners() -> bool {
    wgpu_adapter().to_lowercase().contains("swiftshader")
}

/// Of the channels of many pictures.
pub fn share_of_all() -> f64 {
    if has_coarse_corners() { 0.01 } else { 0.001 }
}

/// Off edges no channel differs by more than this: over triangles seen from their edge float32 runs short.
fn slivers() -> u8 {
    if has_coarse_corners() { 8 } else { 3 }
}

/// With one sample a pixel on an edge is one color or the other.
const ONE_SAMPLE: Tolerance = Tolerance { most: 255, ..ALIKE };

/// How many channels of how many differ by more than rounding.
///
/// # Panics
/// Where they differ by too much, or off any edge. Both pictures then lie side by side for somebody to look at.
pub fn compare(name: &str, images: &[Image; 2], has_one_sample: bool) -> (usize, usize) {
    let path = keep(name, images);
    let [own, wgpu] = images;
    let tolerance = match (has_coarse_corners(), has_one_sample) {
        // A picture of few pixels may be nothing but edges.
        (true, _) if own.pixels.len() < 100 => Tolerance {
            share: 1.0,
            ..ALIKE_COARSELY
        },
        (true, _) => ALIKE_COARSELY,
        (false, true) => ONE_SAMPLE,
        (false, false) => ALIKE,
    };
    if let Err(mismatch) = matches(wgpu, own, tolerance) {
        panic!("{name}: {mismatch:?}; see {}", path.display());
    }
    let mut off = 0;
    for (x, y, pixel) in own.iter() {
        let other = wgpu.at(x, y);
        let differing = (0..4)
            .filter(|&i| pixel[i].abs_diff(other[i]) > ALIKE.channel)
            .count();
        off += differing;
        let most = (0..4).map(|i| pixel[i].abs_diff(other[i])).max();
        if most > Some(slivers()) {
            let explained = is_on_an_edge(own, x, y) || is_on_an_edge(wgpu, x, y);
            assert!(
                explained,
                "{name}: {pixel:?} is not {other:?} at {x},{y}, off any edge; see {}",
                path.display()
            );
        }
    }
    (off, 4 * own.pixels.len())
}

/// Writes both pictures and their difference, side by side, for somebody to look at.
fn keep(name: &str, [own, wgpu]: &[Image; 2]) -> PathBuf {
    let sides = [own, wgpu, &difference(own, wgpu)];
    let rows = (0..own.height).flat_map(|y| {
        let row = move |image: &Image| -> Vec<[u8; 4]> {
            (0..own.width).map(|x| image.at(x, y)).collect()
        };
        sides.map(row).concat()
    });
    let pixels: Vec<[u8; 4]> = rows.collect();
    let image = Image::from_bytes([3 * own.width, own.height], pixels.as_flattened());
    let path = super::places::output("parity").join(format!("{name}.png"));
    image.write(&path);
    path
}

/// What differs by more than rounding lies on edges: in either picture some pixel around it is of quite another color.
pub fn is_on_an_edge(image: &Image, x: usize, y: usize) -> bool {
    let here = image.at(x, y);
    let around = |at: usize, side: usize| at.saturating_sub(1)..=(at + 1).min(side - 1);
    around(y, image.height)
        .flat_map(|y| around(x, image.width).map(move |x| (x, y)))
        .any(|(x, y)| (0..4).any(|i| image.at(x, y)[i].abs_diff(here[i]) > 4))
}
