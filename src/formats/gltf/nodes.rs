//! The scene graph as a skeleton: every node that can move something drawn becomes a joint. Never lives here: what the nodes carry.

use super::extensions::light_of;
use super::fault::Faults;
use super::joints::joint;
use crate::formats::error::LoadError;
use crate::limits::Limits;
use crate::rig::{JointDraft, Warnings};
use glam::DAffine3;
use gltf_json::animation::Property;
use gltf_json::validation::Checked;
use gltf_json::{Index, Node, Root};
use std::collections::BTreeMap;

/// Nodes as joints, parents before their children: depth first, roots and children in the order of the file.
#[derive(Debug)]
pub(super) struct Nodes {
    pub joints: Vec<JointDraft>,
    /// By joint.
    pub node_of: Vec<usize>,
    /// By node; `None` of those that are no joints.
    pub joint_of: Vec<Option<usize>>,
    /// By node, whether it belongs to the scene that is drawn.
    pub is_in_scene: Vec<bool>,
    /// Of nodes that are no joints but carry a light, or have one below them.
    light_transforms: BTreeMap<usize, NodeTransform>,
    pub forest: Forest,
}

/// Where a node is.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeTransform {
    /// `None` of what stands still.
    pub joint: Option<usize>,
    /// Without a joint it leads to the world.
    pub joint_from_node: DAffine3,
}

/// Which nodes of a document are below which, joints or not.
#[derive(Debug)]
pub(super) struct Forest {
    parents: Vec<Option<usize>>,
    /// By node: its place in depth-first order, and where those below it end.
    spans: Vec<[usize; 2]>,
    /// By node, the last one up from it.
    tops: Vec<usize>,
}

impl Forest {
    fn new(parents: Vec<Option<usize>>, order: &[usize]) -> Self {
        let mut spans = vec![[0; 2]; parents.len()];
        let mut tops: Vec<usize> = (0..parents.len()).collect();
        for (place, &node) in order.iter().enumerate() {
            spans[node] = [place, place + 1];
            if let Some(parent) = parents[node] {
                tops[node] = tops[parent];
            }
        }
        for &node in order.iter().rev() {
            if let Some(parent) = parents[node] {
                spans[parent][1] = spans[parent][1].max(spans[node][1]);
            }
        }
        Self {
            parents,
            spans,
            tops,
        }
    }

    pub(super) fn has_parent(&self, node: usize) -> bool {
        self.parents.get(node).is_some_and(Option::is_some)
    }

    /// Whether it is this node or below it.
    pub(super) fn is_below(&self, node: usize, top: usize) -> bool {
        let [start, end] = self.spans[top];
        (start..end).contains(&self.spans[node][0])
    }

    pub(super) fn top(&self, node: usize) -> usize {
        self.tops[node]
    }
}

impl Nodes {
    /// The nodes of the scene, without those that only carry cameras and lights, and of skins' joints outside of it.
    ///
    /// # Errors
    /// Where a node is below itself or has two parents, or its transform is none.
    pub(super) fn gather(
        faults: Faults<'_>,
        root: &Root,
        limits: &Limits,
        warnings: &mut Warnings,
    ) -> Result<Self, LoadError> {
        limits.joints(root.nodes.len())?;
        let parents = parents(faults, root)?;
        let roots = scene_roots(faults, root, &parents)?;
        let order = depth_first(faults, root, &parents, &roots)?;
        let is_in_scene = in_scene(&parents, &order, &roots);
        let is_lit = leading_to_lights(root, &parents, &order, &is_in_scene);
        let is_joint = joint_nodes(faults, root, (&parents, &order), &is_in_scene, &is_lit)?;
        let mut nodes = Self {
            joints: Vec::new(),
            node_of: Vec::new(),
            joint_of: vec![None; root.nodes.len()],
            is_in_scene,
            light_transforms: BTreeMap::new(),
            forest: Forest::new(parents, &order),
        };
        for node in order {
            let parent = nodes.forest.parents[node];
            if !is_joint[node] {
                if is_lit[node] {
                    nodes.place_light(faults, root, node, parent, warnings);
                }
                continue;
            }
            let parent = parent.and_then(|parent| nodes.joint_of[parent]);
            let joint = joint(faults, node, &root.nodes[node], parent, warnings)?;
            nodes.joint_of[node] = Some(nodes.joints.len());
            nodes.joints.push(joint);
            nodes.node_of.push(node);
        }
        Ok(nodes)
    }

