//! Sixteen numbers at a time: vectors, transposition, and the two functions that a processor has no instruction for. Sums, products,
//! quotients and roots only, each rounded once, so that every machine comes to the same bits: no fused multiply-add, no estimates.
//! Never lives here: what the numbers stand for.
//!
//! Code that works on lanes is compiled once for each kind of vector unit, and has to be inlined into the function that is compiled for
//! one: it is marked `#[inline(always)]`, and has no closures that work on lanes, as those cannot be marked so.

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x16, i32x16};

/// How many vertices, fragments or pixels are worked on at once, on every machine: twice or four times what most vector units hold, so
/// that while one part waits for a quotient or a root another goes on.
pub(super) const LANES: usize = 16;
pub(super) type Lanes<S> = f32x16<S>;
pub(super) type WholeLanes<S> = i32x16<S>;

/// As many vectors, component by component.
#[derive(Clone, Copy)]
pub(super) struct Vectors<S: Simd> {
    pub x: Lanes<S>,
    pub y: Lanes<S>,
    pub z: Lanes<S>,
}

impl<S: Simd> Vectors<S> {
    #[inline(always)]
    pub(super) fn splat(simd: S, [x, y, z]: [f32; 3]) -> Self {
        Self {
            x: Lanes::splat(simd, x),
            y: Lanes::splat(simd, y),
            z: Lanes::splat(simd, z),
        }
    }

    /// The first of `vectors`; where there are fewer than lanes, the last one stands for the rest.
    #[inline(always)]
    pub(super) fn load(simd: S, vectors: &[[f32; 3]]) -> Self {
        let mut lanes = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            let [x, y, z] = vectors[lane.min(vectors.len() - 1)];
            (lanes[0][lane], lanes[1][lane], lanes[2][lane]) = (x, y, z);
        }
        let [x, y, z] = lanes;
        Self {
            x: Lanes::load_array(simd, x),
            y: Lanes::load_array(simd, y),
            z: Lanes::load_array(simd, z),
        }
    }

    /// Over as many of the first of `vectors` as there are lanes.
    #[inline(always)]
    pub(super) fn store(self, vectors: &mut [[f32; 3]]) {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        for (lane, vector) in vectors.iter_mut().take(LANES).enumerate() {
            *vector = [x[lane], y[lane], z[lane]];
        }
    }

    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> Lanes<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }

    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }

    #[inline(always)]
    pub(super) fn times(self, factor: Lanes<S>) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }

    /// Of unit length; `otherwise` where a vector has no direction.
    #[inline(always)]
    pub(super) fn unit_or(self, otherwise: Self) -> Self {
        let squared = self.dot(self);
        let zero = Lanes::splat(squared.token(), 0.0);
        let unit = self.times(1.0 / squared.sqrt());
        // Also false for what is no number.
        let has_direction = squared.simd_gt(zero) & squared.simd_lt(f32::INFINITY);
        Self {
            x: has_direction.select(unit.x, otherwise.x),
            y: has_direction.select(unit.y, otherwise.y),
            z: has_direction.select(unit.z, otherwise.z),
        }
    }
}

/// From rows of four to four columns.
#[inline(always)]
pub(super) fn transposed<S: Simd>(rows: [f32x4<S>; LANES]) -> [Lanes<S>; 4] {
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = rows;
    let first = square([a, b, c, d]);
    let second = square([e, f, g, h]);
    let third = square([i, j, k, l]);
    let last = square([m, n, o, p]);
    let mut columns = [Lanes::splat(a.token(), 0.0); 4];
    for column in 0..4 {
        let low = first[column].combine(second[column]);
        columns[column] = low.combine(third[column].combine(last[column]));
    }
    columns
}

