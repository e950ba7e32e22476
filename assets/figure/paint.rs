//! The figure's colours: what every place on the surface is made of, and what is printed on it.
//! No texels and no light.

use super::body::{Body, DROP, EYE, EYE_RADIUS};
use super::shapes::{ball, bone, ramp};
use super::skeleton::{FOOT, HEAD, SHIN, THIGH, UPPER_ARM};
use super::vectors::{V, add, len, mul, sub};

const SKIN: V = [231.0, 180.0, 146.0];
const LIPS: V = [204.0, 118.0, 104.0];
const HAIR: V = [104.0, 62.0, 36.0];
const WHITE: V = [243.0, 240.0, 232.0];
const IRIS: V = [66.0, 122.0, 112.0];
const PUPIL: V = [22.0, 18.0, 18.0];
const TEAL: V = [40.0, 136.0, 140.0];
const CORAL: V = [236.0, 104.0, 74.0];
const CREAM: V = [244.0, 230.0, 202.0];
const DENIM: V = [72.0, 96.0, 142.0];

fn mix(a: V, b: V, t: f64) -> V {
    add(mul(a, 1.0 - t), mul(b, t))
}

/// Lays `colour` over `under` where the distance `d` is below zero, with an edge `soft` wide.
fn over(under: V, colour: V, d: f64, soft: f64) -> V {
    mix(under, colour, (0.5 - d / soft).clamp(0.0, 1.0))
}

/// Colour of a place on the surface, sRGB from 0 to 255.
pub fn paint(body: &Body, p: V) -> V {
    // The left half is the one that is modelled.
    let q = [p[0].abs(), p[1], p[2]];
    let h = body.in_head(q);
    let [lace, other_lace] = body.laces(q);
    let materials = [
        (body.face(h), face(body, h)),
        (body.hair(h), hair(h)),
        (body.throat(q), SKIN),
        (body.collar(q), CORAL),
        (
            body.shirt(q),
            over(shirt(p), CORAL, neckline(body, q), 0.003),
        ),
        (body.sleeve(q), sleeve(body, q)),
        (body.bare_arm(q), SKIN),
        (body.hand(q), SKIN),
        (body.seat(q).min(body.shorts(q)), shorts(body, q)),
        (body.bare_leg(q), SKIN),
        (body.sock(q), sock(body, q)),
        (body.upper(q), shoe(body, q)),
        (body.sole(q), WHITE),
        (lace.min(other_lace), WHITE),
    ];
    let nearest = materials.iter().map(|m| m.0).fold(f64::MAX, f64::min);
    let soft = if p[1] > body.frames[HEAD].at[1] {
        0.0012
    } else {
        0.0025
    };
    let (mut sum, mut whole) = ([0.0; 3], 0.0);
    for (d, colour) in materials {
        let share = (1.0 - (d - nearest) / soft).max(0.0);
        sum = add(sum, mul(colour, share));
        whole += share;
    }
    mul(sum, 1.0 / whole)
}

fn face(body: &Body, h: V) -> V {
    let warm = |at: V, r: f64| 1.0 - ramp(ball(h, at, 0.0), 0.2 * r, r);
    let blush = 0.55 * warm([0.047, 0.066, 0.078], 0.032)
        + 0.35 * warm([0.0, 0.066, 0.118], 0.022)
        + 0.5 * warm([0.092, 0.090, -0.004], 0.034);
    let skin = mix(SKIN, [226.0, 138.0, 116.0], blush.min(0.7));
    let skin = over(skin, LIPS, body.lips(h) - 0.0013, 0.0018);
    let skin = over(skin, mul(HAIR, 0.9), brow(h), 0.0016);
    let e = sub(h, EYE);
    // Lids stand out from the eyeball; what lies on it is the eye.
    let lid = len(e) - EYE_RADIUS - 0.0012;
    if e[2] > 0.0 {
        over(skin, eye(e), lid, 0.0008)
    } else {
        skin
    }
}

/// Signed distance to an eyebrow drawn on the brow, thinning outward.
fn brow(h: V) -> f64 {
    let flat = [h[0], h[1], 0.0];
    let inner = bone(
        flat,
        [0.0150, 0.1370, 0.0],
        [0.0360, 0.1440, 0.0],
        0.0034,
        0.0036,
    );
    let outer = bone(
        flat,
        [0.0360, 0.1440, 0.0],
        [0.0570, 0.1345, 0.0],
        0.0036,
        0.0014,
    );
    let front = 0.02 - h[2];
    inner.min(outer).max(front)
}

