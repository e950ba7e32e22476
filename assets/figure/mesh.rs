//! The finely meshed half of the body: marching tetrahedra, and what is asked of any mesh of it.
//! No thinning.

use super::body::Body;
use super::vectors::{V, add, cross, dot, len, mul, sub, unit};
use std::collections::BTreeMap;

/// A triangle mesh of the left half; points with `x == 0` are on its border.
pub struct Mesh {
    pub points: Vec<V>,
    pub faces: Vec<[usize; 3]>,
}

/// Grid lines from the first to the last `start` with the given steps between.
pub fn axis(runs: &[(f64, f64)], end: f64) -> Vec<f64> {
    let mut lines = Vec::new();
    for (i, &(start, step)) in runs.iter().enumerate() {
        let stop = runs.get(i + 1).map_or(end, |r| r.0);
        let n = ((stop - start) / step).round().max(1.0);
        lines.extend((0..n as usize).map(|k| start + (stop - start) * k as f64 / n));
    }
    lines.push(end);
    lines
}

/// Marching tetrahedra over a rectilinear grid that is denser through the head
/// and the hands.  Only blocks of the grid near the surface are sampled.
pub fn march(body: &Body) -> Mesh {
    let xs = axis(&[(0.0, 0.0034), (0.110, 0.0065), (0.50, 0.0042)], 0.74);
    let ys = axis(
        &[
            (-0.0313, 0.0055),
            (0.12, 0.0072),
            (0.75, 0.0042),
            (1.0, 0.0075),
            (1.43, 0.0036),
        ],
        1.83,
    );
    let zs = axis(
        &[
            (-0.171, 0.0075),
            (-0.06, 0.0046),
            (0.06, 0.0034),
            (0.15, 0.007),
        ],
        0.23,
    );
    let (nx, ny, nz) = (xs.len(), ys.len(), zs.len());
    let node = |i: usize, j: usize, k: usize| (i * ny + j) * nz + k;
    let place = |n: usize| [xs[n / (ny * nz)], ys[n / nz % ny], zs[n % nz]];
    let mut value = vec![1.0; nx * ny * nz];
    pub const B: usize = 6;
    let blocks = |n: usize| (0..n.div_ceil(B)).map(move |b| b * B..((b + 1) * B).min(n));
    for bi in blocks(nx) {
        for bj in blocks(ny) {
            for bk in blocks(nz) {
                let low = [xs[bi.start], ys[bj.start], zs[bk.start]];
                let high = [xs[bi.end - 1], ys[bj.end - 1], zs[bk.end - 1]];
                let centre = body.field(mul(add(low, high), 0.5));
                let far = centre.abs() > 0.7 * len(sub(high, low)) + 0.012;
                for i in bi.clone() {
                    for j in bj.clone() {
                        for k in bk.clone() {
                            let d = if far {
                                centre
                            } else {
                                body.field([xs[i], ys[j], zs[k]])
                            };
                            // Stay clear of the nodes themselves.
                            value[node(i, j, k)] = if d < 0.0 { d.min(-1e-4) } else { d.max(1e-4) };
                        }
                    }
                }
            }
        }
    }
    let mut mesh = Mesh {
        points: Vec::new(),
        faces: Vec::new(),
    };
    let mut cuts: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let step = [node(1, 0, 0), node(0, 1, 0), node(0, 0, 1)];
    pub const ORDERS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    for i in 0..nx - 1 {
        for j in 0..ny - 1 {
            for k in 0..nz - 1 {
                let n = node(i, j, k);
                for [a, b, _] in ORDERS {
                    let far = n + step.iter().sum::<usize>();
                    let tet = [n, n + step[a], n + step[a] + step[b], far];
                    let (inner, outer): (Vec<usize>, Vec<usize>) =
                        tet.iter().partition(|&&t| value[t] < 0.0);
                    if inner.is_empty() || outer.is_empty() {
                        continue;
                    }
                    let mut cut = |a: usize, b: usize| {
                        let next = mesh.points.len();
                        *cuts.entry((a.min(b), a.max(b))).or_insert_with(|| {
                            let t = value[a] / (value[a] - value[b]);
                            mesh.points
                                .push(add(mul(place(a), 1.0 - t), mul(place(b), t)));
                            next
                        })
                    };
                    let mut loops = Vec::new();
                    match (&inner[..], &outer[..]) {
                        (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => {
                            loops.push([cut(a, b), cut(a, c), cut(a, d)]);
                        }
                        (&[a, b], &[c, d]) => {
                            let quad = [cut(a, c), cut(a, d), cut(b, d), cut(b, c)];
                            loops.push([quad[0], quad[1], quad[2]]);
                            loops.push([quad[0], quad[2], quad[3]]);
                        }
                        _ => {}
                    }
                    let outward = sub(place(outer[0]), place(inner[0]));
                    for [a, b, c] in loops {
                        let [p, q, r] = [a, b, c].map(|v| mesh.points[v]);
                        let flipped = dot(cross(sub(q, p), sub(r, p)), outward) < 0.0;
                        mesh.faces.push(if flipped { [a, c, b] } else { [a, b, c] });
                    }
                }
            }
        }
    }
    // Plain smoothing rounds off the slivers that marching leaves behind.
    let fans = fans(&mesh);
    for _ in 0..3 {
        let old = mesh.points.clone();
        for (v, p) in mesh.points.iter_mut().enumerate() {
            let border = p[0] == 0.0;
            let (mut sum, mut count) = (*p, 1.0);
            for u in ring(&mesh.faces, &fans[v], v) {
                if !border || old[u][0] == 0.0 {
                    sum = add(sum, old[u]);
                    count += 1.0;
                }
            }
            *p = mul(sum, 1.0 / count);
        }
    }
    for p in &mut mesh.points {
        *p = body.project(*p, 2);
    }
    mesh
}

/// Neighbouring faces of every vertex.
pub fn fans(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut fans = vec![Vec::new(); mesh.points.len()];
    for (f, face) in mesh.faces.iter().enumerate() {
        face.iter().for_each(|&v| fans[v].push(f));
    }
    fans
}

pub fn ring(faces: &[[usize; 3]], fan: &[usize], v: usize) -> Vec<usize> {
    let mut ring: Vec<usize> = fan
        .iter()
        .flat_map(|&f| faces[f])
        .filter(|&u| u != v)
        .collect();
    ring.sort_unstable();
    ring.dedup();
    ring
}

/// Unit normal of a triangle and a measure of how far it is from a sliver.
pub fn shape([p, q, r]: [V; 3]) -> (V, f64) {
    let normal = cross(sub(q, p), sub(r, p));
    let edges: f64 = [sub(p, q), sub(q, r), sub(r, p)]
        .iter()
        .map(|&e| dot(e, e))
        .sum();
    (unit(normal), len(normal) / edges.max(1e-18))
}
