//! The body as a signed distance field whose parts live in the frames of the bones they belong to.
//! No mesh and no colour.

use super::shapes::{ball, bone, carve, ellipsoid, join, loft, meet, ramp};
use super::skeleton::{
    FINGERS, FOOT, FOREARM, HAND, HEAD, SHIN, THIGH, THUMB, TOES, UPPER_ARM, bind_frames,
};
use super::vectors::{Frame, V, add, dot, len, mul, sub};

/// Height of the modelled trunk above the written figure, and size of the head.
pub const DROP: f64 = 0.057;
const HEAD_SCALE: f64 = 1.09;
/// Middle and radius of the left eyeball in the frame of the head.
pub const EYE: V = [0.0350, 0.1020, 0.0655];
pub const EYE_RADIUS: f64 = 0.0225;

/// The body in its bind pose.  Every part is described in the frame of its
/// bone, for the character's left side; `x` is folded over before use.
pub struct Body {
    pub frames: Vec<Frame>,
}

/// A bar of three radii bent at its middle.
fn bow(p: V, a: V, b: V, c: V, [ra, rb, rc]: V) -> f64 {
    bone(p, a, b, ra, rb).min(bone(p, b, c, rb, rc))
}

#[rustfmt::skip]
impl Body {
    /// The body over the frames that it is modelled in.
    pub fn new() -> Body {
        Body { frames: bind_frames() }
    }

    pub fn local(&self, bone: usize, p: V) -> V {
        self.frames[bone].to_local(p)
    }

    /// The shirt without its sleeves and collar.
    pub fn shirt(&self, p: V) -> f64 {
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
        join(shirt, slope, 0.04)
    }

    /// Seat of the shorts.
    pub fn seat(&self, p: V) -> f64 {
        let p = add(p, [0.0, DROP, 0.0]);
        let [x, y, z] = p;
        let seat = loft(y, x, z, &[
            [0.830, 0.100, 0.070, 0.0, -0.010], [0.86, 0.135, 0.092, 0.0, -0.008],
            [0.91, 0.158, 0.106, 0.0, -0.008], [0.95, 0.153, 0.106, 0.0, -0.007],
            [0.985, 0.138, 0.100, 0.0, -0.005],
        ], 0.03);
        let rump = ellipsoid(p, [0.070, 0.885, -0.055], [0.072, 0.078, 0.066]);
        join(seat, rump, 0.04)
    }

    pub fn torso(&self, p: V) -> f64 {
        join(self.shirt(p), self.seat(p), 0.007)
    }

    pub fn throat(&self, p: V) -> f64 {
        let p = add(p, [0.0, DROP, 0.0]);
        let throat = bone(p, [0.0, 1.40, -0.028], [0.0, 1.57, 0.0], 0.054, 0.049);
        let cord = bone(p, [0.014, 1.445, 0.024], [0.052, 1.545, -0.012], 0.011, 0.014);
        join(throat, cord, 0.02)
    }

    /// Shirt collar: a tilted ring.
    pub fn collar(&self, p: V) -> f64 {
        let p = add(p, [0.0, DROP, 0.0]);
        let q = sub(p, [0.0, 1.449, -0.013]);
        let h = q[1] + 0.23 * q[2];
        let ring = (q[0] * q[0] + q[2] * q[2] * 0.94).sqrt() - 0.0655;
        (ring * ring + 0.42 * h * h).sqrt() - 0.0130
    }

    pub fn neck(&self, p: V) -> f64 {
        join(self.throat(p), self.collar(p), 0.006)
    }

    /// Head without its hair, in the head's frame (chin near y = 0).
    pub fn face(&self, h: V) -> f64 {
        let skull = ellipsoid(h, [0.0, 0.135, -0.006], [0.080, 0.094, 0.098]);
        let front = ellipsoid(h, [0.0, 0.080, 0.028], [0.064, 0.088, 0.068]);
        let jaw = bone(h, [0.045, 0.036, 0.006], [0.018, 0.003, 0.062], 0.023, 0.020);
        let mut d = join(join(skull, front, 0.04), jaw, 0.035);
        d = join(d, ball(h, [0.0, 0.002, 0.078], 0.017), 0.025);
        d = join(d, ball(h, [0.039, 0.060, 0.055], 0.030), 0.035);
        // Eye sockets, brows, then eyeballs with a conical pupil, and lids
        // turned about the eye's middle so that the opening is an almond.
        d = carve(d, ellipsoid(h, [0.036, 0.103, 0.098], [0.025, 0.019, 0.018]), 0.018);
        d = join(d, self.brow(h), 0.011);
        let e = sub(h, EYE);
        let across = (e[0] * e[0] + e[1] * e[1]).sqrt();
        let pit = if e[2] > 0.0 { 0.0065 * (1.0 - ramp(across, 0.0010, 0.0098)) } else { 0.0 };
        d = d.min(len(e) - EYE_RADIUS + pit);
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
        d = join(d, self.lips(h), 0.005);
        let line = bow(h, [0.0, 0.0352, 0.1035], [0.014, 0.0362, 0.1010], [0.0310, 0.0425, 0.0895],
            [0.0030, 0.0029, 0.0026]);
        d = carve(d, line, 0.004);
        // Ear.
        let e = sub(h, [0.0830, 0.090, -0.006]);
        let tilted = [e[0] - 0.25 * (0.010 - e[2]), e[1] + 0.22 * e[2], e[2] - 0.12 * e[1]];
        let shell = ellipsoid(tilted, [0.0; 3], [0.0085, 0.0330, 0.0205]);
        let bowl = ellipsoid(tilted, [0.0085, 0.0030, 0.0035], [0.0075, 0.0215, 0.0120]);
        join(d, carve(shell, bowl, 0.004), 0.006)
    }