/// The eyeball's colours; `e` is the place seen from its middle.
fn eye(e: V) -> V {
    let across = (e[0] * e[0] + e[1] * e[1]).sqrt();
    let mut c = over(WHITE, mul(IRIS, 0.55), across - 0.0108, 0.0012);
    c = over(c, IRIS, across - 0.0095, 0.0016);
    c = over(
        c,
        mix(IRIS, CREAM, 0.35),
        (across - 0.0060).abs() - 0.0012,
        0.003,
    );
    c = over(c, PUPIL, across - 0.0052, 0.0010);
    over(
        c,
        WHITE,
        len([e[0] - 0.0032, e[1] - 0.0042, 0.0]) - 0.0021,
        0.0008,
    )
}

fn hair(h: V) -> V {
    // Lighter toward the tips of the locks above the brow.
    mix(HAIR, mul(HAIR, 1.22), ramp(h[1] + 0.5 * h[2], 0.10, 0.28))
}

fn shirt(p: V) -> V {
    let [x, y, z] = p;
    let mut c = TEAL;
    c = over(c, CREAM, (y - 1.165).abs() - 0.034, 0.003);
    c = over(c, CORAL, (y - 1.165).abs() - 0.018, 0.003);
    if z > 0.0 {
        c = over(c, CREAM, star([x - 0.068, y - 1.272]), 0.003);
    } else {
        c = over(c, CREAM, name([-x, y - 1.252]), 0.003);
    }
    c
}

/// Signed distance to the shirt's edge around the throat, which the collar's ring is sunk into at the sides.
fn neckline(body: &Body, p: V) -> f64 {
    let around = (body.throat(p) - 0.018).max(1.436 - p[1] - DROP);
    around.min(body.collar(p) - 0.004)
}

/// Signed distance, roughly, to a five-pointed star.
fn star(p: [f64; 2]) -> f64 {
    // Unit normals of the five edges' lines through the points, by thirds of a pentagram.
    const NORMALS: [[f64; 2]; 5] = [
        [0.0, 1.0],
        [0.951_056_5, 0.309_017],
        [0.587_785_3, -0.809_017],
        [-0.587_785_3, -0.809_017],
        [-0.951_056_5, 0.309_017],
    ];
    // Inside the star is inside at least four of the five lines.
    let mut d = NORMALS.map(|n| n[0] * p[0] + n[1] * p[1] - 0.0105);
    d.sort_by(f64::total_cmp);
    d[3]
}

/// Signed distance to the word on the back: strokes of four letters on a grid.
fn name(p: [f64; 2]) -> f64 {
    const UNIT: f64 = 0.0115;
    #[rustfmt::skip]
    const STROKES: [[f64; 4]; 14] = [
        [0.0, 0.0, 0.0, 4.0], [0.0, 2.8, 1.2, 4.0], [1.2, 4.0, 2.2, 4.0],
        [3.8, 0.0, 3.8, 4.0], [3.8, 5.7, 3.8, 5.8],
        [5.6, 0.0, 5.6, 4.0], [5.6, 4.0, 8.4, 4.0], [5.6, 0.0, 8.4, 0.0], [8.4, 4.0, 8.4, -2.0], [8.4, -2.0, 5.8, -2.0],
        [10.2, 0.0, 10.2, 4.0], [10.2, 4.0, 13.0, 4.0], [10.2, 0.0, 13.0, 0.0], [13.0, 0.0, 13.0, 6.0],
    ];
    let at = [p[0] / UNIT + 6.5, p[1] / UNIT, 0.0];
    let stroke = |[ax, ay, bx, by]: [f64; 4]| bone(at, [ax, ay, 0.0], [bx, by, 0.0], 0.55, 0.55);
    STROKES.map(stroke).into_iter().fold(f64::MAX, f64::min) * UNIT
}

fn sleeve(body: &Body, p: V) -> V {
    let x = body.local(UPPER_ARM, p)[0];
    let c = over(TEAL, CREAM, (x - 0.128).abs() - 0.006, 0.003);
    over(c, CORAL, 0.142 - x, 0.003)
}

fn shorts(body: &Body, p: V) -> V {
    let [x, y, z] = body.local(THIGH, p);
    let side = if x > 0.0 { z.abs() - 0.014 } else { 1.0 };
    let c = over(DENIM, CREAM, side, 0.003);
    over(c, mul(DENIM, 0.72), 0.246 + y, 0.003)
}

fn sock(body: &Body, p: V) -> V {
    let y = -body.local(SHIN, p)[1];
    over(WHITE, CORAL, (y - 0.283).abs() - 0.006, 0.003)
}

fn shoe(body: &Body, p: V) -> V {
    let [x, y, z] = body.local(FOOT, p);
    let c = over(CORAL, mul(CORAL, 0.78), -0.012 - z.min(-y), 0.003);
    over(
        c,
        CREAM,
        bone(
            [x.abs(), y, z],
            [0.04, -0.05, 0.0],
            [0.03, -0.01, 0.05],
            0.006,
            0.005,
        ),
        0.002,
    )
}