    /// Of a node that is a joint or leads to a light; `None` where numbers of it or above it are not finite.
    pub(super) fn transform(&self, node: usize) -> Option<NodeTransform> {
        let joint = self.joint_of[node].map(|joint| NodeTransform {
            joint: Some(joint),
            joint_from_node: DAffine3::IDENTITY,
        });
        joint.or_else(|| self.light_transforms.get(&node).copied())
    }

    /// A light whose node has no usable transform is left out, so that is no fault.
    fn place_light(
        &mut self,
        faults: Faults<'_>,
        root: &Root,
        node: usize,
        parent: Option<usize>,
        warnings: &mut Warnings,
    ) {
        let above = match parent {
            None => Some(NodeTransform {
                joint: None,
                joint_from_node: DAffine3::IDENTITY,
            }),
            Some(parent) => self.transform(parent),
        };
        let own = joint(faults, node, &root.nodes[node], None, warnings).ok();
        if let (Some(above), Some(own)) = (above, own) {
            let parent_from_node = DAffine3::from_scale_rotation_translation(
                own.rest_scale,
                own.rest_rotation.quaternion(own.rotation_order),
                own.offset,
            );
            let transform = NodeTransform {
                joint: above.joint,
                joint_from_node: above.joint_from_node * parent_from_node,
            };
            self.light_transforms.insert(node, transform);
        }
    }
}

/// The parent of each node.
fn parents(faults: Faults<'_>, root: &Root) -> Result<Vec<Option<usize>>, LoadError> {
    let mut parents = vec![None; root.nodes.len()];
    for (index, node) in root.nodes.iter().enumerate() {
        for (place, child) in node.children.iter().flatten().enumerate() {
            let path = format!("nodes[{index}].children[{place}]");
            faults.get(&root.nodes, "nodes", *child, &path)?;
            if let Some(other) = parents[child.value()].replace(index) {
                let found = format!("node {}, a child of node {other} already", child.value());
                return Err(faults.load(&path, "a node without another parent", found));
            }
        }
    }
    Ok(parents)
}

/// All nodes, parents before their children, those of the scene's roots first.
fn depth_first(
    faults: Faults<'_>,
    root: &Root,
    parents: &[Option<usize>],
    scene_roots: &[usize],
) -> Result<Vec<usize>, LoadError> {
    let mut order = Vec::with_capacity(root.nodes.len());
    let mut is_met = vec![false; root.nodes.len()];
    // A root that the file lists may have a parent: then it comes when that one does.
    let starts = scene_roots.iter().copied().chain(0..root.nodes.len());
    let mut open: Vec<usize> = Vec::new();
    for start in starts.filter(|&node| parents[node].is_none()) {
        open.push(start);
        while let Some(node) = open.pop() {
            if std::mem::replace(&mut is_met[node], true) {
                continue;
            }
            order.push(node);
            let children = root.nodes[node].children.iter().flatten();
            open.extend(children.rev().map(Index::value));
        }
    }
    // Each node has one parent at most, so those that no root leads to are below one another in rings.
    match is_met.iter().position(|is_met| !is_met) {
        Some(node) => {
            let path = format!("nodes[{node}]");
            Err(faults.load(&path, "a node that is not below itself", "a ring of nodes"))
        }
        None => Ok(order),
    }
}

