//! Generator of the built-in figure: a posable, skinned humanoid in the
//! `.skel` / `.skin` text formats.
//!
//! ```text
//! rustc --edition 2024 -O assets/figure.rs -o figure
//! ./figure assets        # writes assets/figure.skel and assets/figure.skin
//! ```
//!
//! The left half of the body is described as a signed distance field whose
//! parts live in the frames of the bones they belong to.  The field is meshed
//! finely with marching tetrahedra, thinned by quadric edge collapses that are
//! told where detail matters (face, hands), relaxed, and mirrored into one
//! closed surface.  Only + - * / and square roots are used (the trigonometry is
//! a local series), so the output is the same on every machine.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::fmt::Write as _;

// ---------------------------------------------------------------- vectors

type V = [f64; 3];

fn add(a: V, b: V) -> V {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
fn mul(a: V, s: f64) -> V {
    [a[0] * s, a[1] * s, a[2] * s]
}
fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross(a: V, b: V) -> V {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
fn len(a: V) -> f64 {
    dot(a, a).sqrt()
}
fn unit(a: V) -> V {
    mul(a, 1.0 / len(a).max(1e-12))
}

/// Sine and cosine by Taylor series, identical on every platform.
fn sin_cos(x: f64) -> (f64, f64) {
    let (mut s, mut c, mut term) = (0.0, 0.0, 1.0);
    for n in 0..24 {
        let signed = if n % 4 < 2 { term } else { -term };
        *(if n % 2 == 0 { &mut c } else { &mut s }) += signed;
        term *= x / f64::from(n + 1);
    }
    (s, c)
}

/// A rigid frame: three column axes and an origin.
#[derive(Clone, Copy)]
struct Frame {
    axes: [V; 3],
    at: V,
}

impl Frame {
    const WORLD: Frame = Frame {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        at: [0.0; 3],
    };

    fn direction(&self, d: V) -> V {
        let [a, b, c] = self.axes;
        add(add(mul(a, d[0]), mul(b, d[1])), mul(c, d[2]))
    }

    /// The frame of a child joint: `self * T(offset) * Rz * Ry * Rx`.
    fn child(&self, offset: V, degrees: V) -> Frame {
        let [(sx, cx), (sy, cy), (sz, cz)] =
            degrees.map(|d| sin_cos(d * std::f64::consts::PI / 180.0));
        let columns = [
            [cz * cy, sz * cy, -sy],
            [cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx],
            [cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx],
        ];
        Frame {
            axes: columns.map(|c| self.direction(c)),
            at: add(self.at, self.direction(offset)),
        }
    }

    fn to_local(self, p: V) -> V {
        let d = sub(p, self.at);
        self.axes.map(|a| dot(a, d))
    }
}

// --------------------------------------------------------- skeleton table

/// One joint (of the left side or the middle).  Angles are in degrees.
struct Bone {
    name: &'static str,
    parent: &'static str,
    offset: V,
    bounds: [V; 2],
    limits: [[f64; 2]; 3],
    /// Rotation at which the surface is modelled and bound.
    bind: V,
    /// Rest pose of the left (or middle) joint, and of its right twin, the
    /// latter already in the right side's own sense.
    pose: [V; 2],
}

macro_rules! bones {
    ($($name:ident < $parent:ident at $at:tt box $lo:tt $hi:tt
       lim $x:tt $y:tt $z:tt bind $bind:tt pose $l:tt $r:tt;)*) => {
        [$(Bone {
            name: stringify!($name),
            parent: stringify!($parent),
            offset: $at,
            bounds: [$lo, $hi],
            limits: [$x, $y, $z],
            bind: $bind,
            pose: [$l, $r],
        }),*]
    };
}

/// Middle joints, then an arm, then a leg; in depth-first order.
#[rustfmt::skip]
const BONES: [Bone; 15] = bones! {
    pelvis < none at [0.0, 0.888, 0.0] box [-0.15, -0.10, -0.10] [0.15, 0.07, 0.09]
        lim [-60.0, 60.0] [-180.0, 180.0] [-60.0, 60.0] bind [0.0; 3]
        pose [0.0, 4.0, 4.0] [0.0; 3];
    spine < pelvis at [0.0, 0.085, -0.01] box [-0.12, 0.0, -0.07] [0.12, 0.14, 0.09]
        lim [-20.0, 40.0] [-25.0, 25.0] [-22.0, 22.0] bind [0.0; 3]
        pose [-2.0, -4.0, -4.5] [0.0; 3];
    chest < spine at [0.0, 0.155, -0.005] box [-0.15, 0.0, -0.09] [0.15, 0.24, 0.11]
        lim [-20.0, 30.0] [-25.0, 25.0] [-20.0, 20.0] bind [0.0; 3]
        pose [1.0, -5.0, -3.5] [0.0; 3];
    neck < chest at [0.0, 0.265, -0.015] box [-0.05, 0.0, -0.05] [0.05, 0.085, 0.05]
        lim [-30.0, 35.0] [-40.0, 40.0] [-25.0, 25.0] bind [0.0; 3]
        pose [2.0, 7.0, 1.5] [0.0; 3];
    head < neck at [0.0, 0.085, 0.01] box [-0.09, -0.02, -0.10] [0.09, 0.245, 0.115]
        lim [-25.0, 25.0] [-45.0, 45.0] [-20.0, 20.0] bind [0.0; 3]
        pose [-1.0, 10.0, 3.0] [0.0; 3];

    clavicle < chest at [0.025, 0.205, 0.02] box [0.0, -0.025, -0.04] [0.135, 0.03, 0.02]
        lim [-5.0, 5.0] [-20.0, 20.0] [-10.0, 35.0] bind [0.0; 3]
        pose [0.0, 0.0, -2.0] [0.0, 0.0, 2.0];
    upper_arm < clavicle at [0.143, 0.005, -0.03] box [0.0, -0.05, -0.05] [0.27, 0.05, 0.05]
        lim [-85.0, 85.0] [-120.0, 45.0] [-88.0, 100.0] bind [0.0, 0.0, -47.0]
        pose [12.0, -4.0, -71.0] [14.0, 8.0, 71.0];
    forearm < upper_arm at [0.27, 0.0, 0.0] box [0.0, -0.04, -0.04] [0.245, 0.04, 0.04]
        lim [-75.0, 85.0] [-145.0, 2.0] [0.0, 0.0] bind [0.0, -12.0, 0.0]
        pose [-8.0, -26.0, 0.0] [-5.0, 38.0, 0.0];
    hand < forearm at [0.245, 0.0, 0.0] box [0.0, -0.02, -0.045] [0.095, 0.02, 0.045]
        lim [-5.0, 5.0] [-25.0, 30.0] [-75.0, 70.0] bind [0.0; 3]
        pose [0.0, 0.0, -6.0] [0.0, 0.0, 8.0];
    fingers < hand at [0.092, 0.002, 0.0] box [0.0, -0.016, -0.045] [0.088, 0.012, 0.045]
        lim [0.0, 0.0] [-6.0, 6.0] [-95.0, 20.0] bind [0.0, 0.0, -6.0]
        pose [0.0, 0.0, -24.0] [0.0, 0.0, 30.0];
    thumb < hand at [0.022, -0.006, 0.024] box [0.0, -0.03, 0.0] [0.055, 0.01, 0.06]
        lim [-25.0, 25.0] [-30.0, 40.0] [-35.0, 30.0] bind [0.0; 3]
        pose [8.0, 8.0, -8.0] [8.0, -8.0, 8.0];

    thigh < pelvis at [0.09, -0.035, 0.0] box [-0.08, -0.39, -0.085] [0.08, 0.0, 0.085]
        lim [-118.0, 25.0] [-40.0, 45.0] [-25.0, 48.0] bind [0.0, 0.0, 4.0]
        pose [-1.0, 4.0, -5.5] [-13.5, -18.0, -8.0];
    shin < thigh at [0.0, -0.395, 0.0] box [-0.055, -0.385, -0.065] [0.055, 0.0, 0.06]
        lim [0.0, 145.0] [0.0, 0.0] [0.0, 0.0] bind [2.0, 0.0, 0.0]
        pose [3.0, 0.0, 0.0] [19.0, 0.0, 0.0];
    foot < shin at [0.0, -0.385, -0.004] box [-0.045, -0.08, -0.06] [0.05, 0.03, 0.115]
        lim [-30.0, 48.0] [-20.0, 20.0] [-22.0, 22.0] bind [-2.0, 7.0, -4.0]
        pose [-2.0, 4.0, 1.5] [-5.5, -6.0, 4.0];
    toes < foot at [0.004, -0.058, 0.112] box [-0.045, -0.022, 0.0] [0.04, 0.03, 0.08]
        lim [-60.0, 30.0] [0.0, 0.0] [0.0, 0.0] bind [0.0; 3]
        pose [0.0; 3] [0.0; 3];
};

// Indices into BONES, which are also those of the left half in the .skel file
// up to the first right-hand joint.
const PELVIS: usize = 0;
const SPINE: usize = 1;
const CHEST: usize = 2;
const NECK: usize = 3;
const HEAD: usize = 4;
const CLAVICLE: usize = 5;
const UPPER_ARM: usize = 6;
const FOREARM: usize = 7;
const HAND: usize = 8;
const FINGERS: usize = 9;
const THUMB: usize = 10;
const THIGH: usize = 11;
const SHIN: usize = 12;
const FOOT: usize = 13;
const TOES: usize = 14;

/// A joint of the finished skeleton: a table row and the side it is on.
#[derive(Clone, Copy)]
struct Joint {
    bone: usize,
    right: bool,
}

/// All joints in depth-first order: middle, arm, other arm, leg, other leg.
fn joints() -> Vec<Joint> {
    let run = |range: std::ops::Range<usize>, right| range.map(move |bone| Joint { bone, right });
    run(0..CLAVICLE, false)
        .chain(run(CLAVICLE..THIGH, false))
        .chain(run(CLAVICLE..THIGH, true))
        .chain(run(THIGH..15, false))
        .chain(run(THIGH..15, true))
        .collect()
}

fn parent_of(bone: usize) -> Option<usize> {
    BONES.iter().position(|b| b.name == BONES[bone].parent)
}

/// Frames of the table's bones (left and middle) in the bind pose.
fn bind_frames() -> Vec<Frame> {
    let mut frames: Vec<Frame> = Vec::new();
    for (i, bone) in BONES.iter().enumerate() {
        let parent = parent_of(i).map_or(Frame::WORLD, |p| frames[p]);
        frames.push(parent.child(bone.offset, bone.bind));
    }
    frames
}

pub fn skel() -> String {
    let all = joints();
    let mut out = String::new();
    write_joint(&mut out, &all, 0, 0);
    out
}

fn write_joint(out: &mut String, all: &[Joint], index: usize, depth: usize) {
    let Joint { bone, right } = all[index];
    let b = &BONES[bone];
    let pad = "  ".repeat(depth);
    let flip = |v: V| if right { [-v[0], v[1], v[2]] } else { v };
    let [lo, hi] = b.bounds;
    let (lo, hi) = if right {
        ([-hi[0], lo[1], lo[2]], [-lo[0], hi[1], hi[2]])
    } else {
        (lo, hi)
    };
    let rad = |d: f64| clean(d * std::f64::consts::PI / 180.0);
    let vec = |v: V| format!("{:.5} {:.5} {:.5}", clean(v[0]), clean(v[1]), clean(v[2]));
    let _ = writeln!(out, "{pad}balljoint {} {{", joint_name(all[index]));
    let _ = writeln!(out, "{pad}  offset {}", vec(flip(b.offset)));
    let _ = writeln!(out, "{pad}  boxmin {}", vec(lo));
    let _ = writeln!(out, "{pad}  boxmax {}", vec(hi));
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let [a, b] = b.limits[axis];
        let [a, b] = if right && axis > 0 { [-b, -a] } else { [a, b] };
        let _ = writeln!(out, "{pad}  rot{name}limit {:.5} {:.5}", rad(a), rad(b));
    }
    let pose = b.pose[usize::from(right)].map(|d| d * std::f64::consts::PI / 180.0);
    let _ = writeln!(out, "{pad}  pose {}", vec(pose));
    for (child, j) in all.iter().enumerate() {
        let same_side = bone < CLAVICLE || j.right == right;
        if parent_of(j.bone) == Some(bone) && same_side {
            write_joint(out, all, child, depth + 1);
        }
    }
    let _ = writeln!(out, "{pad}}}");
}

fn joint_name(j: Joint) -> String {
    let side = match (j.bone < CLAVICLE, j.right) {
        (true, _) => "",
        (_, false) => "_l",
        (_, true) => "_r",
    };
    format!("{}{side}", BONES[j.bone].name)
}

/// Avoids printing a negative zero.
fn clean(x: f64) -> f64 {
    if x.abs() < 5e-6 { 0.0 } else { x }
}

// ------------------------------------------------- distance-field shapes

/// 0 below `a`, 1 above `b`, smooth between.
fn ramp(x: f64, a: f64, b: f64) -> f64 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Smooth union: the two shapes flow together over a distance of about `k`.
fn join(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0);
    a.min(b) - h * h / (4.0 * k)
}

