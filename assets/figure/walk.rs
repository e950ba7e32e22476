//! `walk.anim`: two steps of a walk that goes forward as fast as the feet on the ground go back.
//! How a leg reaches its foot is leg.rs's.

use super::leg::{Footing, leg};
use super::shapes::ramp;
use super::skeleton::{BONES, HEAD, Joint, joints};
use super::vectors::{Frame, V, sin_cos};
use std::f64::consts::PI;
use std::fmt::Write as _;

/// Seconds and metres of two steps.
const PERIOD: f64 = 1.1;
const STRIDE: f64 = 0.98;
/// Keys of a channel that moves, the last being the first again.
const KEYS: usize = 20;

/// The cosine of a part `phase` of a turn.
fn wave(phase: f64) -> f64 {
    sin_cos(2.0 * PI * (phase - phase.floor())).1
}

/// Shift of the pelvis from rest, but for the way forward, and the angles of all joints in degrees.
struct Posture {
    shift: V,
    angles: Vec<V>,
}

/// At `phase` 0 the left heel meets the ground, at 0.5 the right one.
fn posture(phase: f64) -> Posture {
    // Highest over a standing leg, lowest between two steps; always a little over the leg that stands.
    let shift = [
        0.020 * wave(phase - 0.30),
        -0.027 + 0.014 * wave(2.0 * (phase - 0.31)),
        0.0,
    ];
    let turn = wave(phase + 0.02);
    let tip = wave(phase - 0.22);
    let trunk = |name: &str| match name {
        "pelvis" => [3.0, -7.0 * turn, 2.6 * tip],
        "spine" => [2.0, 5.5 * turn, -2.2 * tip],
        "chest" => [0.5, 5.5 * turn, -1.6 * tip],
        "neck" => [-1.0, -2.0 * turn, 0.8 * tip],
        _ => [-2.5 + 0.8 * wave(2.0 * phase), -2.0 * turn, 0.4 * tip],
    };
    let pelvis = Frame::WORLD.child(
        [0, 1, 2].map(|k| BONES[0].offset[k] + shift[k]),
        trunk("pelvis"),
    );
    let limbs = [(phase, false), (phase + 0.5, true)].map(|(p, mirror)| {
        // The right side is worked out as a left one, in the mirror.
        let pelvis = if mirror { pelvis.mirrored() } else { pelvis };
        Limbs {
            arm: p,
            leg: leg(&pelvis, footing(p)),
        }
    });
    let angle = |j: &Joint| {
        let name = BONES[j.bone].name;
        if j.bone <= HEAD {
            return trunk(name);
        }
        let [x, y, z] = limbs[usize::from(j.right)].angles(name, BONES[j.bone].pose[0]);
        if j.right { [x, -y, -z] } else { [x, y, z] }
    };
    Posture {
        shift,
        angles: joints().iter().map(angle).collect(),
    }
}

/// A left arm and a left leg; `arm` is the phase of the foot on the same side.
struct Limbs {
    arm: f64,
    leg: [V; 4],
}

impl Limbs {
    fn angles(&self, name: &str, rest: V) -> V {
        // 1 where the arm is farthest forward, against the leg; the forearm follows a little later.
        let forth = |late: f64| 0.5 - 0.5 * wave(self.arm - late);
        match name {
            "clavicle" => [0.0, 3.0 - 6.0 * forth(0.03), -3.0],
            "upper_arm" => [6.0, 20.0 - 39.0 * forth(0.03), -79.0],
            "forearm" => [-6.0, -15.0 - 22.0 * forth(0.09), 0.0],
            "hand" => [0.0, 4.0 - 6.0 * forth(0.12), -9.0],
            "fingers" => [0.0, 0.0, -36.0],
            "thigh" => self.leg[0],
            "shin" => self.leg[1],
            "foot" => self.leg[2],
            "toes" => self.leg[3],
            _ => rest,
        }
    }
}