/// The nodes that the scene lists; without any scene those that have no parent.
fn scene_roots(
    faults: Faults<'_>,
    root: &Root,
    parents: &[Option<usize>],
) -> Result<Vec<usize>, LoadError> {
    let scene = match root.scene {
        None if root.scenes.is_empty() => {
            let nodes = 0..root.nodes.len();
            return Ok(nodes.filter(|&node| parents[node].is_none()).collect());
        }
        None => Index::new(0),
        Some(scene) => scene,
    };
    let path = format!("scenes[{}]", scene.value());
    let scene = faults.get(&root.scenes, "scenes", scene, "scene")?;
    let mut is_root = vec![false; root.nodes.len()];
    let mut roots = Vec::new();
    for (place, node) in scene.nodes.iter().enumerate() {
        let path = format!("{path}.nodes[{place}]");
        faults.get(&root.nodes, "nodes", *node, &path)?;
        if std::mem::replace(&mut is_root[node.value()], true) {
            return Err(faults.load(
                &path,
                "each node once",
                format!("node {} again", node.value()),
            ));
        }
        roots.push(node.value());
    }
    Ok(roots)
}

/// By node, whether a root of the scene is it or above it.
fn in_scene(parents: &[Option<usize>], order: &[usize], scene_roots: &[usize]) -> Vec<bool> {
    let mut is_in = vec![false; parents.len()];
    for &node in scene_roots {
        is_in[node] = true;
    }
    for &node in order {
        is_in[node] |= parents[node].is_some_and(|parent| is_in[parent]);
    }
    is_in
}

/// By node, whether it is to be a joint.
fn joint_nodes(
    faults: Faults<'_>,
    root: &Root,
    (parents, order): (&[Option<usize>], &[usize]),
    is_in_scene: &[bool],
    is_lit: &[bool],
) -> Result<Vec<bool>, LoadError> {
    let mut is_joint: Vec<bool> = root
        .nodes
        .iter()
        .map(|node| !only_looks_or_lights(node))
        .collect();
    for (is_joint, is_in_scene) in is_joint.iter_mut().zip(is_in_scene) {
        *is_joint &= is_in_scene;
    }
    // A light that an animation moves needs something to be moved by.
    for channel in root.animations.iter().flat_map(|it| &it.channels) {
        let node = channel.target.node.value();
        let moves =
            matches!(channel.target.path, Checked::Valid(it) if it != Property::MorphTargetWeights);
        if moves && is_lit.get(node) == Some(&true) {
            is_joint[node] = true;
        }
    }
    let mut is_known = vec![false; root.skins.len()];
    for (index, node) in root
        .nodes
        .iter()
        .enumerate()
        .filter(|(index, _)| is_in_scene[*index])
    {
        let Some(skin) = node.skin else { continue };
        let path = format!("nodes[{index}].skin");
        let of_skin = faults.get(&root.skins, "skins", skin, &path)?;
        if std::mem::replace(&mut is_known[skin.value()], true) {
            continue;
        }
        for (place, joint) in of_skin.joints.iter().enumerate() {
            let path = format!("skins[{}].joints[{place}]", skin.value());
            faults.get(&root.nodes, "nodes", *joint, &path)?;
            is_joint[joint.value()] = true;
        }
    }
    // What moves a joint is one too.
    for &node in order.iter().rev() {
        if let Some(parent) = parents[node].filter(|_| is_joint[node]) {
            is_joint[parent] = true;
        }
    }
    Ok(is_joint)
}

/// By node, whether it carries a light of the scene or is above one.
fn leading_to_lights(
    root: &Root,
    parents: &[Option<usize>],
    order: &[usize],
    is_in_scene: &[bool],
) -> Vec<bool> {
    let mut leads = vec![false; root.nodes.len()];
    for &node in order.iter().rev() {
        leads[node] |= is_in_scene[node] && light_of(&root.nodes[node]).is_some();
        if let Some(parent) = parents[node].filter(|_| leads[node]) {
            leads[parent] = true;
        }
    }
    leads
}

fn only_looks_or_lights(node: &Node) -> bool {
    (node.camera.is_some() || light_of(node).is_some()) && node.mesh.is_none()
}
