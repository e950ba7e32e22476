//! Thinning of the half mesh by quadric edge collapses that are told where detail matters.
//! No moves of what remains.

use super::body::{Body, DROP};
use super::mesh::{Mesh, fans, ring, shape};
use super::shapes::{ball, ramp};
use super::skeleton::{HAND, UPPER_ARM};
use super::vectors::{V, add, cross, dot, len, mul, sub, unit};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Sum of squared distances to planes: upper half of a symmetric 4x4 matrix,
/// with the total weight last.
pub type Quadric = [f64; 11];

pub fn quadric_error(q: &Quadric, [x, y, z]: V) -> f64 {
    let e = q[0] * x * x
        + q[4] * y * y
        + q[7] * z * z
        + q[9]
        + 2.0 * (q[1] * x * y + q[2] * x * z + q[3] * x + q[5] * y * z + q[6] * y + q[8] * z);
    e.max(0.0) / q[10].max(1e-15)
}

/// Thins the half mesh by edge collapses until the mirrored whole would have
/// `target` vertices.
pub fn thin(body: &Body, mesh: &mut Mesh, target: usize) {
    let n = mesh.points.len();
    let mut quadrics: Vec<Quadric> = vec![[0.0; 11]; n];
    for face in &mesh.faces {
        let [p, q, r] = face.map(|v| mesh.points[v]);
        let normal = cross(sub(q, p), sub(r, p));
        let area = len(normal);
        let [a, b, c] = unit(normal);
        let d = -dot([a, b, c], p);
        let plane = [
            a * a,
            a * b,
            a * c,
            a * d,
            b * b,
            b * c,
            b * d,
            c * c,
            c * d,
            d * d,
            1.0,
        ];
        for &v in face {
            quadrics[v]
                .iter_mut()
                .zip(plane)
                .for_each(|(q, e)| *q += e * area);
        }
    }
    let weight: Vec<f64> = mesh.points.iter().map(|&p| detail(body, p)).collect();
    let mut fans = fans(mesh);
    let mut stamp = vec![0usize; n];
    let mut heap = BinaryHeap::new();
    // Best position of a merged edge and its cost: squared distance to the
    // gathered planes plus a term against long edges on flat ground.
    let plan = |points: &[V], quadrics: &[Quadric], u: usize, v: usize| {
        let (a, b) = (points[u], points[v]);
        let mut q = quadrics[u];
        q.iter_mut().zip(quadrics[v]).for_each(|(q, e)| *q += e);
        let mid = mul(add(a, b), 0.5);
        let spots = match (a[0] == 0.0, b[0] == 0.0) {
            (true, false) => [a, a, a],
            (false, true) => [b, b, b],
            _ => [mid, a, b],
        };
        let best = spots.into_iter().map(|s| (quadric_error(&q, s), s));
        let (error, spot) = best
            .reduce(|x, y| if y.0 < x.0 { y } else { x })
            .unwrap_or((0.0, mid));
        let d = sub(a, b);
        let flat = 0.7 * dot(d, d);
        let w = weight[u].max(weight[v]);
        ((error + flat * flat) * w * w, spot)
    };
    let key = |cost: f64| (cost * 1e15) as u64;
    let size = |p: V| if p[0] == 0.0 { 1 } else { 2 };
    let mut total: usize = mesh.points.iter().map(|&p| size(p)).sum();
    let mut dead = vec![false; mesh.faces.len()];
    let mut rounds = 0;
    while total > target {
        // Edges turned down once are tried again when all others are done.
        if heap.is_empty() && rounds < 6 {
            rounds += 1;
            for u in 0..n {
                for v in ring(&mesh.faces, &fans[u], u)
                    .into_iter()
                    .filter(|&v| v > u)
                {
                    let cost = plan(&mesh.points, &quadrics, u, v).0;
                    heap.push(Reverse((key(cost), u, v, stamp[u], stamp[v])));
                }
            }
        }
        let Some(Reverse((_, u, v, su, sv))) = heap.pop() else {
            break;
        };
        if stamp[u] != su || stamp[v] != sv {
            continue;
        }
        // Keep the border vertex, if there is one.
        let (u, v) = if mesh.points[u][0] == 0.0 {
            (v, u)
        } else {
            (u, v)
        };
        let (_, spot) = plan(&mesh.points, &quadrics, u, v);
        let shared: Vec<usize> = fans[u]
            .iter()
            .copied()
            .filter(|&f| mesh.faces[f].contains(&v))
            .collect();
        let (ru, rv) = (
            ring(&mesh.faces, &fans[u], u),
            ring(&mesh.faces, &fans[v], v),
        );
        let common: Vec<usize> = ru.iter().copied().filter(|w| rv.contains(w)).collect();
        let border = |w: usize| mesh.points[w][0] == 0.0;
        // An inner edge between two border vertices would double when mirrored.
        let pinches = common.len() != shared.len()
            || (border(u) && shared.len() != 1)
            || (border(v)
                && !border(u)
                && ru.iter().any(|&w| w != v && border(w) && !rv.contains(&w)))
            || common.iter().any(|&w| fans[w].len() <= 3 && !border(w))
            || ru.len() + rv.len() - 4 > ru.len().max(rv.len()).max(9);
        let spoils = |from: usize| {
            fans[from].iter().filter(|f| !shared.contains(f)).any(|&f| {
                let face = mesh.faces[f];
                let old = face.map(|w| mesh.points[w]);
                let new = face.map(|w| if w == from { spot } else { mesh.points[w] });
                let ((a, before), (b, after)) = (shape(old), shape(new));
                (before > 0.05 && dot(a, b) < 0.3) || after < before.min(0.10)
            })
        };
        if pinches || spoils(u) || spoils(v) {
            continue;
        }
        total -= size(mesh.points[u]);
        mesh.points[v] = spot;
        let merged = quadrics[u];
        quadrics[v]
            .iter_mut()
            .zip(merged)
            .for_each(|(q, e)| *q += e);
        for &f in &shared {
            dead[f] = true;
            for w in mesh.faces[f] {
                fans[w].retain(|&g| g != f);
            }
        }
        for f in std::mem::take(&mut fans[u]) {
            mesh.faces[f]
                .iter_mut()
                .filter(|w| **w == u)
                .for_each(|w| *w = v);
            fans[v].push(f);
        }
        stamp[u] += 1;
        stamp[v] += 1;
        for w in ring(&mesh.faces, &fans[v], v) {
            let (a, b) = (v.min(w), v.max(w));
            let cost = plan(&mesh.points, &quadrics, a, b).0;
            heap.push(Reverse((key(cost), a, b, stamp[a], stamp[b])));
        }
    }
    // Drop what is no longer used.
    let mut index = vec![usize::MAX; n];
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for (face, _) in mesh.faces.iter().zip(&dead).filter(|(_, dead)| !**dead) {
        faces.push(face.map(|v| {
            if index[v] == usize::MAX {
                index[v] = points.len();
                points.push(mesh.points[v]);
            }
            index[v]
        }));
    }
    *mesh = Mesh { points, faces };
}