/// Where the foot is, seen from below the hips.
fn footing(phase: f64) -> Footing {
    let p = phase - phase.floor();
    // The foot rolls from the heel over the sole to the ball, and swings to the next heel strike.
    const LIFT: f64 = 0.60;
    let standing = |p: f64| Footing::standing(STRIDE * (0.305 - p), pitch(p));
    if p <= LIFT {
        return standing(p);
    }
    let slope = |at: f64, side: f64| {
        let (a, b) = (standing(at), standing(at + side * 1e-3));
        [0, 1].map(|k| (b.ankle[k + 1] - a.ankle[k + 1]) / (side * 1e-3))
    };
    let (from, to) = (standing(LIFT), standing(0.0));
    let (leaving, landing) = (slope(LIFT, -1.0), slope(0.0, 1.0));
    let span = 1.0 - LIFT;
    let u = (p - LIFT) / span;
    let along = |k: usize| {
        let (u2, u3) = (u * u, u * u * u);
        (2.0 * u3 - 3.0 * u2 + 1.0) * from.ankle[k + 1]
            + (u3 - 2.0 * u2 + u) * span * leaving[k]
            + (3.0 * u2 - 2.0 * u3) * to.ankle[k + 1]
            + (u3 - u2) * span * landing[k]
    };
    // Most of it early, when the toes still point down.
    let clear = 9.5 * u * (1.0 - u) * (1.0 - u) * (1.0 - u);
    Footing {
        ankle: [from.ankle[0], along(0) + 0.030 * clear, along(1)],
        pitch: pitch(p),
        toes: pitch(LIFT).max(0.0) * (1.0 - ramp(p, LIFT, 0.74)),
    }
}

/// How far the toes point down, in degrees, from one heel strike to the next.
fn pitch(p: f64) -> f64 {
    const STOPS: [[f64; 2]; 7] = [
        [0.0, -19.0],
        [0.10, 0.0],
        [0.32, 0.0],
        [0.62, 44.0],
        [0.84, -4.0],
        [0.97, -20.0],
        [1.0, -19.0],
    ];
    let next = (1..6).find(|&i| p < STOPS[i][0]).unwrap_or(6);
    let ([a, from], [b, to]) = (STOPS[next - 1], STOPS[next]);
    from + (to - from) * ramp(p, a, b)
}

pub fn anim() -> String {
    // All channels in the file's order: three of the root, three of every joint; radians.
    let sample = |phase: f64| -> Vec<f64> {
        let Posture { shift, angles } = posture(phase);
        let angles = angles.into_iter().flatten().map(|a| a * PI / 180.0);
        shift.into_iter().chain(angles).collect()
    };
    let step = 1.0 / KEYS as f64;
    let moments: Vec<[Vec<f64>; 3]> = (0..KEYS)
        .map(|k| [-0.25, 0.0, 0.25].map(|d| sample((k as f64 + d) * step)))
        .collect();
    let count = 3 + 3 * joints().len();
    let mut out = format!("animation {{\n  range 0 {PERIOD}\n  numchannels {count}\n");
    for c in 0..count {
        let value = |k: usize| moments[k % KEYS][1][c];
        let slope = |k: usize| {
            let [before, _, after] = &moments[k % KEYS];
            (after[c] - before[c]) / (0.5 * step * PERIOD)
        };
        let forward = c == 2;
        let still = (0..KEYS).all(|k| (value(k) - value(0)).abs() < 1e-6);
        let mode = if forward { "cycle_offset" } else { "cycle" };
        let _ = writeln!(out, "  channel {c} {{\n    extrapolate {mode} {mode}");
        if forward {
            let _ = writeln!(
                out,
                "    keys 2 {{\n      0 0 linear linear\n      {PERIOD} {STRIDE} linear linear\n    }}"
            );
        } else if still {
            let _ = writeln!(
                out,
                "    keys 1 {{\n      0 {:.5} flat flat\n    }}",
                round(value(0))
            );
        } else {
            let _ = writeln!(out, "    keys {} {{", KEYS + 1);
            for k in 0..=KEYS {
                let time = k as f64 * step * PERIOD;
                let slope = round(slope(k));
                let _ = writeln!(
                    out,
                    "      {time:.3} {:.5} {slope:.4} {slope:.4}",
                    round(value(k))
                );
            }
            out += "    }\n";
        }
        out += "  }\n";
    }
    out + "}\n"
}

/// Avoids printing a negative zero.
fn round(x: f64) -> f64 {
    if x.abs() < 5e-5 { 0.0 } else { x }
}
