//! What a document says against the specification, without consequence for what is read: a warning each.
//! Never lives here: what the readers meet on their way, which they tell themselves.

mod checker;
mod data;
mod looks;
mod scene;

use super::fault::Faults;
use super::nodes::Nodes;
use crate::rig::Warnings;
use checker::Checker;
use gltf_json::Root;

/// Checks what the readers did not have to.
pub(super) fn warn(faults: Faults<'_>, root: &Root, nodes: &Nodes, warnings: &mut Warnings) {
    let mut checker = Checker {
        faults,
        root,
        warnings,
    };
    data::check(&mut checker);
    scene::check(&mut checker, nodes);
    looks::check(&mut checker);
}
