//! Vectors and rigid frames in double precision.
//! No `std` trigonometry: only + - * / and square roots, so that results are the same on every machine.

pub type V = [f64; 3];

pub fn add(a: V, b: V) -> V {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
pub fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
pub fn mul(a: V, s: f64) -> V {
    [a[0] * s, a[1] * s, a[2] * s]
}
pub fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
pub fn cross(a: V, b: V) -> V {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
pub fn len(a: V) -> f64 {
    dot(a, a).sqrt()
}
pub fn unit(a: V) -> V {
    mul(a, 1.0 / len(a).max(1e-12))
}

/// Sine and cosine by Taylor series, identical on every platform.
pub fn sin_cos(x: f64) -> (f64, f64) {
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
pub struct Frame {
    pub axes: [V; 3],
    pub at: V,
}

impl Frame {
    pub const WORLD: Frame = Frame {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        at: [0.0; 3],
    };

    pub fn direction(&self, d: V) -> V {
        let [a, b, c] = self.axes;
        add(add(mul(a, d[0]), mul(b, d[1])), mul(c, d[2]))
    }

    /// The frame of a child joint: `self * T(offset) * Rz * Ry * Rx`.
    pub fn child(&self, offset: V, degrees: V) -> Frame {
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

    /// The frame seen in a mirror at x = 0, with its own x axis turned back.
    pub fn mirrored(&self) -> Frame {
        let flip = |v: V| [-v[0], v[1], v[2]];
        let [a, b, c] = self.axes.map(flip);
        Frame {
            axes: [mul(a, -1.0), b, c],
            at: flip(self.at),
        }
    }

    /// The degrees about x, y and z that turn a child of this frame as `to` is turned.
    pub fn angles_to(&self, to: &Frame) -> V {
        let [a, b, c] = to.axes.map(|axis| self.axes.map(|mine| dot(mine, axis)));
        let flat = (a[0] * a[0] + a[1] * a[1]).sqrt();
        [angle(b[2], c[2]), angle(-a[2], flat), angle(a[1], a[0])]
    }

    pub fn to_local(self, p: V) -> V {
        let d = sub(p, self.at);
        self.axes.map(|a| dot(a, d))
    }
}

/// The angle in degrees, -180 to 180, from the x axis to `(x, y)`, by the series of the arc tangent.
pub fn angle(y: f64, x: f64) -> f64 {
    let r = (x * x + y * y).sqrt();
    if r == 0.0 {
        return 0.0;
    }
    if x < 0.0 {
        // Turned half around, where the series is good.
        let back = angle(-y, -x);
        return if back > 0.0 {
            back - 180.0
        } else {
            back + 180.0
        };
    }
    // Tangents of a half, a quarter and an eighth of the angle: the last is below 0.2.
    let half = |t: f64| t / (1.0 + (1.0 + t * t).sqrt());
    let t = half(half(y / (r + x)));
    let (mut sum, mut power) = (0.0, t);
    for n in 0..14 {
        sum += power / f64::from(2 * n + 1);
        power *= -t * t;
    }
    8.0 * sum * 180.0 / std::f64::consts::PI
}
