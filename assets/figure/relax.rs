//! The thinned half mesh brought into shape: edges flipped, vertices slid along the surface, normals.
//! No change to the number of vertices.

use super::body::Body;
use super::mesh::{Mesh, fans, march, ring, shape};
use super::shapes::ramp;
use super::thin::{detail, thin};
use super::vectors::{V, add, dot, len, mul, sub, unit};
use std::collections::BTreeMap;

/// Flips inner edges where that gives better-shaped triangles that still
/// follow the surface.
pub fn flip(body: &Body, mesh: &mut Mesh, normals: &[V]) {
    let mut edges: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for (f, t) in mesh.faces.iter().enumerate() {
        edges.extend((0..3).map(|i| ((t[i], t[(i + 1) % 3]), f)));
    }
    let quality = |mesh: &Mesh, t: [usize; 3]| {
        let (normal, even) = shape(t.map(|v| mesh.points[v]));
        let facing = t
            .iter()
            .map(|&v| dot(normal, normals[v]))
            .fold(1.0, f64::min);
        even.min(0.35)
            * if facing < 0.1 {
                0.01
            } else {
                0.3 + 0.7 * facing
            }
    };
    let keys: Vec<_> = edges.keys().copied().filter(|&(a, b)| a < b).collect();
    for (a, b) in keys {
        let (Some(&f), Some(&g)) = (edges.get(&(a, b)), edges.get(&(b, a))) else {
            continue;
        };
        let other = |t: [usize; 3]| t.into_iter().find(|&v| v != a && v != b).unwrap_or(a);
        let (c, d) = (other(mesh.faces[f]), other(mesh.faces[g]));
        let on_border = mesh.points[c][0] == 0.0 && mesh.points[d][0] == 0.0;
        if c == d || on_border || edges.contains_key(&(c, d)) || edges.contains_key(&(d, c)) {
            continue;
        }
        let (new_f, new_g) = ([a, d, c], [d, b, c]);
        let fit = |u: usize, v: usize| {
            let (p, q) = (mesh.points[u], mesh.points[v]);
            let off = 25.0 * body.field(mul(add(p, q), 0.5)) / len(sub(p, q));
            1.0 / (1.0 + off * off)
        };
        let before = quality(mesh, mesh.faces[f]).min(quality(mesh, mesh.faces[g])) * fit(a, b);
        let after = quality(mesh, new_f).min(quality(mesh, new_g)) * fit(c, d);
        if after > 1.05 * before {
            mesh.faces[f] = new_f;
            mesh.faces[g] = new_g;
            edges.remove(&(a, b));
            edges.remove(&(b, a));
            for (t, f) in [(new_f, f), (new_g, g)] {
                edges.extend((0..3).map(|i| ((t[i], t[(i + 1) % 3]), f)));
            }
        }
    }
}

/// Slides vertices along the surface toward the middle of their neighbours.
pub fn relax(body: &Body, mesh: &mut Mesh, normals: &[V]) {
    let fans = fans(mesh);
    let old = mesh.points.clone();
    for (v, p) in mesh.points.iter_mut().enumerate() {
        let ring = ring(&mesh.faces, &fans[v], v);
        // Creases (where normals disagree) hold their vertices.
        let crease = ring
            .iter()
            .map(|&u| dot(normals[u], normals[v]))
            .fold(1.0, f64::min);
        let pull = 0.35 * ramp(crease, 0.2, 0.8);
        let border = p[0] == 0.0;
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for &u in ring.iter().filter(|&&u| !border || old[u][0] == 0.0) {
            sum = add(sum, old[u]);
            count += 1.0;
        }
        let shift = sub(mul(sum, 1.0 / f64::max(count, 1.0)), *p);
        let along = sub(shift, mul(normals[v], dot(shift, normals[v])));
        let moved = body.project(add(*p, mul(along, pull)), 2);
        // Stay put where the step would fold the surface over.
        let folds = fans[v].iter().any(|&f| {
            let face = mesh.faces[f];
            let facing = |at: V| {
                let corners = face.map(|w| if w == v { at } else { old[w] });
                dot(shape(corners).0, normals[v])
            };
            facing(moved) < facing(old[v]).min(0.0)
        });
        if !folds && (border || moved[0] > 1e-4) {
            *p = moved;
        }
    }
}

/// The finished half of the surface with its normals.
pub fn half_surface(body: &Body) -> (Mesh, Vec<V>) {
    let mut mesh = march(body);
    thin(body, &mut mesh, 4960);
    for p in &mut mesh.points {
        *p = body.project(*p, 2);
    }
    let normals = |m: &Mesh| -> Vec<V> {
        let fans = fans(m);
        let of = |v: usize| {
            let p = m.points[v];
            let n = unit(body.gradient(p, 3e-3 / detail(body, p).max(1.0)));
            // Where a fold is too tight for the mesh, follow the faces instead.
            let faces = fans[v]
                .iter()
                .map(|&f| shape(m.faces[f].map(|w| m.points[w])).0);
            let (mut sum, mut least) = ([0.0; 3], 1.0_f64);
            for face in faces {
                least = least.min(dot(face, n));
                sum = add(sum, face);
            }
            if p[0] == 0.0 {
                sum[0] = 0.0;
            }
            if least < 0.1 {
                unit(add(n, mul(sum, 1.0 / fans[v].len() as f64)))
            } else {
                n
            }
        };
        (0..m.points.len()).map(of).collect()
    };
    for _ in 0..6 {
        let n = normals(&mesh);
        flip(body, &mut mesh, &n);
        relax(body, &mut mesh, &n);
    }
    let n = normals(&mesh);
    flip(body, &mut mesh, &n);
    (mesh, n)
}
