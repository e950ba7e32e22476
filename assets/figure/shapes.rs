//! Distance-field shapes and the ways to put them together.
//! No part of the body.

use super::vectors::{V, dot, len, mul, sub};

/// 0 below `a`, 1 above `b`, smooth between.
pub fn ramp(x: f64, a: f64, b: f64) -> f64 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Smooth union: the two shapes flow together over a distance of about `k`.
pub fn join(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0);
    a.min(b) - h * h / (4.0 * k)
}

/// Smooth intersection.
pub fn meet(a: f64, b: f64, k: f64) -> f64 {
    -join(-a, -b, k)
}

/// Smooth subtraction of `b` from `a`.
pub fn carve(a: f64, b: f64, k: f64) -> f64 {
    meet(a, -b, k)
}

pub fn ball(p: V, c: V, r: f64) -> f64 {
    len(sub(p, c)) - r
}

pub fn ellipsoid(p: V, c: V, r: V) -> f64 {
    let d = sub(p, c);
    let a = [d[0] / r[0], d[1] / r[1], d[2] / r[2]];
    let b = [a[0] / r[0], a[1] / r[1], a[2] / r[2]];
    let (ka, kb) = (len(a), len(b));
    if kb < 1e-9 {
        -r[0].min(r[1]).min(r[2])
    } else {
        ka * (ka - 1.0) / kb
    }
}

/// A capsule whose radius runs from `ra` to `rb`.
pub fn bone(p: V, a: V, b: V, ra: f64, rb: f64) -> f64 {
    let (d, e) = (sub(p, a), sub(b, a));
    let t = (dot(d, e) / dot(e, e)).clamp(0.0, 1.0);
    len(sub(d, mul(e, t))) - (ra + (rb - ra) * t)
}

/// A tube of elliptic cross-sections `[s, ru, rv, cu, cv]` along an axis: at
/// height `s` the section is centred on `(cu, cv)` with radii `ru`, `rv`.  The
/// ends are cut flat with an edge rounded by `k`.
pub fn loft(s: f64, u: f64, v: f64, rows: &[[f64; 5]], k: f64) -> f64 {
    let last = rows.len() - 1;
    let c = s.clamp(rows[0][0], rows[last][0]);
    let i = (1..last).find(|&i| c < rows[i][0]).unwrap_or(last);
    let (a, b) = (rows[i - 1], rows[i]);
    let span = b[0] - a[0];
    let t = (c - a[0]) / span;
    let slope = |j: usize, n: usize| {
        let (lo, hi) = (rows[j.saturating_sub(1)], rows[(j + 1).min(last)]);
        (hi[n] - lo[n]) / (hi[0] - lo[0])
    };
    let at = |n: usize| {
        let (t2, t3) = (t * t, t * t * t);
        (2.0 * t3 - 3.0 * t2 + 1.0) * a[n]
            + (t3 - 2.0 * t2 + t) * span * slope(i - 1, n)
            + (3.0 * t2 - 2.0 * t3) * b[n]
            + (t3 - t2) * span * slope(i, n)
    };
    let (ru, rv) = (at(1), at(2));
    let side = ellipsoid([u - at(3), v - at(4), 0.0], [0.0; 3], [ru, rv, 1.0]);
    let (mid, half) = (
        0.5 * (rows[0][0] + rows[last][0]),
        0.5 * (rows[last][0] - rows[0][0]),
    );
    meet(side, (s - mid).abs() - half, k)
}