/// Smooth intersection.
fn meet(a: f64, b: f64, k: f64) -> f64 {
    -join(-a, -b, k)
}

/// Smooth subtraction of `b` from `a`.
fn carve(a: f64, b: f64, k: f64) -> f64 {
    meet(a, -b, k)
}

fn ball(p: V, c: V, r: f64) -> f64 {
    len(sub(p, c)) - r
}

fn ellipsoid(p: V, c: V, r: V) -> f64 {
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
fn bone(p: V, a: V, b: V, ra: f64, rb: f64) -> f64 {
    let (d, e) = (sub(p, a), sub(b, a));
    let t = (dot(d, e) / dot(e, e)).clamp(0.0, 1.0);
    len(sub(d, mul(e, t))) - (ra + (rb - ra) * t)
}

/// A tube of elliptic cross-sections `[s, ru, rv, cu, cv]` along an axis: at
/// height `s` the section is centred on `(cu, cv)` with radii `ru`, `rv`.  The
/// ends are cut flat with an edge rounded by `k`.
fn loft(s: f64, u: f64, v: f64, rows: &[[f64; 5]], k: f64) -> f64 {
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

// ------------------------------------------------------------- the body

/// Height of the modelled trunk above the written figure, and size of the head.
const DROP: f64 = 0.057;
const HEAD_SCALE: f64 = 1.09;

/// The body in its bind pose.  Every part is described in the frame of its
/// bone, for the character's left side; `x` is folded over before use.
struct Body {
    frames: Vec<Frame>,
}

#[rustfmt::skip]
impl Body {
    fn local(&self, bone: usize, p: V) -> V {
        self.frames[bone].to_local(p)
    }

    /// Shirt and seat of the shorts.
    fn torso(&self, p: V) -> f64 {
        let p = add(p, [0.0, DROP, 0.0]);
        let [x, y, z] = p;
        // Rows: height, half width, half depth, -, depth centre.
        let shirt = loft(y, x, z, &[
            [0.955, 0.176, 0.132, 0.0, -0.004], [0.985, 0.165, 0.123, 0.0, -0.003],
            [1.03, 0.145, 0.107, 0.0, 0.000], [1.08, 0.134, 0.097, 0.0, 0.004],
            [1.15, 0.135, 0.094, 0.0, 0.006], [1.23, 0.149, 0.100, 0.0, 0.006],
            [1.30, 0.160, 0.106, 0.0, 0.003], [1.36, 0.158, 0.100, 0.0, -0.004],
            [1.41, 0.132, 0.082, 0.0, -0.014], [1.45, 0.080, 0.058, 0.0, -0.020],
            [1.475, 0.045, 0.040, 0.0, -0.020],
        ], 0.014);
        let pec = ellipsoid(p, [0.066, 1.322, 0.060], [0.082, 0.058, 0.037]);
        let blade = ellipsoid(p, [0.080, 1.330, -0.078], [0.058, 0.075, 0.028]);
        let shirt = join(join(shirt, pec, 0.045), blade, 0.04);
        let slope = bone(p, [0.02, 1.452, -0.032], [0.150, 1.412, -0.014], 0.044, 0.044);
        let shirt = join(shirt, slope, 0.04);
        let seat = loft(y, x, z, &[
            [0.830, 0.100, 0.070, 0.0, -0.010], [0.86, 0.135, 0.092, 0.0, -0.008],
            [0.91, 0.158, 0.106, 0.0, -0.008], [0.95, 0.153, 0.106, 0.0, -0.007],
            [0.985, 0.138, 0.100, 0.0, -0.005],
        ], 0.03);
        let rump = ellipsoid(p, [0.070, 0.885, -0.055], [0.072, 0.078, 0.066]);
        let seat = join(seat, rump, 0.04);
        join(shirt, seat, 0.007)
    }

    fn neck(&self, p: V) -> f64 {
        let p = add(p, [0.0, DROP, 0.0]);
        let throat = bone(p, [0.0, 1.40, -0.028], [0.0, 1.57, 0.0], 0.054, 0.049);
        let cord = bone(p, [0.014, 1.445, 0.024], [0.052, 1.545, -0.012], 0.011, 0.014);
        // Shirt collar: a tilted ring.
        let q = sub(p, [0.0, 1.449, -0.013]);
        let h = q[1] + 0.23 * q[2];
        let ring = (q[0] * q[0] + q[2] * q[2] * 0.94).sqrt() - 0.0655;
        let collar = (ring * ring + 0.42 * h * h).sqrt() - 0.0130;
        join(join(throat, cord, 0.02), collar, 0.006)
    }

    /// Head without its hair, in the head's frame (chin near y = 0).
    fn face(&self, h: V) -> f64 {
        let skull = ellipsoid(h, [0.0, 0.135, -0.006], [0.080, 0.094, 0.098]);
        let front = ellipsoid(h, [0.0, 0.080, 0.028], [0.064, 0.088, 0.068]);
        let jaw = bone(h, [0.045, 0.036, 0.006], [0.018, 0.003, 0.062], 0.023, 0.020);
        let mut d = join(join(skull, front, 0.04), jaw, 0.035);
        d = join(d, ball(h, [0.0, 0.002, 0.078], 0.017), 0.025);
        d = join(d, ball(h, [0.039, 0.060, 0.055], 0.030), 0.035);
        // Eye sockets, brows, then eyeballs with a conical pupil, and lids
        // turned about the eye's middle so that the opening is an almond.
        d = carve(d, ellipsoid(h, [0.036, 0.103, 0.098], [0.025, 0.019, 0.018]), 0.018);
        let brow = bone(h, [0.015, 0.1365, 0.0905], [0.036, 0.1410, 0.0835], 0.0050, 0.0062)
            .min(bone(h, [0.036, 0.1410, 0.0835], [0.056, 0.1310, 0.0680], 0.0062, 0.0042));
        d = join(d, brow, 0.011);
        let e = sub(h, [0.0350, 0.1020, 0.0655]);
        let across = (e[0] * e[0] + e[1] * e[1]).sqrt();
        let pit = if e[2] > 0.0 { 0.0065 * (1.0 - ramp(across, 0.0010, 0.0098)) } else { 0.0 };
        d = d.min(len(e) - 0.0225 + pit);
        let upper = meet(len(e) - 0.0272, 0.50 * e[2] - 0.87 * e[1] - 0.08 * e[0], 0.004);
        let lower = meet(len(e) - 0.0258, 0.92 * e[1] + 0.40 * e[2], 0.004);
        d = join(d, upper.min(lower), 0.006);
        // Nose.
        let bridge = bone(h, [0.0, 0.108, 0.0870], [0.0, 0.071, 0.1110], 0.0070, 0.0095);
        d = join(d, bridge, 0.014);
        d = join(d, ball(h, [0.0, 0.067, 0.1100], 0.0112), 0.008);
        d = join(d, ball(h, [0.0120, 0.0625, 0.0985], 0.0082), 0.006);
        d = carve(d, ellipsoid(h, [0.0065, 0.0545, 0.1050], [0.0036, 0.0040, 0.0048]), 0.003);
        // Mouth: a soft muzzle, two lips that meet in a line in a smile.
        d = join(d, ellipsoid(h, [0.0, 0.034, 0.078], [0.030, 0.024, 0.018]), 0.016);
        let lip = |a: V, b: V, c: V, r: V| bone(h, a, b, r[0], r[1]).min(bone(h, b, c, r[1], r[2]));
        let upper = lip([0.0, 0.0415, 0.0965], [0.014, 0.0425, 0.0940], [0.0275, 0.0415, 0.0870],
            [0.0062, 0.0060, 0.0036]);
        let lower = lip([0.0, 0.0280, 0.0955], [0.013, 0.0297, 0.0930], [0.0250, 0.0370, 0.0870],
            [0.0078, 0.0070, 0.0038]);
        d = join(d, upper.min(lower), 0.005);
        let line = lip([0.0, 0.0352, 0.1035], [0.014, 0.0362, 0.1010], [0.0310, 0.0425, 0.0895],
            [0.0030, 0.0029, 0.0026]);
        d = carve(d, line, 0.004);
        // Ear.
        let e = sub(h, [0.0830, 0.090, -0.006]);
        let tilted = [e[0] - 0.25 * (0.010 - e[2]), e[1] + 0.22 * e[2], e[2] - 0.12 * e[1]];
        let shell = ellipsoid(tilted, [0.0; 3], [0.0085, 0.0330, 0.0205]);
        let bowl = ellipsoid(tilted, [0.0085, 0.0030, 0.0035], [0.0075, 0.0215, 0.0120]);
        join(d, carve(shell, bowl, 0.004), 0.006)
    }

    /// Short hair: a cap with a hairline, and locks swept back from the brow.
    fn hair(&self, h: V) -> f64 {
        let cap = ellipsoid(h, [0.0, 0.142, -0.012], [0.0895, 0.1110, 0.1030]);
        let nape = ellipsoid(h, [0.0, 0.072, -0.052], [0.064, 0.060, 0.044]);
        let cap = join(cap, nape, 0.03);
        // Cut out the oval of the face, the ear, and what hangs below.
        let oval = ellipsoid([h[0], h[1], 0.0], [0.0, 0.072, 0.0], [0.0710, 0.0990, 1.0]);
        let face = meet(oval, 0.012 - h[2], 0.012);
        let ear = ellipsoid(h, [0.0880, 0.082, 0.006], [0.028, 0.036, 0.023]);
        let edge = 0.080 + (1.05 * (h[2] + 0.012)).clamp(-0.058, 0.0) - h[1];
        let mut d = carve(meet(cap, edge * 0.75, 0.010), join(face, ear, 0.006), 0.010);
        for (a, b, c, ra, rb) in [
            ([0.009, 0.204, 0.094], [0.013, 0.239, 0.044], [0.014, 0.230, -0.050], 0.0140, 0.0185),
            ([0.031, 0.193, 0.085], [0.042, 0.222, 0.038], [0.045, 0.222, -0.040], 0.0130, 0.0170),
            ([0.056, 0.170, 0.064], [0.067, 0.190, 0.028], [0.070, 0.192, -0.038], 0.0110, 0.0155),
            ([0.014, 0.230, -0.050], [0.016, 0.196, -0.088], [0.016, 0.120, -0.100], 0.0180, 0.0135),
            ([0.045, 0.220, -0.040], [0.046, 0.190, -0.078], [0.043, 0.105, -0.086], 0.0165, 0.0130),
            ([0.070, 0.190, -0.038], [0.073, 0.160, -0.056], [0.062, 0.085, -0.064], 0.0150, 0.0110),
        ] {
            let lock = bone(h, a, b, ra, rb).min(bone(h, b, c, rb, rb * 0.85));
            d = join(d, lock, 0.011);
        }
        d
    }

    fn head(&self, p: V) -> f64 {
        let h = mul(self.local(HEAD, p), 1.0 / HEAD_SCALE);
        join(self.face(h), self.hair(h), 0.004) * HEAD_SCALE
    }

    /// Arm from shoulder to wrist, with the sleeve.
    fn arm(&self, p: V) -> f64 {
        let [x, y, z] = self.local(UPPER_ARM, p);
        let skin = loft(x, y, z, &[
            [0.05, 0.040, 0.042, 0.0, 0.0], [0.12, 0.040, 0.042, 0.001, 0.003],
            [0.18, 0.0385, 0.041, 0.001, 0.005], [0.24, 0.034, 0.037, 0.0, 0.001],
            [0.29, 0.033, 0.035, 0.0, -0.002],
        ], 0.02);
        let sleeve = loft(x, y, z, &[
            [-0.06, 0.034, 0.036, 0.0, 0.0], [-0.02, 0.050, 0.053, -0.001, -0.001],
            [0.02, 0.056, 0.059, 0.000, -0.001], [0.07, 0.055, 0.058, 0.001, 0.0],
            [0.12, 0.0545, 0.057, 0.0, 0.002], [0.160, 0.0590, 0.0610, -0.002, 0.003],
        ], 0.013);
        let [x, y, z] = self.local(FOREARM, p);
        let fore = loft(x, y, z, &[
            [-0.025, 0.030, 0.032, 0.0, -0.001], [0.01, 0.035, 0.037, 0.0, 0.0],
            [0.06, 0.0375, 0.040, 0.0, 0.003], [0.11, 0.035, 0.038, 0.0, 0.003],
            [0.18, 0.0275, 0.031, 0.0, 0.0], [0.23, 0.0225, 0.028, 0.0, 0.0],
            [0.27, 0.0200, 0.0275, 0.0, 0.0],
        ], 0.015);
        join(join(skin, fore, 0.02), sleeve, 0.006)
    }

    fn palm(&self, p: V) -> f64 {
        let q = self.local(HAND, p);
        let wrist = ellipsoid(q, [0.0, 0.0, 0.0], [0.035, 0.0205, 0.0280]);
        let mut d = wrist;
        // Four metacarpals side by side make the palm and the knuckles.
        for (z0, z1, x1, r) in [(0.016, 0.030, 0.092, 0.0128), (0.006, 0.0105, 0.096, 0.0130),
                                (-0.006, -0.0105, 0.093, 0.0125), (-0.016, -0.030, 0.085, 0.0115)] {
            d = join(d, bone(q, [0.012, -0.001, z0], [x1, 0.0015, z1], 0.0150, r), 0.010);
        }
        join(d, ellipsoid(q, [0.035, -0.011, 0.022], [0.030, 0.012, 0.015]), 0.015)
    }

    fn fingers(&self, p: V) -> f64 {
        let q = self.local(FINGERS, p);
        let mut d = f64::MAX;
        for (x0, z0, z1, length, r) in [(0.000, 0.0320, 0.0440, 0.074, 0.0102),
            (0.004, 0.0108, 0.0155, 0.083, 0.0104), (0.001, -0.0108, -0.0140, 0.077, 0.0101),
            (-0.007, -0.0315, -0.0415, 0.062, 0.0092)] {
            let zm = z0 + 0.52 * (z1 - z0);
            let knee = [x0 + 0.52 * (length - x0), 0.0015, zm];
            d = d.min(bone(q, [x0 - 0.012, 0.0, z0], knee, r, r * 0.96))
                .min(bone(q, knee, [length, -0.008, z1], r * 0.96, r * 0.82));
        }
        d
    }

    fn thumb(&self, p: V) -> f64 {
        let q = self.local(THUMB, p);
        join(bone(q, [0.0, 0.0, 0.0], [0.030, -0.009, 0.025], 0.0150, 0.0130),
            bone(q, [0.030, -0.009, 0.025], [0.060, -0.013, 0.037], 0.0125, 0.0100), 0.005)
    }

    fn hand(&self, p: V) -> f64 {
        join(join(self.palm(p), self.fingers(p), 0.006), self.thumb(p), 0.014)
    }

    /// Leg from hip to ankle, with the leg of the shorts and a sock.
    fn leg(&self, p: V) -> f64 {
        let [x, y, z] = self.local(THIGH, p);
        let thigh = loft(-y, x, z, &[
            [0.05, 0.070, 0.076, -0.004, 0.0], [0.17, 0.071, 0.078, -0.003, 0.003],
            [0.27, 0.062, 0.067, -0.002, 0.004], [0.345, 0.053, 0.057, 0.0, 0.002],
            [0.42, 0.049, 0.052, 0.0, 0.0],
        ], 0.02);
        let shorts = loft(-y, x, z, &[
            [-0.06, 0.050, 0.070, 0.010, -0.004], [0.0, 0.074, 0.092, 0.004, -0.004],
            [0.06, 0.0815, 0.095, -0.002, -0.002], [0.15, 0.0820, 0.091, -0.003, 0.001],
            [0.225, 0.0830, 0.090, -0.002, 0.003], [0.262, 0.0870, 0.095, -0.002, 0.003],
        ], 0.014);
        let [x, y, z] = self.local(SHIN, p);
        let shin = loft(-y, x, z, &[
            [-0.03, 0.047, 0.048, 0.0, 0.0], [0.02, 0.046, 0.049, 0.0, 0.0],
            [0.07, 0.047, 0.050, 0.002, -0.007], [0.125, 0.049, 0.053, 0.003, -0.013],
            [0.19, 0.043, 0.047, 0.001, -0.012], [0.27, 0.033, 0.036, 0.0, -0.006],
            [0.33, 0.030, 0.033, 0.0, -0.003], [0.40, 0.032, 0.036, 0.0, -0.003],
        ], 0.015);
        let cap = ellipsoid([x, y, z], [0.0, 0.004, 0.036], [0.026, 0.034, 0.017]);
        let sock = loft(-y, x, z, &[
            [0.265, 0.0450, 0.0480, 0.0, -0.007], [0.290, 0.0430, 0.0460, 0.0, -0.005],
            [0.315, 0.0390, 0.0420, 0.0, -0.004], [0.39, 0.0390, 0.0430, 0.0, -0.003],
        ], 0.008);
        let leg = join(join(thigh, shin, 0.02), cap, 0.03);
        join(join(leg, sock, 0.005), shorts, 0.006)
    }

    fn shoe(&self, p: V) -> f64 {
        let q = self.local(FOOT, p);
        let plan = |x: f64, z: f64| {
            let at = [x, 0.0, z];
            join(join(bone(at, [0.0, 0.0, -0.030], [0.006, 0.0, 0.090], 0.036, 0.044),
                bone(at, [0.006, 0.0, 0.090], [0.002, 0.0, 0.148], 0.044, 0.034), 0.02),
                bone(at, [-0.012, 0.0, 0.100], [-0.010, 0.0, 0.150], 0.030, 0.026), 0.01)
        };
        let side = plan(q[0], q[2]);
        // The toe end of the sole curls up a little.
        let lift = 0.010 * ramp(q[2], 0.10, 0.19);
        let slab = (q[1] + 0.0665 - lift).abs() - 0.0135;
        let sole = meet(side - 0.007, slab, 0.009);
        let heel = ellipsoid(q, [0.0, -0.040, -0.022], [0.0345, 0.056, 0.042]);
        let instep = bone(q, [0.0, -0.006, 0.002], [0.004, -0.042, 0.095], 0.039, 0.026);
        let toe = ellipsoid(q, [0.000, -0.050, 0.112], [0.0410, 0.036, 0.068]);
        let upper = join(join(heel, instep, 0.03), toe, 0.03);
        let upper = meet(upper, -(q[1] + 0.066), 0.004);
        let rim = loft(q[1], q[0], q[2], &[
            [-0.01, 0.0400, 0.048, 0.0, 0.000], [0.022, 0.0385, 0.044, 0.0, -0.002],
        ], 0.005);
        let tongue = bone(q, [0.0, 0.026, 0.036], [0.0, -0.012, 0.062], 0.012, 0.014);
        let mut upper = join(join(upper, rim, 0.012), tongue, 0.008);
        for (y, z) in [(-0.002, 0.072), (-0.020, 0.096)] {
            let lace = bone(q, [0.0, y, z], [0.020, y - 0.009, z - 0.004], 0.0085, 0.0070);
            upper = join(upper, lace, 0.004);
        }
        join(upper, sole, 0.004)
    }

    /// The whole field.  Parts too far from `p` to matter are skipped.
    fn field(&self, p: V) -> f64 {
        // A rounded fold instead of |x| keeps the surface smooth at x = 0.
        let p = [(p[0] * p[0] + 9e-6).sqrt(), p[1], p[2]];
        let mut d = f64::MAX;
        let mut part = |shape: &dyn Fn(V) -> f64, a: V, b: V, r: f64, k: f64| {
            if bone(p, a, b, r, r) < d.min(0.25) + 0.02 {
                let s = shape(p);
                d = if d == f64::MAX { s } else { join(d, s, k) };
            }
        };
        let at = |i: usize| self.frames[i].at;
        let tip = add(at(HAND), mul(sub(at(HAND), at(FOREARM)), 0.7));
        let toe = add(at(TOES), [0.0, 0.0, 0.05]);
        part(&|p| self.torso(p), [0.0, 0.85, 0.0], [0.0, 1.40, 0.0], 0.20, 0.01);
        part(&|p| self.neck(p), [0.0, 1.36, 0.0], [0.0, 1.52, 0.0], 0.09, 0.012);
        part(&|p| self.head(p), [0.0, 1.54, 0.0], [0.0, 1.66, 0.0], 0.15, 0.012);
        part(&|p| self.arm(p), at(UPPER_ARM), at(HAND), 0.09, 0.03);
        part(&|p| self.hand(p), at(HAND), tip, 0.09, 0.008);
        part(&|p| self.leg(p), at(THIGH), at(FOOT), 0.12, 0.018);
        part(&|p| self.shoe(p), at(FOOT), toe, 0.10, 0.003);
        if d == f64::MAX { 0.25 } else { d }
    }

    fn gradient(&self, p: V, e: f64) -> V {
        let at = |x, y, z| self.field(add(p, [x, y, z]));
        let x = if p[0] == 0.0 { 0.0 } else { at(e, 0.0, 0.0) - at(-e, 0.0, 0.0) };
        let g = [x, at(0.0, e, 0.0) - at(0.0, -e, 0.0), at(0.0, 0.0, e) - at(0.0, 0.0, -e)];
        mul(g, 0.5 / e)
    }

    /// Moves a point onto the surface by damped Newton steps.
    fn project(&self, mut p: V, steps: usize) -> V {
        for _ in 0..steps {
            let g = self.gradient(p, 6e-4);
            let t = (self.field(p) / dot(g, g).max(0.1)).clamp(-0.006, 0.006);
            p = sub(p, mul(g, t));
        }
        p
    }
}

/// How much finer than elsewhere the surface is kept around `p`.
fn detail(body: &Body, p: V) -> f64 {
    let h = mul(body.local(HEAD, p), 1.0 / HEAD_SCALE);
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

// -------------------------------------------------------------- meshing

/// A triangle mesh of the left half; points with `x == 0` are on its border.
struct Mesh {
    points: Vec<V>,
    faces: Vec<[usize; 3]>,
}

/// Grid lines from the first to the last `start` with the given steps between.
fn axis(runs: &[(f64, f64)], end: f64) -> Vec<f64> {
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
fn march(body: &Body) -> Mesh {
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
    const B: usize = 6;
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
    const ORDERS: [[usize; 3]; 6] = [
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
fn fans(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut fans = vec![Vec::new(); mesh.points.len()];
    for (f, face) in mesh.faces.iter().enumerate() {
        face.iter().for_each(|&v| fans[v].push(f));
    }
    fans
}

fn ring(faces: &[[usize; 3]], fan: &[usize], v: usize) -> Vec<usize> {
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
fn shape([p, q, r]: [V; 3]) -> (V, f64) {
    let normal = cross(sub(q, p), sub(r, p));
    let edges: f64 = [sub(p, q), sub(q, r), sub(r, p)]
        .iter()
        .map(|&e| dot(e, e))
        .sum();
    (unit(normal), len(normal) / edges.max(1e-18))
}

/// Sum of squared distances to planes: upper half of a symmetric 4x4 matrix,
/// with the total weight last.
type Quadric = [f64; 11];

fn quadric_error(q: &Quadric, [x, y, z]: V) -> f64 {
    let e = q[0] * x * x
        + q[4] * y * y
        + q[7] * z * z
        + q[9]
        + 2.0 * (q[1] * x * y + q[2] * x * z + q[3] * x + q[5] * y * z + q[6] * y + q[8] * z);
    e.max(0.0) / q[10].max(1e-15)
}

/// Thins the half mesh by edge collapses until the mirrored whole would have
/// `target` vertices.
fn thin(body: &Body, mesh: &mut Mesh, target: usize) {
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

/// Flips inner edges where that gives better-shaped triangles that still
/// follow the surface.
fn flip(body: &Body, mesh: &mut Mesh, normals: &[V]) {
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
fn relax(body: &Body, mesh: &mut Mesh, normals: &[V]) {
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
fn half_surface(body: &Body) -> (Mesh, Vec<V>) {
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

// -------------------------------------------------------------- weights

/// Influence of every table bone on a point of the left half.
fn weights(body: &Body, p: V) -> [f64; 15] {
    let mut w = [0.0; 15];
    let [x, y, z] = add(p, [0.0, DROP, 0.0]);
    // How much of the point belongs to the arm or to the leg.
    let arm = body.arm(p).min(body.hand(p));
    let arm = ramp(body.torso(p) - arm, -0.035, 0.035) * ramp(x, 0.10, 0.15);
    let hip = DROP + BONES[PELVIS].offset[1] + BONES[THIGH].offset[1];
    // The fold of the hip: high in front and at the side, low behind.
    let fold = hip - y + 0.20 * z + 0.25 * (x - 0.09);
    let below = (0.85 - y).max(0.0);
    let leg = ramp(fold, -0.055, 0.075) * ramp(x + 0.5 * below, 0.0, 0.055) * ramp(-y, -1.0, -0.94);
    let leg = leg * (1.0 - arm);

    // Down a chain, each joint passes part of the remaining weight on.
    let mut chain = |amount: f64, links: &[(usize, f64)]| {
        let mut rest = amount;
        for (i, &(bone, _)) in links.iter().enumerate() {
            let on = links.get(i + 1).map_or(0.0, |l| l.1);
            w[bone] += rest * (1.0 - on);
            rest *= on;
        }
    };
    let (clavicle, trunk) = {
        let rest = 1.0 - arm - leg;
        let c = ramp(x, 0.03, 0.13) * ramp(y, 1.28, 1.42) * rest;
        (c, rest - c)
    };
    let head = ramp(body.neck(p) - body.head(p), -0.016, 0.016) * ramp(y, 1.46, 1.50);
    chain(
        trunk,
        &[
            (PELVIS, 1.0),
            (SPINE, ramp(y, 0.97, 1.09)),
            (CHEST, ramp(y, 1.11, 1.27)),
            (NECK, ramp(y - 0.25 * z, 1.435, 1.495)),
            (HEAD, head),
        ],
    );
    chain(clavicle, &[(CLAVICLE, 1.0)]);
    let along = |bone: usize, axis: usize| body.local(bone, p)[axis];
    let thumb = ramp(
        body.palm(p).min(body.fingers(p)) - body.thumb(p),
        -0.008,
        0.010,
    ) * ramp(along(HAND, 2), 0.012, 0.03);
    let hand = arm * ramp(along(FOREARM, 0), 0.215, 0.265);
    let split = if hand > 0.0 { thumb } else { 0.0 };
    chain(
        arm * (1.0 - split * hand / arm.max(1e-9)),
        &[
            (UPPER_ARM, 1.0),
            (FOREARM, ramp(along(UPPER_ARM, 0), 0.225, 0.315)),
            (HAND, ramp(along(FOREARM, 0), 0.215, 0.265)),
            (FINGERS, ramp(along(FINGERS, 0), -0.013, 0.012)),
        ],
    );
    chain(split * hand, &[(THUMB, 1.0)]);
    chain(
        leg,
        &[
            (THIGH, 1.0),
            (SHIN, ramp(-along(THIGH, 1), 0.335, 0.450)),
            (FOOT, ramp(-along(SHIN, 1), 0.350, 0.400)),
            (TOES, ramp(along(TOES, 2), -0.022, 0.022)),
        ],
    );
    w
}

/// Keeps what matters, at four decimals, summing to one: `(joint, 1e-4 steps)`.
fn tidy(mut all: Vec<(usize, f64)>) -> Vec<(usize, u32)> {
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    all.truncate(5);
    all.retain(|&(_, w)| w > 0.01);
    let sum: f64 = all.iter().map(|&(_, w)| w).sum();
    let mut kept: Vec<(usize, u32)> = all
        .iter()
        .map(|&(j, w)| (j, (w / sum * 1e4).round() as u32))
        .collect();
    let rest: u32 = kept.iter().skip(1).map(|&(_, w)| w).sum();
    if let Some(first) = kept.first_mut() {
        first.1 = 10_000 - rest;
    }
    kept
}

// -------------------------------------------------------------- writing

pub fn skin() -> String {
    let body = Body {
        frames: bind_frames(),
    };
    let (half, half_normals) = half_surface(&body);
    let all = joints();
    let joint = |bone: usize, right: bool| {
        let found = |j: &Joint| j.bone == bone && (j.right == right || bone < CLAVICLE);
        all.iter().position(found).unwrap_or(0)
    };

    // The left half as it is, then the mirror images of all but the border.
    let mut points = half.points.clone();
    let mut normals = half_normals.clone();
    let mut influences: Vec<_> = half.points.iter().map(|&p| weights(&body, p)).collect();
    let mut right = vec![false; points.len()];
    let mut twin: Vec<usize> = (0..points.len()).collect();
    for v in 0..half.points.len() {
        let flip = |a: V| [-a[0], a[1], a[2]];
        if half.points[v][0] != 0.0 {
            twin[v] = points.len();
            points.push(flip(half.points[v]));
            normals.push(flip(half_normals[v]));
            influences.push(influences[v]);
            right.push(true);
        }
    }
    let mut faces = half.faces.clone();
    faces.extend(
        half.faces
            .iter()
            .map(|&[a, b, c]| [twin[a], twin[c], twin[b]]),
    );

    let mut out = String::new();
    let mut block = |name: &str, lines: Vec<String>| {
        let _ = writeln!(
            out,
            "{name} {} {{\n  {}\n}}",
            lines.len(),
            lines.join("\n  ")
        );
    };
    let vec = |v: &V| {
        let [x, y, z] = v.map(clean);
        format!("{x:.5} {y:.5} {z:.5}")
    };
    block("positions", points.iter().map(vec).collect());
    block("normals", normals.iter().map(vec).collect());
    let weight_line = |(w, &right): (&[f64; 15], &bool)| {
        let named = w
            .iter()
            .enumerate()
            .map(|(bone, &w)| (joint(bone, right), w))
            .collect();
        let kept = tidy(named);
        let pairs = kept
            .iter()
            .map(|&(j, w)| format!(" {j} {}.{:04}", w / 10_000, w % 10_000));
        format!("{}{}", kept.len(), pairs.collect::<String>())
    };
    block(
        "skinweights",
        influences.iter().zip(&right).map(weight_line).collect(),
    );
    block(
        "triangles",
        faces
            .iter()
            .map(|[a, b, c]| format!("{a} {b} {c}"))
            .collect(),
    );
    let binding = |j: &Joint| {
        let f = body.frames[j.bone];
        // Mirror in x: conjugate the rotation, reflect the origin.
        let s = if j.right { -1.0 } else { 1.0 };
        let [a, b, c] = f.axes;
        let columns = [
            [a[0], s * a[1], s * a[2]],
            [s * b[0], b[1], b[2]],
            [s * c[0], c[1], c[2]],
            [s * f.at[0], f.at[1], f.at[2]],
        ];
        let rows: Vec<String> = columns.iter().map(vec).collect();
        format!("matrix {{ {} }}", rows.join("  "))
    };
    block("bindings", all.iter().map(binding).collect());
    out
}

#[allow(dead_code)]
fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "assets".into());
    let folder = std::path::Path::new(&folder);
    std::fs::write(folder.join("figure.skel"), skel())?;
    std::fs::write(folder.join("figure.skin"), skin())
}
