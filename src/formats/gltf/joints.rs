//! The transform of a node as that of a joint. Never lives here: which nodes are joints.

use super::fault::Faults;
use crate::formats::error::LoadError;
use crate::rig::{JointDraft, Rotation, Warnings};
use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};
use gltf_json::Node;

/// Whether it is of length 1 as far as quaternions of bytes can be, which the Khronos validator allows too.
pub(super) fn is_unit(quaternion: DQuat) -> bool {
    /// Four times half a step of 1/127, and a little.
    const TOLERANCE: f64 = 0.00769;
    (quaternion.length() - 1.0).abs() <= TOLERANCE
}

pub(super) fn joint(
    faults: Faults<'_>,
    index: usize,
    node: &Node,
    parent: Option<usize>,
    warnings: &mut Warnings,
) -> Result<JointDraft, LoadError> {
    let path = format!("nodes[{index}]");
    let vector = |vector: [f32; 3]| DVec3::from_array(vector.map(f64::from));
    let (scale, rotation, translation) = match node.matrix {
        Some(matrix) => {
            if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() {
                let sentence = format!(
                    "{path} has a matrix, beside which its translation, rotation and scale are left out"
                );
                warnings.push(|| faults.warning(&sentence));
            }
            let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
            if !matrix.is_finite() {
                let path = format!("{path}.matrix");
                return Err(faults.load(&path, "finite numbers", "others"));
            }
            decomposed(faults, &path, matrix, warnings)
        }
        None => (
            node.scale.map_or(DVec3::ONE, vector),
            rotation_of(faults, &path, node, warnings),
            node.translation.map_or(DVec3::ZERO, vector),
        ),
    };
    if !(scale.is_finite() && translation.is_finite()) {
        return Err(faults.load(&path, "a finite translation and scale", "another"));
    }
    Ok(JointDraft {
        name: faults.name(node.name.as_deref(), &path, warnings),
        parent,
        offset: translation,
        rest_rotation: Rotation::Quaternion(rotation),
        rest_scale: scale,
        translates: true,
        scales: true,
        ..JointDraft::default()
    })
}

/// The rotation of a node without a matrix, as a unit quaternion.
fn rotation_of(faults: Faults<'_>, path: &str, node: &Node, warnings: &mut Warnings) -> DQuat {
    let given = node.rotation.unwrap_or_default().0.map(f64::from);
    // Its largest number is made 1 first: the square of a length can vanish or overflow where the length does not.
    let largest = given
        .iter()
        .fold(0.0f64, |largest, it| largest.max(it.abs()));
    let quaternion = DQuat::from_array(given.map(|it| it / largest));
    let is_rotation = largest > 0.0 && quaternion.is_finite();
    if !is_rotation {
        warnings.push(|| faults.warning(&format!("{path}.rotation is no rotation and left out")));
    }
    if is_rotation && !is_unit(DQuat::from_array(given)) {
        let sentence = format!("{path}.rotation is no unit quaternion and is made one");
        warnings.push(|| faults.warning(&sentence));
    }
    if is_rotation {
        quaternion.normalize()
    } else {
        DQuat::IDENTITY
    }
}

/// Scale, rotation and translation. What they cannot express is left out with a warning.
fn decomposed(
    faults: Faults<'_>,
    path: &str,
    matrix: DMat4,
    warnings: &mut Warnings,
) -> (DVec3, DQuat, DVec3) {
    let columns = DMat3::from_mat4(matrix);
    let lengths = [columns.x_axis, columns.y_axis, columns.z_axis].map(DVec3::length);
    let mirrored = if columns.determinant() < 0.0 {
        -1.0
    } else {
        1.0
    };
    let scale = DVec3::new(lengths[0] * mirrored, lengths[1], lengths[2]);
    let turn = DMat3::from_cols(
        columns.x_axis / scale.x,
        columns.y_axis / scale.y,
        columns.z_axis / scale.z,
    );
    let rotation = DQuat::from_mat3(&turn);
    let rotation = if rotation.is_finite() && rotation.length() > 0.0 {
        rotation.normalize()
    } else {
        DQuat::IDENTITY
    };
    let back = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
    // As much as float32 leaves of a rotation.
    let tolerance = 1e-4 * scale.abs().max_element();
    let is_affine = matrix.row(3) == DVec4::W;
    if !is_affine || !back.abs_diff_eq(columns, tolerance) {
        warnings.push(|| {
            let shear = "is no translation, rotation and scale; what else it is is left out";
            faults.warning(&format!("{path}.matrix {shear}"))
        });
    }
    (scale, rotation, matrix.w_axis.truncate())
}
