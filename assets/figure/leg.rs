//! How the joints of a leg turn so that its foot is where a walk wants it.
//! No time.

use super::skeleton::{BONES, FOOT, SHIN, THIGH};
use super::vectors::{Frame, V, add, angle, len, sin_cos, sub};
use std::f64::consts::PI;

/// Where the left foot is.
#[derive(Clone, Copy)]
pub struct Footing {
    pub ankle: V,
    /// Degrees that the foot points down, and that its toes are bent up.
    pub pitch: f64,
    pub toes: f64,
}

/// The ankle's height over the sole, and the sole's ends before and behind it.
const HEIGHT: f64 = 0.0795;
const HEEL: f64 = -0.062;
const BALL: f64 = 0.112;
/// How far the feet are from the middle, and how far they point outward, in degrees.
const ASIDE: f64 = 0.076;
const OUTWARD: f64 = 6.0;

impl Footing {
    /// A foot on the ground whose ankle would be at `z` were it flat: it stands on its heel where the toes point up,
    /// on the ball and the toes where they point down.
    pub fn standing(z: f64, pitch: f64) -> Footing {
        let pivot = if pitch < 0.0 { HEEL } else { BALL };
        let (s, c) = sin_cos(pitch * PI / 180.0);
        let up = HEIGHT * c + pivot * s;
        let along = HEIGHT * s - pivot * c;
        Footing {
            ankle: [ASIDE, up, z + pivot + along],
            pitch,
            toes: pitch.max(0.0),
        }
    }
}

/// The angles of thigh, shin, foot and toes in degrees.
pub fn leg(pelvis: &Frame, footing: Footing) -> [V; 4] {
    let hip = add(pelvis.at, pelvis.direction(BONES[THIGH].offset));
    let reach = pelvis.to_local(add(pelvis.at, sub(footing.ankle, hip)));
    // The ankle seen from the hip by the thigh, as the knee bends more and more.
    let bent = |knee: f64| {
        let shin = Frame::WORLD.child(BONES[SHIN].offset, [knee, 0.0, 0.0]);
        add(shin.at, shin.direction(BONES[FOOT].offset))
    };
    let (mut straight, mut folded) = (0.0, 140.0);
    for _ in 0..50 {
        let knee = 0.5 * (straight + folded);
        if len(bent(knee)) > len(reach) {
            straight = knee;
        } else {
            folded = knee;
        }
    }
    let knee = straight;
    let ankle = bent(knee);
    let (s, c) = sin_cos(OUTWARD * PI / 180.0);
    let z = reach[2] / c;
    let y = -(len(ankle) * len(ankle) - z * z).max(0.0).sqrt();
    let thigh = [
        angle(z, y) - angle(ankle[2], ankle[1]),
        OUTWARD,
        angle(reach[1], reach[0]) - angle(y, z * s),
    ]
    .map(wrap);
    let thigh_frame = pelvis.child(BONES[THIGH].offset, thigh);
    let shin_frame = thigh_frame.child(BONES[SHIN].offset, [knee, 0.0, 0.0]);
    let foot = Frame::WORLD.child([0.0; 3], [0.0, OUTWARD, 0.0]);
    let foot = foot.child([0.0; 3], [footing.pitch, 0.0, 0.0]);
    let foot = shin_frame.angles_to(&foot);
    [thigh, [knee, 0.0, 0.0], foot, [-footing.toes, 0.0, 0.0]]
}

/// The same angle between -180 and 180 degrees.
fn wrap(degrees: f64) -> f64 {
    degrees - 360.0 * (degrees / 360.0).round()
}
