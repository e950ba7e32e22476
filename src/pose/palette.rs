//! What each binding of a rig does to the vertices that follow it, in the form that a way of skinning wants.

use crate::rig::{Influence, Rig};
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec4};

/// How a vertex follows several joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Skinning {
    /// Their matrices are averaged by weight.
    #[default]
    Linear,
    /// Their rigid motions are averaged as dual quaternions, which neither collapses at a twist nor at a bend (Kavan et al., "Skinning
    /// with Dual Quaternions", 2007). What scale and shear their matrices have is averaged first.
    DualQuaternion,
}

/// One skinning matrix `model_from_bind`, as the three rows of an affine matrix that a shader multiplies column vectors by.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SkinMatrix {
    /// The fourth component of each is the translation, in the rig's units.
    pub rows: [Vec4; 3],
}

/// The same in two phases: a vertex is stretched, then moved rigidly.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct SkinDualQuaternion {
    /// A unit quaternion (x, y, z, w): the turn.
    pub real: Vec4,
    /// Half of the translation, as a pure quaternion, times `real`.
    pub dual: Vec4,
    /// Rows of the symmetric matrix that holds scale and shear; their last components are 0.
    pub stretch: [Vec4; 3],
}

/// One entry per binding, in the order of [`Rig::bindings`]. Finite, and so small that no vertex can overflow.
#[derive(Debug, Clone, PartialEq)]
pub enum Palette {
    /// To average as [`Skinning::Linear`] does.
    Linear(Vec<SkinMatrix>),
    /// To average as [`Skinning::DualQuaternion`] does.
    DualQuaternion(Vec<SkinDualQuaternion>),
}

impl Palette {
    /// Leaves every vertex where it was modelled.
    pub fn bind(rig: &Rig, skinning: Skinning) -> Self {
        Self::rounded(&vec![DAffine3::IDENTITY; rig.bindings().len()], skinning)
    }

    pub(super) fn rounded(model_from_bind: &[DAffine3], skinning: Skinning) -> Self {
        let matrices = model_from_bind.iter();
        match skinning {
            Skinning::Linear => Self::Linear(matrices.map(SkinMatrix::rounded).collect()),
            Skinning::DualQuaternion => {
                Self::DualQuaternion(matrices.map(SkinDualQuaternion::rounded).collect())
            }
        }
    }

    /// The way of skinning that its entries are for.
    pub fn skinning(&self) -> Skinning {
        match self {
            Self::Linear(_) => Skinning::Linear,
            Self::DualQuaternion(_) => Skinning::DualQuaternion,
        }
    }

    /// Whether the matrix that these influences come to turns left into right: its determinant is negative. A rigid motion never does, so
    /// that of dual quaternions the stretch alone counts.
    pub fn mirrors(&self, influences: &[Influence]) -> bool {
        let (rows_of_entry, first_row) = match self {
            Self::Linear(_) => (3, 0),
            Self::DualQuaternion(_) => (5, 2),
        };
        let mut sums = [DVec3::ZERO; 3];
        for influence in influences {
            let first = influence.binding as usize * rows_of_entry + first_row;
            for (sum, row) in sums.iter_mut().zip(&self.rows()[first..]) {
                *sum += row.truncate().as_dvec3() * f64::from(influence.weight);
            }
        }
        let [x, y, z] = sums;
        x.dot(y.cross(z)) < 0.0
    }

    /// All entries one after another, as a shader reads them.
    pub fn rows(&self) -> &[Vec4] {
        match self {
            Self::Linear(matrices) => bytemuck::cast_slice(matrices),
            Self::DualQuaternion(entries) => bytemuck::cast_slice(entries),
        }
    }
}

impl SkinMatrix {
    fn rounded(model_from_bind: &DAffine3) -> Self {
        let DAffine3 {
            matrix3,
            translation,
        } = model_from_bind;
        let row = |i: usize| matrix3.row(i).extend(translation[i]).as_vec4();
        Self {
            rows: [row(0), row(1), row(2)],
        }
    }
}

impl SkinDualQuaternion {
    fn rounded(model_from_bind: &DAffine3) -> Self {
        let (turn, stretch) = turn_and_stretch(model_from_bind.matrix3);
        let real = DQuat::from_mat3(&turn).normalize();
        let half = model_from_bind.translation / 2.0;
        let dual = DQuat::from_xyzw(half.x, half.y, half.z, 0.0) * real;
        let row = |i: usize| stretch.row(i).extend(0.0).as_vec4();
        Self {
            real: real.as_quat().into(),
            dual: dual.as_quat().into(),
            stretch: [row(0), row(1), row(2)],
        }
    }
}

