//! The table of the figure's joints, the frames it is modelled in, and `figure.skel`.
//! No surface.

use super::vectors::{Frame, V};
use std::fmt::Write as _;

/// One joint (of the left side or the middle).  Angles are in degrees.
pub struct Bone {
    pub name: &'static str,
    pub parent: &'static str,
    pub offset: V,
    pub bounds: [V; 2],
    pub limits: [[f64; 2]; 3],
    /// Rotation at which the surface is modelled and bound.
    pub bind: V,
    /// Rest pose of the left (or middle) joint, and of its right twin, the
    /// latter already in the right side's own sense.
    pub pose: [V; 2],
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
pub const BONES: [Bone; 15] = bones! {
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
pub const PELVIS: usize = 0;
pub const SPINE: usize = 1;
pub const CHEST: usize = 2;
pub const NECK: usize = 3;
pub const HEAD: usize = 4;
pub const CLAVICLE: usize = 5;
pub const UPPER_ARM: usize = 6;
pub const FOREARM: usize = 7;
pub const HAND: usize = 8;
pub const FINGERS: usize = 9;
pub const THUMB: usize = 10;
pub const THIGH: usize = 11;
pub const SHIN: usize = 12;
pub const FOOT: usize = 13;
pub const TOES: usize = 14;

/// A joint of the finished skeleton: a table row and the side it is on.
#[derive(Clone, Copy)]
pub struct Joint {
    pub bone: usize,
    pub right: bool,
}

/// All joints in depth-first order: middle, arm, other arm, leg, other leg.
pub fn joints() -> Vec<Joint> {
    let run = |range: std::ops::Range<usize>, right| range.map(move |bone| Joint { bone, right });
    run(0..CLAVICLE, false)
        .chain(run(CLAVICLE..THIGH, false))
        .chain(run(CLAVICLE..THIGH, true))
        .chain(run(THIGH..15, false))
        .chain(run(THIGH..15, true))
        .collect()
}

pub fn parent_of(bone: usize) -> Option<usize> {
    BONES.iter().position(|b| b.name == BONES[bone].parent)
}

/// Frames of the table's bones (left and middle) in the bind pose.
pub fn bind_frames() -> Vec<Frame> {
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

pub fn write_joint(out: &mut String, all: &[Joint], index: usize, depth: usize) {
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

pub fn joint_name(j: Joint) -> String {
    let side = match (j.bone < CLAVICLE, j.right) {
        (true, _) => "",
        (_, false) => "_l",
        (_, true) => "_r",
    };
    format!("{}{side}", BONES[j.bone].name)
}

/// Avoids printing a negative zero.
pub fn clean(x: f64) -> f64 {
    if x.abs() < 5e-6 { 0.0 } else { x }
}
