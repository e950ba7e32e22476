//! Skins as bindings. Never lives here: which vertices follow them.

use super::accessors::{Accessors, Wanted};
use super::nodes::Nodes;
use crate::formats::error::LoadError;
use crate::rig::{BindPose, BindingDraft, Draft};
use glam::{DAffine3, DMat4};
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::{Index, Skin};
use std::collections::HashMap;

const MATRICES: Wanted = Wanted {
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
    pub fn new(accessors: Accessors<'a>) -> Self {
        Self {
            accessors,
            known: HashMap::new(),
            read: HashMap::new(),
        }
    }

    /// The bindings of a skin, one for each of its joints.
    pub fn bindings(
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
        let matrices = match of_file.inverse_bind_matrices {
            None => None,
            Some(matrices) => {
                let path = format!("{path}.inverseBindMatrices");
                let matrices = self.accessors.vectors::<16>(matrices, &path, MATRICES)?;
                if matrices.len() < count {
                    let expected = format!("a matrix for each of {count} joints");
                    return Err(faults.load(&path, expected, matrices.len().to_string()));
                }
                Some(matrices)
            }
        };
        let mut is_joint = vec![false; root.nodes.len()];
        let mut bindings = Vec::with_capacity(count);
        for (place, node) in of_file.joints.iter().enumerate() {
            let path = format!("{path}.joints[{place}]");
            faults.get(&root.nodes, "nodes", *node, &path)?;
            if std::mem::replace(&mut is_joint[node.value()], true) {
                let found = format!("node {} again", node.value());
                return Err(faults.load(&path, "each joint once", found));
            }
            // All joints of skins that are drawn are among the nodes that matter.
            let joint = nodes.joint_of[node.value()];
            let joint =
                joint.ok_or_else(|| faults.load(&path, "a node of the scene", "another"))?;
            let joint_from_bind = matrices.as_ref().map_or(DMat4::IDENTITY, |matrices| {
                DMat4::from_cols_array(&matrices[place].map(f64::from))
            });
            bindings.push(self.binding(joint, DAffine3::from_mat4(joint_from_bind), draft));
        }
        self.read.insert(skin.value(), bindings.clone());
        Ok(bindings)
    }

    /// What follows a joint as if it were modelled in the joint's own space.
    pub fn rigid(&mut self, joint: usize, draft: &mut Draft) -> u32 {
        self.binding(joint, DAffine3::IDENTITY, draft)
    }

    fn binding(&mut self, joint: usize, joint_from_bind: DAffine3, draft: &mut Draft) -> u32 {
        let bits = DMat4::from(joint_from_bind)
            .to_cols_array()
            .map(f64::to_bits);
        *self.known.entry((joint, bits)).or_insert_with(|| {
            draft.bindings.push(BindingDraft {
                joint: Some(joint),
                stood: BindPose::JointFromBind(joint_from_bind),
            });
            draft.bindings.len() as u32 - 1
        })
    }
}
