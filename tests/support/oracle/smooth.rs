//! Normals where a file has none. Never lives here: what joints and morphs make of them.

use super::matrix::{Vector, along, cross, difference, length};
use std::collections::BTreeMap;

/// How far rounding may turn a normal that is made from rounded positions, in radians: half of what is tolerated.
const ROUNDING: f64 = 5e-4;

/// Of each vertex the sum of its triangles' cross products, which are twice their areas long. `None` where float32 positions decide the
/// direction, and where vertices share a place, since nothing says whether they share a normal as well.
pub fn normals(positions: &[Vector], triangles: &[[usize; 3]]) -> Vec<Option<Vector>> {
    let mut sums = vec![[0.0; 3]; positions.len()];
    let mut shaken = vec![0.0; positions.len()];
    for triangle in triangles {
        let corners = triangle.map(|corner| positions[corner]);
        let [a, b, c] = corners;
        let area = cross(difference(b, a), difference(c, a));
        let shake = area_shake(corners);
        for &corner in triangle {
            sums[corner] = along(sums[corner], 1.0, area);
            shaken[corner] += shake;
        }
    }
    let mut standing: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    for position in positions {
        *standing.entry(position.map(f64::to_bits)).or_default() += 1;
    }
    let normal = |vertex: usize| {
        let size = length(sums[vertex]);
        let is_alone = standing[&positions[vertex].map(f64::to_bits)] == 1;
        (is_alone && shaken[vertex] < ROUNDING * size).then(|| sums[vertex].map(|x| x / size))
    };
    (0..positions.len()).map(normal).collect()
}

/// How much a triangle's cross product may change: half a step of each corner moves the edge before it, and the product is rounded.
fn area_shake([a, b, c]: [Vector; 3]) -> f64 {
    let half_step = f64::from(f32::EPSILON) / 2.0;
    let [opposite_a, opposite_b, opposite_c] =
        [difference(c, b), difference(a, c), difference(b, a)].map(length);
    let by_corners = length(a) * opposite_a + length(b) * opposite_b + length(c) * opposite_c;
    half_step * (by_corners + 2.0 * opposite_b * opposite_c)
}
