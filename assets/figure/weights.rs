//! How much every bone has a hold of a place on the surface.
//! No vertices.

use super::body::{Body, DROP};
use super::shapes::ramp;
use super::skeleton::{
    BONES, CHEST, CLAVICLE, FINGERS, FOOT, FOREARM, HAND, HEAD, NECK, PELVIS, SHIN, SPINE, THIGH,
    THUMB, TOES, UPPER_ARM,
};
use super::vectors::{V, add};

/// Influence of every table bone on a point of the left half.
pub fn weights(body: &Body, p: V) -> [f64; 15] {
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
pub fn tidy(mut all: Vec<(usize, f64)>) -> Vec<(usize, u32)> {
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