/// The polar decomposition `matrix = turn · stretch`, where `turn` is a rotation also if `matrix` mirrors. By Newton's method (Higham,
/// "Computing the polar decomposition", 1986). Of a matrix that is too flat for it, all of it counts as stretch.
fn turn_and_stretch(matrix: DMat3) -> (DMat3, DMat3) {
    /// Quadratic convergence needs fewer, whatever the matrix.
    const MOST_STEPS: usize = 64;
    let mut turn = matrix;
    for _ in 0..MOST_STEPS {
        let back = turn.inverse().transpose();
        // Brings the first steps to the right size; near the end it is 1.
        let balance = libm::sqrt(size(back) / size(turn));
        let next = (turn * balance + back * (1.0 / balance)) * 0.5;
        let settled = (next - turn)
            .abs()
            .to_cols_array()
            .iter()
            .all(|&change| change < 1e-14);
        turn = next;
        if settled {
            break;
        }
    }
    if !(turn.transpose() * turn).abs_diff_eq(DMat3::IDENTITY, 1e-9) {
        return (DMat3::IDENTITY, matrix);
    }
    if turn.determinant() < 0.0 {
        turn *= -1.0;
    }
    let stretch = turn.transpose() * matrix;
    (turn, (stretch + stretch.transpose()) * 0.5)
}

/// The square root of the sum of squares.
fn size(matrix: DMat3) -> f64 {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    libm::sqrt(
        columns
            .iter()
            .map(|column: &DVec3| column.length_squared())
            .sum(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_comes_apart_into_a_turn_and_a_stretch() {
        let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.7).normalize());
        let shear = DMat3::from_cols(
            DVec3::new(2.0, 0.3, 0.0),
            DVec3::new(0.3, 0.5, -0.1),
            DVec3::new(0.0, -0.1, 1.5),
        );
        for (stretch, scale) in [
            (DMat3::IDENTITY, 1.0),
            (shear, 1.0),
            (shear, -1.0),
            (shear, 1e-8),
            (shear, 1e8),
        ] {
            let matrix = turn * (stretch * scale);
            let (found_turn, found_stretch) = turn_and_stretch(matrix);
            assert!(found_turn.abs_diff_eq(turn, 1e-12), "{scale}: {found_turn}");
            let off = (found_stretch - stretch * scale) * (1.0 / scale);
            assert!(
                off.abs_diff_eq(DMat3::ZERO, 1e-12),
                "{scale}: {found_stretch}"
            );
        }
    }

    #[test]
    fn a_matrix_that_is_all_but_flat_is_all_stretch() {
        for size in [1e8, 1e9, 1e18] {
            let flat = DMat3::from_cols(
                DVec3::new(size, -size, -size),
                DVec3::new(1.0, 0.0, 0.0),
                DVec3::new(size, -1.0, 1.0 / size),
            );
            for turn in 0..50 {
                let turned = DMat3::from_rotation_z(f64::from(turn)) * DMat3::from_rotation_x(1.7);
                let (turn, stretch) = turn_and_stretch(turned * flat);
                assert!(turn.is_finite() && stretch.is_finite());
                let back = (turn * stretch - turned * flat) * (1.0 / size);
                assert!(back.abs_diff_eq(DMat3::ZERO, 1e-6), "{size}: {back}");
            }
        }
        assert_eq!(
            turn_and_stretch(DMat3::ZERO),
            (DMat3::IDENTITY, DMat3::ZERO)
        );
    }

    #[test]
    fn an_entry_does_what_its_matrix_does() {
        let matrix = DAffine3::from_scale_rotation_translation(
            DVec3::new(1.0, 2.0, 0.5),
            DQuat::from_rotation_y(1.2),
            DVec3::new(4.0, -5.0, 6.0),
        );
        let SkinDualQuaternion {
            real,
            dual,
            stretch,
        } = SkinDualQuaternion::rounded(&matrix);
        let point = glam::Vec3::new(0.3, 0.7, -0.2);
        let stretched = glam::Vec3::from(stretch.map(|row| row.truncate().dot(point)));
        let moved = glam::Quat::from_vec4(real) * stretched
            + 2.0
                * (real.w * dual.truncate() - dual.w * real.truncate()
                    + real.truncate().cross(dual.truncate()));
        let wanted = matrix.transform_point3(point.as_dvec3()).as_vec3();
        assert!(moved.distance(wanted) < 1e-5, "{moved} {wanted}");
    }
}
