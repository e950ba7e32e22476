//! Skins as bindings. Never lives here: which vertices follow them.

use super::accessors::{Accessors, Requirement};
use super::nodes::Nodes;
use crate::formats::error::LoadError;
use crate::rig::{BindPose, BindingDraft, Draft, Warnings};
use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::{Index, Skin};
use std::collections::HashMap;

const MATRICES: Requirement = Requirement {
    types: &[Type::Mat4],
    components: &[ComponentType::F32],
    expected: "MAT4 of F32",
    normalizes: false,
};

/// Adds bindings to a draft, each once: exporters repeat a skin for every mesh that it moves.
pub(super) struct Skins<'a> {
    accessors: Accessors<'a>,
    /// By joint and the bits of the matrix.
    known: HashMap<(usize, [u64; 16]), u32>,
    /// By skin.
    read: HashMap<usize, Vec<u32>>,
}

impl<'a> Skins<'a> {
    pub(super) fn new(accessors: Accessors<'a>) -> Self {
        Self {
            accessors,
            known: HashMap::new(),
            read: HashMap::new(),
        }
    }

    /// The bindings of a skin, one for each of its joints.
    pub(super) fn bindings(
        &mut self,
        skin: Index<Skin>,
        nodes: &Nodes,
        draft: &mut Draft,
    ) -> Result<Vec<u32>, LoadError> {
        if let Some(bindings) = self.read.get(&skin.value()) {
            return Ok(bindings.clone());
        }
        let Accessors { faults, root, .. } = self.accessors;
        let path = format!("skins[{}]", skin.value());
        let of_file = faults.get(&root.skins, "skins", skin, &path)?;
        let count = of_file.joints.len();
        if count == 0 {
            return Err(faults.load(&format!("{path}.joints"), "at least one joint", "none"));
        }
        let matrices = self.matrices(of_file, &path)?;
        let mut is_joint = vec![false; root.nodes.len()];
        let mut bindings = Vec::with_capacity(count);
        for (place, node) in of_file.joints.iter().enumerate() {
            let path = format!("{path}.joints[{place}]");
            faults.get(&root.nodes, "nodes", *node, &path)?;
            if std::mem::replace(&mut is_joint[node.value()], true) {
                let found = format!("node {} again", node.value());
                return Err(faults.load(&path, "each joint once", found));
            }
            // All joints of skins that are drawn are joints of the skeleton.
            let joint = nodes.joint_of[node.value()];
            let joint =
                joint.ok_or_else(|| faults.load(&path, "a node of the scene", "another"))?;
            let joint_from_bind = matrices.as_ref();
            let joint_from_bind =
                joint_from_bind.map_or(DMat4::IDENTITY, |matrices| in_f64(&matrices[place]));
            if let Some(violation) = violation(joint_from_bind) {
                let sentence = format!("{path}: its inverse bind matrix {violation}");
                draft.warnings.push(|| faults.warning(&sentence));
            }
            bindings.push(self.binding(joint, DAffine3::from_mat4(joint_from_bind), draft));
        }
        self.read.insert(skin.value(), bindings.clone());
        Ok(bindings)
    }

    /// The inverse bind matrices of a skin, at least one for each joint.
    fn matrices(&self, skin: &Skin, path: &str) -> Result<Option<Vec<[f32; 16]>>, LoadError> {
        let Some(matrices) = skin.inverse_bind_matrices else {
            return Ok(None);
        };
        let count = skin.joints.len();
        let path = format!("{path}.inverseBindMatrices");
        let matrices = self.accessors.vectors::<16>(matrices, &path, MATRICES)?;
        if matrices.len() < count {
            let expected = format!("a matrix for each of {count} joints");
            let found = matrices.len().to_string();
            return Err(self.accessors.faults.load(&path, expected, found));
        }
        Ok(Some(matrices))
    }

    /// Warns of what is wrong with the matrices of skins that nothing follows.
    pub(super) fn check_unused(&self, warnings: &mut Warnings) -> Result<(), LoadError> {
        let Accessors { faults, root, .. } = self.accessors;
        for (index, skin) in root.skins.iter().enumerate() {
            if self.read.contains_key(&index) {
                continue;
            }
            let path = format!("skins[{index}]");
            let wrong = match self.matrices(skin, &path) {
                Ok(matrices) => {
                    let mut matrices = matrices.iter().flatten();
                    let violation = matrices.find_map(|matrix| violation(in_f64(matrix)));
                    violation.map(|violation| format!("an inverse bind matrix {violation}"))
                }
                Err(LoadError::Invalid(fault)) => Some(format!(
                    "expected {}, but found {}",
                    fault.expected, fault.found
                )),
                Err(other) => return Err(other),
            };
            if let Some(wrong) = wrong {
                warnings.push(|| faults.warning(&format!("{path} is used by nothing: {wrong}")));
            }
        }
        Ok(())
    }

    /// What follows a joint as if it were modelled in the joint's own space.
    pub(super) fn rigid(&mut self, joint: usize, draft: &mut Draft) -> u32 {
        self.binding(joint, DAffine3::IDENTITY, draft)
    }

    fn binding(&mut self, joint: usize, joint_from_bind: DAffine3, draft: &mut Draft) -> u32 {
        let bits = DMat4::from(joint_from_bind)
            .to_cols_array()
            .map(f64::to_bits);
        *self.known.entry((joint, bits)).or_insert_with(|| {
            draft.bindings.push(BindingDraft {
                file: None,
                joint: Some(joint),
                bind_pose: BindPose::JointFromBind(joint_from_bind),
            });
            draft.bindings.len() as u32 - 1
        })
    }
}

fn in_f64(matrix: &[f32; 16]) -> DMat4 {
    DMat4::from_cols_array(&matrix.map(f64::from))
}

/// What is wrong with an inverse bind matrix, all of which are worked with.
fn violation(joint_from_bind: DMat4) -> Option<&'static str> {
    /// Of unit columns, what rounding to f32 can leave of a determinant that is 0.
    const TOLERANCE: f64 = 1e-6;
    if joint_from_bind.row(3) != DVec4::W {
        return Some("has a fourth row other than 0 0 0 1, which is left out");
    }
    let columns = DMat3::from_mat4(joint_from_bind);
    let [x, y, z] = [columns.x_axis, columns.y_axis, columns.z_axis].map(DVec3::normalize_or_zero);
    let determinant = DMat3::from_cols(x, y, z).determinant();
    (determinant.abs() <= TOLERANCE).then_some("cannot be inverted: what follows the joint is flat")
}
