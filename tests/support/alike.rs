//! How far pictures of the two renderers may be off each other, and where. Never lives here: what is drawn.

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

/// Of the channels of many pictures.
pub const SHARE_OF_ALL: f64 = 0.001;

/// Off edges no channel differs by more than this: over triangles seen from their edge float32 runs short.
const SLIVERS: u8 = 3;

/// With one sample a pixel on an edge is one color or the other.
const ONE_SAMPLE: Tolerance = Tolerance { most: 255, ..ALIKE };

/// How many channels of how many differ by more than rounding.
///
/// # Panics
/// Where they differ by too much, or off any edge. Both pictures then lie side by side for somebody to look at.
pub fn compare(name: &str, images: &[Image; 2], has_one_sample: bool) -> (usize, usize) {
    let path = keep(name, images);
    let [own, wgpu] = images;
    let tolerance = if has_one_sample { ONE_SAMPLE } else { ALIKE };
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
        if most > Some(SLIVERS) {
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
    let path = super::places::output("twins").join(format!("{name}.png"));
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