/// From four columns to rows of four.
#[inline(always)]
pub(super) fn rows_of<S: Simd>([x, y, z, w]: [Lanes<S>; 4]) -> [f32x4<S>; LANES] {
    let ([x0, x1, x2, x3], [y0, y1, y2, y3]) = (quarters(x), quarters(y));
    let ([z0, z1, z2, z3], [w0, w1, w2, w3]) = (quarters(z), quarters(w));
    let [a, b, c, d] = square([x0, y0, z0, w0]);
    let [e, f, g, h] = square([x1, y1, z1, w1]);
    let [i, j, k, l] = square([x2, y2, z2, w2]);
    let [m, n, o, p] = square([x3, y3, z3, w3]);
    [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p]
}

#[inline(always)]
fn quarters<S: Simd>(lanes: Lanes<S>) -> [f32x4<S>; 4] {
    let (low, high) = lanes.split();
    let ((a, b), (c, d)) = (low.split(), high.split());
    [a, b, c, d]
}

#[inline(always)]
fn square<S: Simd>([a, b, c, d]: [f32x4<S>; 4]) -> [f32x4<S>; 4] {
    let (low_even, low_odd) = (a.zip_low(c), b.zip_low(d));
    let (high_even, high_odd) = (a.zip_high(c), b.zip_high(d));
    [
        low_even.zip_low(low_odd),
        low_even.zip_high(low_odd),
        high_even.zip_low(high_odd),
        high_even.zip_high(high_odd),
    ]
}

/// Held between 0 and 1; 0 of what is no number, which maximum and minimum do not say the same of on every machine.
#[inline(always)]
pub(super) fn saturate<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let zero = Lanes::splat(x.token(), 0.0);
    x.simd_gt(zero).select(x, zero).min(1.0)
}

/// `base` to the power of `exponent`, for a base from 0 to 1 or a little more; anything to the power of 0 is 1.
#[inline(always)]
pub(super) fn power<S: Simd>(base: Lanes<S>, exponent: f32) -> Lanes<S> {
    if exponent == 0.0 {
        return Lanes::splat(base.token(), 1.0);
    }
    exp2(log2(base) * exponent)
}

/// The same to as many exponents.
#[inline(always)]
pub(super) fn powers<S: Simd>(base: Lanes<S>, exponents: Lanes<S>) -> Lanes<S> {
    exp2(log2(base) * exponents)
}

/// The logarithm to base 2 of a positive number; about −127 for 0. Coefficients are those of Cephes' `logf`, lowest power first.
#[inline(always)]
fn log2<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    const SERIES: [f32; 9] = [
        3.333_333e-1,
        -2.499_999_4e-1,
        2.000_071_5e-1,
        -1.666_805_7e-1,
        1.424_932_3e-1,
        -1.242_014_1e-1,
        1.167_699_9e-1,
        -1.151_461e-1,
        7.037_683_6e-2,
    ];
    const SQRT_HALF_BITS: i32 = 0x3f35_04f3;
    let bits: WholeLanes<S> = x.bitcast();
    // x = mantissa · 2^exponent, the mantissa from √½ to √2.
    let exponent = (bits - SQRT_HALF_BITS) >> 23;
    let mantissa: Lanes<S> = (bits - (exponent << 23)).bitcast();
    let off = mantissa - 1.0;
    let squared = off * off;
    let fourth = squared * squared;
    // In pairs, so that no sum waits for all the others (Estrin's scheme).
    let low = off * SERIES[1] + SERIES[0] + (off * SERIES[3] + SERIES[2]) * squared;
    let high = off * SERIES[5] + SERIES[4] + (off * SERIES[7] + SERIES[6]) * squared;
    let series = low + (high + fourth * SERIES[8]) * fourth;
    let natural = off - squared * 0.5 + series * (off * squared);
    natural * std::f32::consts::LOG2_E + exponent.to_float::<Lanes<S>>()
}

