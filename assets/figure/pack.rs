//! Charts laid down side by side in the square of a picture, as large as they fit.
//! What is in them is unwrap.rs's.

use std::cmp::Reverse;

/// Width and height of the picture in texels.
pub const SIZE: usize = 512;
/// Texels left free around a chart, into which its rim is spread for the sake of mipmaps.
const MARGIN: f64 = 3.0;

/// The largest scale, in texels to a length, at which all charts fit, and where their lower left corners go.
pub fn pack(sizes: &[[f64; 2]]) -> (f64, Vec<[f64; 2]>) {
    let mut scale = 2000.0;
    loop {
        if let Some(corners) = place(sizes, scale) {
            return (scale, corners);
        }
        scale *= 0.99;
    }
}

/// Lays the charts down from the tallest to the lowest, each where the ground is lowest for it.
fn place(sizes: &[[f64; 2]], scale: f64) -> Option<Vec<[f64; 2]>> {
    let texels = |c: usize, k: usize| (sizes[c][k] * scale + 2.0 * MARGIN).ceil() as usize;
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    order.sort_by_key(|&c| (Reverse(texels(c, 1)), c));
    let mut ground = [0; SIZE];
    let mut corners = vec![[0.0; 2]; sizes.len()];
    for c in order {
        let (wide, tall) = (texels(c, 0), texels(c, 1));
        let level = |x: usize| ground[x..x + wide].iter().copied().max().unwrap_or(0);
        let x = (0..(SIZE + 1).checked_sub(wide)?).min_by_key(|&x| (level(x), x))?;
        let y = level(x);
        if y + tall > SIZE {
            return None;
        }
        ground[x..x + wide].fill(y + tall);
        corners[c] = [x as f64 + MARGIN, y as f64 + MARGIN];
    }
    Some(corners)
}