    /// Eyebrow, in the head's frame.
    pub fn brow(&self, h: V) -> f64 {
        bow(h, [0.015, 0.1365, 0.0905], [0.036, 0.1410, 0.0835], [0.056, 0.1310, 0.0680],
            [0.0050, 0.0062, 0.0042])
    }

    /// Both lips, in the head's frame.
    pub fn lips(&self, h: V) -> f64 {
        let upper = bow(h, [0.0, 0.0415, 0.0965], [0.014, 0.0425, 0.0940], [0.0275, 0.0415, 0.0870],
            [0.0062, 0.0060, 0.0036]);
        let lower = bow(h, [0.0, 0.0280, 0.0955], [0.013, 0.0297, 0.0930], [0.0250, 0.0370, 0.0870],
            [0.0078, 0.0070, 0.0038]);
        upper.min(lower)
    }

    /// Short hair: a cap with a hairline, and locks swept back from the brow.
    pub fn hair(&self, h: V) -> f64 {
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

    /// A place in the frame and size that the head is described in.
    pub fn in_head(&self, p: V) -> V {
        mul(self.local(HEAD, p), 1.0 / HEAD_SCALE)
    }

    /// A difference of places in that frame and size, as one of places of the body.
    pub fn out_of_head(&self, d: V) -> V {
        mul(self.frames[HEAD].direction(d), HEAD_SCALE)
    }

    pub fn head(&self, p: V) -> f64 {
        let h = self.in_head(p);
        join(self.face(h), self.hair(h), 0.004) * HEAD_SCALE
    }

    /// Arm from shoulder to wrist.
    pub fn bare_arm(&self, p: V) -> f64 {
        let [x, y, z] = self.local(UPPER_ARM, p);
        let skin = loft(x, y, z, &[
            [0.05, 0.040, 0.042, 0.0, 0.0], [0.12, 0.040, 0.042, 0.001, 0.003],
            [0.18, 0.0385, 0.041, 0.001, 0.005], [0.24, 0.034, 0.037, 0.0, 0.001],
            [0.29, 0.033, 0.035, 0.0, -0.002],
        ], 0.02);
        let [x, y, z] = self.local(FOREARM, p);
        let fore = loft(x, y, z, &[
            [-0.025, 0.030, 0.032, 0.0, -0.001], [0.01, 0.035, 0.037, 0.0, 0.0],
            [0.06, 0.0375, 0.040, 0.0, 0.003], [0.11, 0.035, 0.038, 0.0, 0.003],
            [0.18, 0.0275, 0.031, 0.0, 0.0], [0.23, 0.0225, 0.028, 0.0, 0.0],
            [0.27, 0.0200, 0.0275, 0.0, 0.0],
        ], 0.015);
        join(skin, fore, 0.02)
    }

    pub fn sleeve(&self, p: V) -> f64 {
        let [x, y, z] = self.local(UPPER_ARM, p);
        loft(x, y, z, &[
            [-0.06, 0.034, 0.036, 0.0, 0.0], [-0.02, 0.050, 0.053, -0.001, -0.001],
            [0.02, 0.056, 0.059, 0.000, -0.001], [0.07, 0.055, 0.058, 0.001, 0.0],
            [0.12, 0.0545, 0.057, 0.0, 0.002], [0.160, 0.0590, 0.0610, -0.002, 0.003],
        ], 0.013)
    }

    pub fn arm(&self, p: V) -> f64 {
        join(self.bare_arm(p), self.sleeve(p), 0.006)
    }

    pub fn palm(&self, p: V) -> f64 {
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

    pub fn fingers(&self, p: V) -> f64 {
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

    pub fn thumb(&self, p: V) -> f64 {
        let q = self.local(THUMB, p);
        join(bone(q, [0.0, 0.0, 0.0], [0.030, -0.009, 0.025], 0.0150, 0.0130),
            bone(q, [0.030, -0.009, 0.025], [0.060, -0.013, 0.037], 0.0125, 0.0100), 0.005)
    }

    pub fn hand(&self, p: V) -> f64 {
        join(join(self.palm(p), self.fingers(p), 0.006), self.thumb(p), 0.014)
    }

    /// Leg from hip to ankle.
    pub fn bare_leg(&self, p: V) -> f64 {
        let [x, y, z] = self.local(THIGH, p);
        let thigh = loft(-y, x, z, &[
            [0.05, 0.070, 0.076, -0.004, 0.0], [0.17, 0.071, 0.078, -0.003, 0.003],
            [0.27, 0.062, 0.067, -0.002, 0.004], [0.345, 0.053, 0.057, 0.0, 0.002],
            [0.42, 0.049, 0.052, 0.0, 0.0],
        ], 0.02);
        let [x, y, z] = self.local(SHIN, p);
        let shin = loft(-y, x, z, &[
            [-0.03, 0.047, 0.048, 0.0, 0.0], [0.02, 0.046, 0.049, 0.0, 0.0],
            [0.07, 0.047, 0.050, 0.002, -0.007], [0.125, 0.049, 0.053, 0.003, -0.013],
            [0.19, 0.043, 0.047, 0.001, -0.012], [0.27, 0.033, 0.036, 0.0, -0.006],
            [0.33, 0.030, 0.033, 0.0, -0.003], [0.40, 0.032, 0.036, 0.0, -0.003],
        ], 0.015);
        let cap = ellipsoid([x, y, z], [0.0, 0.004, 0.036], [0.026, 0.034, 0.017]);
        join(join(thigh, shin, 0.02), cap, 0.03)
    }

    pub fn sock(&self, p: V) -> f64 {
        let [x, y, z] = self.local(SHIN, p);
        loft(-y, x, z, &[
            [0.265, 0.0450, 0.0480, 0.0, -0.007], [0.290, 0.0430, 0.0460, 0.0, -0.005],
            [0.315, 0.0390, 0.0420, 0.0, -0.004], [0.39, 0.0390, 0.0430, 0.0, -0.003],
        ], 0.008)
    }

    /// Leg of the shorts.
    pub fn shorts(&self, p: V) -> f64 {
        let [x, y, z] = self.local(THIGH, p);
        loft(-y, x, z, &[
            [-0.06, 0.050, 0.070, 0.010, -0.004], [0.0, 0.074, 0.092, 0.004, -0.004],
            [0.06, 0.0815, 0.095, -0.002, -0.002], [0.15, 0.0820, 0.091, -0.003, 0.001],
            [0.225, 0.0830, 0.090, -0.002, 0.003], [0.262, 0.0870, 0.095, -0.002, 0.003],
        ], 0.014)
    }

    pub fn leg(&self, p: V) -> f64 {
        join(join(self.bare_leg(p), self.sock(p), 0.005), self.shorts(p), 0.006)
    }

    pub fn sole(&self, p: V) -> f64 {
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
        meet(side - 0.007, slab, 0.009)
    }

    /// The shoe above its sole and without its laces.
    pub fn upper(&self, p: V) -> f64 {
        let q = self.local(FOOT, p);
        let heel = ellipsoid(q, [0.0, -0.040, -0.022], [0.0345, 0.056, 0.042]);
        let instep = bone(q, [0.0, -0.006, 0.002], [0.004, -0.042, 0.095], 0.039, 0.026);
        let toe = ellipsoid(q, [0.000, -0.050, 0.112], [0.0410, 0.036, 0.068]);
        let upper = join(join(heel, instep, 0.03), toe, 0.03);
        let upper = meet(upper, -(q[1] + 0.066), 0.004);
        let rim = loft(q[1], q[0], q[2], &[
            [-0.01, 0.0400, 0.048, 0.0, 0.000], [0.022, 0.0385, 0.044, 0.0, -0.002],
        ], 0.005);
        let tongue = bone(q, [0.0, 0.026, 0.036], [0.0, -0.012, 0.062], 0.012, 0.014);
        join(join(upper, rim, 0.012), tongue, 0.008)
    }

    pub fn laces(&self, p: V) -> [f64; 2] {
        let q = self.local(FOOT, p);
        [(-0.002, 0.072), (-0.020, 0.096)].map(|(y, z)| {
            bone(q, [0.0, y, z], [0.020, y - 0.009, z - 0.004], 0.0085, 0.0070)
        })
    }

    pub fn shoe(&self, p: V) -> f64 {
        let laced = self.laces(p).into_iter().fold(self.upper(p), |d, lace| join(d, lace, 0.004));
        join(laced, self.sole(p), 0.004)
    }

    /// The whole field.  Parts too far from `p` to matter are skipped.
    pub fn field(&self, p: V) -> f64 {
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

    pub fn gradient(&self, p: V, e: f64) -> V {
        let at = |x, y, z| self.field(add(p, [x, y, z]));
        let x = if p[0] == 0.0 { 0.0 } else { at(e, 0.0, 0.0) - at(-e, 0.0, 0.0) };
        let g = [x, at(0.0, e, 0.0) - at(0.0, -e, 0.0), at(0.0, 0.0, e) - at(0.0, 0.0, -e)];
        mul(g, 0.5 / e)
    }

    /// Moves a point onto the surface by damped Newton steps.
    pub fn project(&self, mut p: V, steps: usize) -> V {
        for _ in 0..steps {
            let g = self.gradient(p, 6e-4);
            let t = (self.field(p) / dot(g, g).max(0.1)).clamp(-0.006, 0.006);
            p = sub(p, mul(g, t));
        }
        p
    }
}