/// 2 to the power of x, held within what a normal number can be. Coefficients are those of Cephes' `exp2f`, lowest power first.
#[inline(always)]
fn exp2<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    const SERIES: [f32; 6] = [
        6.931_472e-1,
        2.402_264_8e-1,
        5.550_332_4e-2,
        9.618_437e-3,
        1.339_887_4e-3,
        1.535_336_2e-4,
    ];
    let held = x.max(-126.0).min(126.0);
    let whole = held.round_ties_even();
    let off = held - whole;
    let squared = off * off;
    let low = off * SERIES[1] + SERIES[0] + (off * SERIES[3] + SERIES[2]) * squared;
    let series = low + (off * SERIES[5] + SERIES[4]) * (squared * squared);
    let bits: WholeLanes<S> = (series * off + 1.0).bitcast();
    (bits + (whole.to_int::<WholeLanes<S>>() << 23)).bitcast()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    fn powers(bases: [f32; LANES], exponent: f32) -> [f32; LANES] {
        dispatch!(Level::new(), simd => power(Lanes::load_array(simd, bases), exponent).to_array())
    }

    #[test]
    fn powers_are_those_of_libm() {
        for exponent in [0.1f32, 1.0 / 2.4, 0.5, 1.0, 7.3, 32.0, 500.0, 5000.0] {
            for step in 0..1000 {
                let base = 1.0 - (step as f32 / 1000.0) * if exponent > 100.0 { 0.1 } else { 1.0 };
                let found = f64::from(powers([base; LANES], exponent)[step % LANES]);
                let wanted = libm::pow(f64::from(base), f64::from(exponent));
                let off = (found - wanted).abs();
                // A half of the last place of a base is worth that of the result, as many times as the exponent says.
                let allowed = wanted * (2e-6 + 1e-7 * f64::from(exponent)) + 1e-37;
                assert!(off <= allowed, "{base}^{exponent}: {found}, not {wanted}");
            }
        }
    }

    #[test]
    fn the_ends_of_powers_are_exact_or_nothing() {
        assert_eq!(powers([1.0; LANES], 32.0), [1.0; LANES]);
        assert_eq!(powers([0.0; LANES], 0.0), [1.0; LANES]);
        assert!(powers([0.0; LANES], 0.1)[0] < 2e-4);
        assert!(powers([0.0; LANES], 1.0)[0] < 1e-37);
    }

    #[test]
    fn powers_to_many_exponents_are_those_to_each() {
        let exponents: [f32; LANES] = std::array::from_fn(|lane| [0.0, 0.5, 32.0, 4e3][lane % 4]);
        let bases: [f32; LANES] = std::array::from_fn(|lane| [0.0, 1.0, 0.7][lane % 3]);
        let found = dispatch!(Level::new(), simd => {
            let exponents = Lanes::load_array(simd, exponents);
            super::powers(Lanes::load_array(simd, bases), exponents).to_array()
        });
        for lane in 0..LANES {
            assert_eq!(found[lane], powers(bases, exponents[lane])[lane]);
        }
    }

    #[test]
    fn rows_become_columns() {
        let columns = dispatch!(Level::new(), simd => {
            let rows = std::array::from_fn(|row| {
                f32x4::load_array(simd, [0.0, 1.0, 2.0, 3.0].map(|column: f32| column + 10.0 * row as f32))
            });
            transposed(rows).map(|column| column.to_array())
        });
        for (at, column) in columns.iter().enumerate() {
            let wanted: Vec<f32> = (0..LANES)
                .map(|row| at as f32 + 10.0 * row as f32)
                .collect();
            assert_eq!(column[..], wanted);
        }
    }

    #[test]
    fn a_vector_without_a_direction_gives_way() {
        let found = dispatch!(Level::new(), simd => {
            let mut given = [[0.0; 3]; LANES];
            given[1] = [3.0, 0.0, 4.0];
            given[2] = [f32::NAN, 1.0, 0.0];
            given[3] = [1e30, 0.0, 0.0];
            let mut found = given;
            Vectors::load(simd, &given).unit_or(Vectors::splat(simd, [0.0, 1.0, 0.0])).store(&mut found);
            found
        });
        assert_eq!(
            found[..4],
            [
                [0.0, 1.0, 0.0],
                [0.6, 0.0, 0.8],
                [0.0, 1.0, 0.0],
                [0.0, 1.0, 0.0]
            ]
        );
    }
}
