//! `figure.png`: every texel of the unwrapped surface coloured by the place it lies on, and shaded where little light gets.
//! The colours themselves are paint.rs's.

use super::body::Body;
use super::pack::SIZE;
use super::paint::paint;
use super::surface::Surface;
use super::unwrap::Unwrap;
use super::vectors::{V, add, mul, sub, unit};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _};

/// The picture's texels, top row first, as sRGB bytes.
pub fn texels(body: &Body, surface: &Surface, unwrap: &Unwrap) -> Vec<u8> {
    let mut picture = vec![None; SIZE * SIZE];
    for &f in &unwrap.owners {
        bake(body, surface, unwrap, f, &mut picture);
    }
    for _ in 0..6 {
        spread(&mut picture);
    }
    let bytes = picture.iter().flat_map(|c| c.unwrap_or(EMPTY));
    bytes.map(|c| c.clamp(0.0, 255.0).round() as u8).collect()
}

pub fn encode(texels: &[u8]) -> Result<Vec<u8>, image::ImageError> {
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive)
        .write_image(texels, SIZE as u32, SIZE as u32, ExtendedColorType::Rgb8)?;
    Ok(png)
}

/// What is between the charts, where no triangle looks.
const EMPTY: V = [150.0, 130.0, 115.0];

fn bake(body: &Body, surface: &Surface, unwrap: &Unwrap, f: usize, picture: &mut [Option<V>]) {
    let size = SIZE as f64;
    let corners = unwrap.faces[f].map(|v| {
        let [u, v] = unwrap.texcoords[v];
        [u * size, (1.0 - v) * size, 0.0]
    });
    let vertices = unwrap.faces[f].map(|v| unwrap.sources[v]);
    let [a, b, c] = corners;
    let (ab, ac) = (sub(b, a), sub(c, a));
    let area = ab[0] * ac[1] - ab[1] * ac[0];
    if area == 0.0 {
        return;
    }
    let range = |k: usize| {
        let low = corners.iter().map(|c| c[k]).fold(size, f64::min).floor();
        let high = corners.iter().map(|c| c[k]).fold(0.0, f64::max).ceil();
        low.max(0.0) as usize..high.min(size) as usize
    };
    for row in range(1) {
        for column in range(0) {
            let d = sub([column as f64 + 0.5, row as f64 + 0.5, 0.0], a);
            let s = (d[0] * ac[1] - d[1] * ac[0]) / area;
            let t = (ab[0] * d[1] - ab[1] * d[0]) / area;
            if s < -1e-9 || t < -1e-9 || s + t > 1.0 + 1e-9 {
                continue;
            }
            let blend = |of: &[V]| {
                let [a, b, c] = vertices.map(|v| of[v]);
                add(add(mul(a, 1.0 - s - t), mul(b, s)), mul(c, t))
            };
            let p = blend(&surface.points);
            let normal = unit(blend(&surface.normals));
            let light = openness(body, p, normal);
            picture[row * SIZE + column] = Some(mul(paint(body, p), light));
        }
    }
}

/// 1 in the open, less in folds: how much of the room before a place on the surface is free.
fn openness(body: &Body, p: V, normal: V) -> f64 {
    let mut hidden = 0.0;
    for (step, weight) in [(0.008, 0.34), (0.02, 0.30), (0.045, 0.22), (0.08, 0.14)] {
        let free = body.field(add(p, mul(normal, step))) / step;
        hidden += weight * (1.0 - free).clamp(0.0, 1.0);
    }
    // In steps that the eye does not see, for the sake of a small file.
    1.0 - (0.6 * (hidden - 0.07).max(0.0) * 64.0).round() / 64.0
}

/// Gives texels beside coloured ones their mean, so that filtering at a chart's rim finds its own colours.
fn spread(picture: &mut [Option<V>]) {
    let old = picture.to_vec();
    for (i, texel) in picture.iter_mut().enumerate().filter(|(_, t)| t.is_none()) {
        let (x, y) = (i % SIZE, i / SIZE);
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for row in y.saturating_sub(1)..(y + 2).min(SIZE) {
            for column in x.saturating_sub(1)..(x + 2).min(SIZE) {
                if let Some(c) = old[row * SIZE + column] {
                    sum = add(sum, c);
                    count += 1.0;
                }
            }
        }
        *texel = (count > 0.0).then(|| mul(sum, 1.0 / count));
    }
}