/// How much finer than elsewhere the surface is kept around `p`.
pub fn detail(body: &Body, p: V) -> f64 {
    let h = body.in_head(p);
    let face = ramp(h[2], 0.035, 0.07) * ramp(h[1], -0.03, 0.0) * (1.0 - ramp(h[1], 0.14, 0.18));
    let near = |at: V, inner: f64, outer: f64| 1.0 - ramp(ball(h, at, 0.0), inner, outer);
    let eye = near([0.0350, 0.1020, 0.086], 0.020, 0.034);
    let mouth = near([0.0, 0.045, 0.10], 0.026, 0.045);
    let ear = near([0.085, 0.09, 0.0], 0.02, 0.045);
    let head = ramp(p[1], 1.44, 1.48);
    let hand = ramp(body.local(HAND, p)[0], -0.02, 0.03);
    let sleeve = body.local(UPPER_ARM, p)[0];
    let cuff = ramp(sleeve, 0.10, 0.14) * (1.0 - ramp(sleeve, 0.17, 0.20));
    let band = |at: f64, size: f64| 1.0 - ramp((p[1] + DROP - at).abs(), 0.5 * size, size);
    let collar = band(1.45, 0.06) * (1.0 - ramp(p[0], 0.07, 0.10));
    let hem = band(0.962, 0.04) * (1.0 - ramp(p[0], 0.20, 0.24));
    let foot = 1.0 - ramp(p[1], 0.25, 0.35);
    let shoulder = 1.0 - ramp(ball(p, body.frames[UPPER_ARM].at, 0.0), 0.06, 0.12);
    1.0 + 0.8 * head
        + 3.6 * face
        + 10.0 * eye
        + 5.0 * mouth
        + 2.5 * ear
        + 2.0 * hand
        + 0.8 * shoulder
        + 1.0 * cuff
        + 0.8 * collar
        + 0.6 * hem
        - 0.62 * foot
}
