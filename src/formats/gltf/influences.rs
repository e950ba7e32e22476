//! What the vertices of a primitive follow. Never lives here: skins as bindings.

use super::accessors::Requirement;
use super::attributes::VertexReader;
use super::fault::Faults;
use crate::formats::error::LoadError;
use crate::rig::{MeshDraft, Warnings};
use gltf_json::Index;
use gltf_json::accessor::ComponentType::{F32, U8, U16};
use gltf_json::accessor::{Accessor, Type};
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use std::iter::repeat_n;

const JOINTS: Requirement = Requirement {
    types: &[Type::Vec4],
    components: &[U8, U16],
    expected: "VEC4 of U8 or U16",
    normalizes: false,
};
const WEIGHTS: Requirement = Requirement {
    types: &[Type::Vec4],
    components: &[F32, U8, U16],
    expected: "VEC4 of F32, or of normalized U8 or U16",
    normalizes: true,
};

/// What a mesh is bound to.
pub(super) struct Bound {
    /// Of the mesh's node. What has no weights follows it.
    pub joint: usize,
    /// The bindings of the node's skin, by joint of the skin.
    pub skin: Option<Vec<u32>>,
}

/// How many vertices of a primitive have influences that the specification does not allow.
#[derive(Debug, Default)]
pub(super) struct Violations {
    without_skin: usize,
    without: usize,
    negative: usize,
    repeated: usize,
    beyond: usize,
}

/// `JOINTS_n` and `WEIGHTS_n` of one n.
struct Set {
    number: u32,
    joints: Index<Accessor>,
    weights: Index<Accessor>,
}

/// Adds those of all vertices of a primitive to its mesh. A vertex without weights follows the mesh's node, whose binding `of_node` gives.
/// `check_limit` checks how many influences there will be.
pub(super) fn add(
    mesh: &mut MeshDraft,
    primitive: &Primitive,
    read: &VertexReader<'_>,
    bound: &Bound,
    mut of_node: impl FnMut() -> u32,
    check_limit: impl FnOnce(usize) -> Result<(), LoadError>,
) -> Result<Violations, LoadError> {
    let faults = read.accessors.faults;
    let mut violations = Violations::default();
    let sets = sets(faults, primitive, read.path)?;
    let bindings = match &bound.skin {
        Some(bindings) if !sets.is_empty() => bindings,
        skin => {
            check_limit(read.count)?;
            mesh.influence_counts.extend(repeat_n(1, read.count));
            let whole = (of_node(), 1.0);
            mesh.influences.extend(repeat_n(whole, read.count));
            match skin {
                Some(_) => violations.without = read.count,
                None if sets.is_empty() => {}
                None => violations.without_skin = read.count,
            }
            return Ok(violations);
        }
    };
    check_limit(4 * sets.len() * read.count)?;
    let sets = sets
        .iter()
        .map(|set| set.read(read))
        .collect::<Result<Vec<_>, _>>()?;
    // By joint of the skin, the last vertex that named it.
    let mut named_by = vec![usize::MAX; bindings.len()];
    for vertex in 0..read.count {
        let before = mesh.influences.len();
        let mut sum = 0.0;
        let (mut is_negative, mut is_repeated, mut is_beyond) = (false, false, false);
        for (number, joint, weight) in sets.iter().flat_map(|set| set.of_vertex(vertex)) {
            // A joint that nothing follows may be any.
            if weight == 0.0 {
                is_beyond |= joint >= bindings.len();
                continue;
            }
            let Some(&binding) = bindings.get(joint) else {
                let path = format!("{}.attributes.JOINTS_{number}, vertex {vertex}", read.path);
                let expected = format!("one of the {} joints of the skin", bindings.len());
                return Err(faults.load(&path, expected, joint.to_string()));
            };
            is_negative |= weight < 0.0;
            is_repeated |= std::mem::replace(&mut named_by[joint], vertex) == vertex;
            sum += f64::from(weight);
            mesh.influences.push((binding, f64::from(weight)));
        }
        if sum <= 0.0 {
            mesh.influences.truncate(before);
            mesh.influences.push((of_node(), 1.0));
        }
        violations.without += usize::from(sum <= 0.0);
        violations.negative += usize::from(is_negative);
        violations.repeated += usize::from(is_repeated);
        violations.beyond += usize::from(is_beyond);
        mesh.influence_counts
            .push((mesh.influences.len() - before) as u32);
    }
    Ok(violations)
}

/// The numbers of a [`Set`], of all vertices.
struct ReadSet {
    number: u32,
    joints: Vec<u32>,
    weights: Vec<[f32; 4]>,
}

impl Set {
    fn read(&self, read: &VertexReader<'_>) -> Result<ReadSet, LoadError> {
        let number = self.number;
        Ok(ReadSet {
            number,
            joints: read.integers(self.joints, &format!("JOINTS_{number}"), JOINTS)?,
            weights: read.vectors(self.weights, &format!("WEIGHTS_{number}"), WEIGHTS)?,
        })
    }
}

impl ReadSet {
    /// The set's number, a joint of the skin and its weight, four of each.
    fn of_vertex(&self, vertex: usize) -> impl Iterator<Item = (u32, usize, f32)> {
        let joints = self.joints[4 * vertex..][..4].iter();
        let weights = self.weights[vertex];
        let pairs = joints.zip(weights);
        pairs.map(|(&joint, weight)| (self.number, joint as usize, weight))
    }
}

impl Violations {
    /// A warning each, of the primitive at `path`.
    pub(super) fn warn(self, faults: Faults<'_>, path: &str, warnings: &mut Warnings) {
        for (count, what) in [
            (
                self.without_skin,
                "have joints and weights, but no skin, and follow the mesh's node",
            ),
            (
                self.without,
                "have no weights with a positive sum and follow the mesh's node",
            ),
            (self.negative, "have a negative weight"),
            (self.repeated, "name a joint twice"),
            (
                self.beyond,
                "name a joint that the skin does not have, with a weight of 0",
            ),
        ] {
            if count > 0 {
                warnings.push(|| faults.warning(&format!("{path}: {count} vertices {what}")));
            }
        }
    }
}

/// `JOINTS_n` and `WEIGHTS_n` of each n that there is.
fn sets(faults: Faults<'_>, primitive: &Primitive, path: &str) -> Result<Vec<Set>, LoadError> {
    let mut sets = Vec::new();
    for semantic in primitive.attributes.keys() {
        let set = match semantic {
            Checked::Valid(Semantic::Joints(set) | Semantic::Weights(set)) => *set,
            _ => continue,
        };
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic));
        match [
            attribute(Semantic::Joints(set)),
            attribute(Semantic::Weights(set)),
        ] {
            [Some(&joints), Some(&weights)] => sets.push(Set {
                number: set,
                joints,
                weights,
            }),
            [joints, _] => {
                let [there, missing] = if joints.is_some() {
                    ["JOINTS", "WEIGHTS"]
                } else {
                    ["WEIGHTS", "JOINTS"]
                };
                let path = format!("{path}.attributes");
                let expected = format!("a {missing}_{set} beside {there}_{set}");
                return Err(faults.load(&path, expected, "none"));
            }
        }
    }
    sets.sort_unstable_by_key(|set| set.number);
    sets.dedup_by_key(|set| set.number);
    Ok(sets)
}
