//! `smile.morph` and `blink.morph`: where the vertices of the face go, and how it is shaded then.
//! No other part of the body moves.

use super::body::{Body, EYE, EYE_RADIUS};
use super::shapes::{ball, ramp};
use super::skin::triple;
use super::surface::Surface;
use super::unwrap::Unwrap;
use super::vectors::{V, add, angle, cross, len, mul, sin_cos, sub, unit};
use std::fmt::Write as _;

/// The mouth's corners go up and out, the cheeks and the lower lids follow.
pub fn smile(h: V) -> V {
    let near = |at: V, r: f64| 1.0 - ramp(ball(h, at, 0.0), 0.1 * r, r);
    let mut to = h;
    for (at, r, shift) in [
        ([0.031, 0.041, 0.087], 0.030, [0.0090, 0.0105, -0.0070]),
        ([0.000, 0.028, 0.097], 0.022, [0.0, -0.0040, 0.0]),
        ([0.045, 0.066, 0.074], 0.032, [0.0030, 0.0060, 0.0050]),
        ([0.035, 0.083, 0.086], 0.018, [0.0, 0.0025, 0.0010]),
        ([0.040, 0.141, 0.085], 0.026, [0.0010, 0.0040, 0.0]),
    ] {
        to = add(to, mul(shift, near(at, r)));
    }
    to
}

/// The upper lid turns about the eye's middle until it meets the lower one.
pub fn blink(h: V) -> V {
    let e = sub(h, EYE);
    let r = len(e);
    let up = angle(e[1], e[2]);
    // Lids lie on a ball around the eyeball; the eyeball itself stays.
    let lid = ramp(r, EYE_RADIUS + 0.0008, EYE_RADIUS + 0.0028) * (1.0 - ramp(r, 0.029, 0.034));
    let upper = ramp(up, 0.0, 20.0) * (1.0 - ramp(up, 34.0, 80.0));
    let (s, c) = sin_cos(BLINK * lid * upper * std::f64::consts::PI / 180.0);
    let turned = [e[0], e[1] * c - e[2] * s, e[1] * s + e[2] * c];
    add(EYE, turned)
}

/// Degrees between the edges of the open lids.
const BLINK: f64 = 52.0;

/// The text of a morph target that takes every place `h` of the left half of the head to `to(h)`.
pub fn morph(body: &Body, surface: &Surface, unwrap: &Unwrap, to: fn(V) -> V) -> String {
    let moved: Vec<V> = (surface.points.iter().zip(&surface.right))
        .map(|(&p, &right)| {
            let side = if right { -1.0 } else { 1.0 };
            let h = body.in_head([p[0].abs(), p[1], p[2]]);
            let [x, y, z] = body.out_of_head(sub(to(h), h));
            // The seam between the halves stays closed.
            let x = if p[0] == 0.0 { 0.0 } else { side * x };
            add(p, [x, y, z])
        })
        .collect();
    let (before, after) = (shading(surface, &surface.points), shading(surface, &moved));
    let normal = |v: usize| unit(add(surface.normals[v], sub(after[v], before[v])));
    let touched = |&i: &usize| {
        let v = unwrap.sources[i];
        len(sub(moved[v], surface.points[v])) > 2e-5 || len(sub(after[v], before[v])) > 1e-2
    };
    let touched: Vec<usize> = (0..unwrap.sources.len()).filter(touched).collect();
    let mut out = String::new();
    let mut block = |name: &str, of: &dyn Fn(usize) -> V| {
        let _ = writeln!(out, "{name} {} {{", touched.len());
        for &i in &touched {
            let _ = writeln!(out, "  {i} {}", triple(of(unwrap.sources[i])));
        }
        out.push_str("}\n");
    };
    block("positions", &|v| moved[v]);
    block("normals", &normal);
    out
}

/// Normals from the triangles around every vertex, for what changes between two shapes.
fn shading(surface: &Surface, points: &[V]) -> Vec<V> {
    let mut sums = vec![[0.0; 3]; points.len()];
    for &[a, b, c] in &surface.faces {
        let normal = cross(sub(points[b], points[a]), sub(points[c], points[a]));
        for v in [a, b, c] {
            sums[v] = add(sums[v], normal);
        }
    }
    sums.into_iter().map(unit).collect()
}
