//! Rules of primitives, nodes, skins and animations. Never lives here: materials.

use super::checker::Checker;
use crate::formats::gltf::nodes::Nodes;
use gltf_json::Index;
use gltf_json::accessor::{Accessor, ComponentType};
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use std::collections::BTreeSet;

pub(super) fn check(checker: &mut Checker, nodes: &Nodes) {
    check_primitives(checker);
    check_nodes(checker, nodes);
    check_skins(checker, nodes);
    check_animations(checker);
}

fn check_primitives(checker: &mut Checker) {
    for (mesh, of_mesh) in checker.root.meshes.iter().enumerate() {
        for (place, primitive) in of_mesh.primitives.iter().enumerate() {
            check_attributes(
                checker,
                primitive,
                &format!("meshes[{mesh}].primitives[{place}]"),
            );
        }
    }
}

fn check_attributes(checker: &mut Checker, primitive: &Primitive, path: &str) {
    let root = checker.root;
    // Of TEXCOORD, COLOR, JOINTS and WEIGHTS: how many sets there are, and the number after the largest.
    let mut sets = [
        ("TEXCOORD", 0, 0),
        ("COLOR", 0, 0),
        ("JOINTS", 0, 0),
        ("WEIGHTS", 0, 0),
    ];
    let mut has_unknown = false;
    for (semantic, &accessor) in &primitive.attributes {
        checker.check_index(&root.accessors, Some(accessor), || {
            format!("{path}.attributes")
        });
        let of_file = root.accessors.get(accessor.value());
        if of_file.is_some_and(is_unsigned_int) {
            checker.warn(|| format!("{path}.attributes has one of whole numbers of 32 bits"));
        }
        let (kind, set) = match semantic {
            Checked::Invalid => {
                has_unknown = true;
                continue;
            }
            Checked::Valid(Semantic::TexCoords(set)) => (0, *set),
            Checked::Valid(Semantic::Colors(set)) => (1, *set),
            Checked::Valid(Semantic::Joints(set)) => (2, *set),
            Checked::Valid(Semantic::Weights(set)) => (3, *set),
            Checked::Valid(_) => continue,
        };
        let (_, count, end) = &mut sets[kind];
        *count += 1;
        *end = set.saturating_add(1).max(*end);
    }
    if has_unknown {
        checker.warn(|| format!("{path}.attributes has one of an unknown name"));
    }
    for (name, _, end) in sets.into_iter().filter(|(_, count, end)| count != end) {
        let last = end - 1;
        checker.warn(|| format!("{path}.attributes has {name}_{last}, but not all before it"));
    }
    let has = |semantic| primitive.attributes.contains_key(&Checked::Valid(semantic));
    for (index, target) in primitive.targets.iter().flatten().enumerate() {
        for (displaced, name, base) in [
            (target.positions, "POSITION", Semantic::Positions),
            (target.normals, "NORMAL", Semantic::Normals),
            (target.tangents, "TANGENT", Semantic::Tangents),
        ] {
            let path = || format!("{path}.targets[{index}].{name}");
            checker.check_index(&root.accessors, displaced, path);
            if displaced.is_some() && !has(base) {
                checker.warn(|| format!("{} displaces what the primitive does not have", path()));
            }
        }
    }
}

fn check_nodes(checker: &mut Checker, nodes: &Nodes) {
    let root = checker.root;
    for (index, node) in root.nodes.iter().enumerate() {
        let path = || format!("nodes[{index}]");
        checker.check_index(&root.cameras, node.camera, || path() + ".camera");
        checker.check_index(&root.meshes, node.mesh, || path() + ".mesh");
        checker.check_index(&root.skins, node.skin, || path() + ".skin");
        let needless = [
            ("skin", node.skin.is_some()),
            ("weights", node.weights.is_some()),
        ];
        for (member, is_there) in needless {
            if is_there && node.mesh.is_none() {
                checker.warn(|| format!("{} has {member}, but no mesh", path()));
            }
        }
    }
    for (index, scene) in root.scenes.iter().enumerate() {
        for (place, node) in scene.nodes.iter().enumerate() {
            let path = || format!("scenes[{index}].nodes[{place}]");
            checker.check_index(&root.nodes, Some(*node), path);
            if nodes.forest.has_parent(node.value()) {
                checker.warn(|| format!("{} is a node with a parent", path()));
            }
        }
    }
}

fn check_skins(checker: &mut Checker, nodes: &Nodes) {
    let (root, forest) = (checker.root, &nodes.forest);
    for (index, skin) in root.skins.iter().enumerate() {
        let path = || format!("skins[{index}]");
        for (place, joint) in skin.joints.iter().enumerate() {
            checker.check_index(&root.nodes, Some(*joint), || {
                format!("{}.joints[{place}]", path())
            });
        }
        checker.check_index(&root.nodes, skin.skeleton, || path() + ".skeleton");
        let joints = || {
            let joints = skin.joints.iter().map(Index::value);
            joints.filter(|&joint| joint < root.nodes.len())
        };
        let tops: BTreeSet<_> = joints().map(|joint| forest.top(joint)).collect();
        if tops.len() > 1 {
            checker.warn(|| format!("the joints of {} have no common root", path()));
        }
        let skeleton = skin.skeleton.map(|skeleton| skeleton.value());
        let skeleton = skeleton.filter(|&skeleton| skeleton < root.nodes.len());
        if skeleton.is_some_and(|top| joints().any(|joint| !forest.is_below(joint, top))) {
            checker.warn(|| format!("{}.skeleton is not above all joints", path()));
        }
    }
}

fn check_animations(checker: &mut Checker) {
    for (index, animation) in checker.root.animations.iter().enumerate() {
        for (place, channel) in animation.channels.iter().enumerate() {
            let path = || format!("animations[{index}].channels[{place}].target.path");
            checker.check_known(&channel.target.path, path, "the channel is left out");
        }
        for (place, sampler) in animation.samplers.iter().enumerate() {
            let path = || format!("animations[{index}].samplers[{place}].interpolation");
            checker.check_known(&sampler.interpolation, path, "LINEAR is taken");
        }
    }
}

fn is_unsigned_int(accessor: &Accessor) -> bool {
    let component = &accessor.component_type;
    matches!(component, Checked::Valid(it) if it.0 == ComponentType::U32)
}
