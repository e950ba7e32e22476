//! Skinning by dual quaternions (Kavan and others 2007, linear blending), stretch apart from rotation. Never lives here: linear blending of
//! matrices, joints.

use super::matrix::{
    Matrix, Square, add_share, affine, cofactors, dot, inverse_transposed, length, linear_part,
    origin, product, transposed,
};

/// `x y z w`
type Quaternion = [f64; 4];

/// How the two quaternions that mean one rotation are chosen between before a sum. All but the first are wrong, to see that it is noticed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Signs {
    /// On the side of the heaviest influence; the lowest joint among equals.
    Heaviest,
    /// On the side of the lightest influence.
    Lightest,
    /// As they come: with w above 0.
    Kept,
}

/// A matrix taken apart: `matrix · v = rotation · stretch · v + translation`, the latter two as a dual quaternion.
#[derive(Debug, Clone, Copy)]
pub struct Parts {
    real: Quaternion,
    dual: Quaternion,
    stretch: Square,
}

/// What moves a vertex: stretched first, then moved as a rigid body.
#[derive(Debug, Clone, Copy)]
pub struct Blend {
    stretch: Square,
    rigid: Matrix,
}

impl Parts {
    pub fn of(model_from_bind: &Matrix) -> Self {
        let linear = linear_part(model_from_bind);
        let rotation = rotation_of(&linear);
        let [x, y, z] = origin(model_from_bind);
        let real = quaternion(&rotation);
        Self {
            real,
            dual: multiplied([x, y, z, 0.0], real).map(|part| part / 2.0),
            stretch: product(&transposed(&rotation), &linear),
        }
    }
}

/// How near to a right angle two quaternions may stand (a cosine) before rounding in f32 decides on which side.
const UNDECIDED: f64 = 1e-5;

impl Blend {
    /// Of `(joint, weight)`, the weights' sum being 1. `None` where rounding decides a sign.
    pub fn of(influences: &[(usize, f64)], parts: &[Parts], signs: Signs) -> Option<Self> {
        let mut by_joint = influences.to_vec();
        by_joint.sort_by_key(|&(joint, _)| joint);
        let first = *by_joint.first()?;
        let pivot = by_joint.iter().fold(first, |best, &other| match signs {
            Signs::Lightest if other.1 < best.1 => other,
            Signs::Heaviest if other.1 > best.1 => other,
            _ => best,
        });
        let pivot = parts[pivot.0].real;
        let (mut real, mut dual, mut stretch) = ([0.0; 4], [0.0; 4], [[0.0; 3]; 3]);
        for (joint, weight) in by_joint {
            let joint = &parts[joint];
            let cosine = dot(joint.real, pivot);
            if cosine.abs() < UNDECIDED && weight > 0.0 {
                return None;
            }
            let is_opposite = cosine < 0.0 && signs != Signs::Kept;
            let share = if is_opposite { -weight } else { weight };
            real = [0, 1, 2, 3].map(|i| real[i] + share * joint.real[i]);
            dual = [0, 1, 2, 3].map(|i| dual[i] + share * joint.dual[i]);
            add_share(&mut stretch, weight, &joint.stretch);
        }
        let size = length(real);
        let (real, dual) = (real.map(|part| part / size), dual.map(|part| part / size));
        let [x, y, z, w] = real;
        // What of `dual` stands along `real` falls out: it has no part in x, y and z.
        let [tx, ty, tz, _] = multiplied(dual, [-x, -y, -z, w]).map(|part| 2.0 * part);
        Some(Self {
            stretch,
            rigid: affine(&matrix_of(real), [tx, ty, tz]),
        })
    }

    /// Takes positions where they belong.
    pub fn matrix(&self) -> Matrix {
        product(&self.rigid, &affine(&self.stretch, [0.0; 3]))
    }

    /// Takes normals where they belong, at a length of its own.
    pub fn normal_matrix(&self) -> Square {
        product(&linear_part(&self.rigid), &cofactors(&self.stretch))
    }
}

/// The rotation of a polar decomposition: Newton's iteration averages a matrix with its inverse's transpose until they are one (Higham 1986).
/// A mirrored matrix gives a rotation as well, and a stretch by negative factors.
pub fn rotation_of(linear: &Square) -> Square {
    let mut rotation = *linear;
    for _ in 0..100 {
        let mut next = rotation.map(|row| row.map(|entry| entry / 2.0));
        add_share(&mut next, 0.5, &inverse_transposed(&rotation));
        rotation = next;
    }
    let determinant = dot(rotation[0], cofactors(&rotation)[0]);
    rotation.map(|row| row.map(|entry| entry * determinant.signum()))
}

/// By its largest part, so that no difference of near numbers is divided by.
fn quaternion(rotation: &Square) -> Quaternion {
    let [[a, b, c], [d, e, f], [g, h, i]] = *rotation;
    // Four times the squares of x, y, z and w.
    let squares = [
        1.0 + a - e - i,
        1.0 - a + e - i,
        1.0 - a - e + i,
        1.0 + a + e + i,
    ];
    let products = [
        [squares[0], b + d, c + g, h - f],
        [b + d, squares[1], f + h, c - g],
        [c + g, f + h, squares[2], d - b],
        [h - f, c - g, d - b, squares[3]],
    ];
    let largest = (0..4).fold(0, |best, part| {
        if squares[part] > squares[best] {
            part
        } else {
            best
        }
    });
    let row = products[largest];
    let size = length(row);
    let sign = if row[3] < 0.0 { -1.0 } else { 1.0 };
    row.map(|part| sign * part / size)
}

fn matrix_of([x, y, z, w]: Quaternion) -> Square {
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

fn multiplied([ax, ay, az, aw]: Quaternion, [bx, by, bz, bw]: Quaternion) -> Quaternion {
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}
