//! What the vertices of a primitive follow. Never lives here: skins as bindings.

use super::accessors::Wanted;
use super::attributes::VertexReader;
use super::fault::Faults;
use crate::formats::error::LoadError;
use crate::rig::MeshDraft;
use gltf_json::Index;
use gltf_json::accessor::ComponentType::{F32, U8, U16};
use gltf_json::accessor::{Accessor, Type};
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use std::iter::repeat_n;

const JOINTS: Wanted = Wanted {
    types: &[Type::Vec4],
    components: &[U8, U16],
    expected: "VEC4 of U8 or U16",
    normalizes: false,
};
const WEIGHTS: Wanted = Wanted {
    types: &[Type::Vec4],
    components: &[F32, U8, U16],
    expected: "VEC4 of F32, or of normalized U8 or U16",
    normalizes: true,
};

/// What a mesh is bound to.
pub(super) enum Bound {
    /// Wholly to one binding.
    Rigid(u32),
    /// By influences that name bindings of a skin.
    Skin(Vec<u32>),
}

/// `JOINTS_n` and `WEIGHTS_n` of one n.
struct Set {
    number: u32,
    joints: Index<Accessor>,
    weights: Index<Accessor>,
}

/// Adds those of all vertices of a primitive to its mesh. `hold` holds how many there will be against their ceiling.
pub(super) fn add(
    mesh: &mut MeshDraft,
    primitive: &Primitive,
    read: &VertexReader<'_>,
    bound: &Bound,
    hold: impl FnOnce(usize) -> Result<(), LoadError>,
) -> Result<(), LoadError> {
    let faults = read.accessors.faults;
    let bindings = match bound {
        Bound::Rigid(binding) => {
            hold(read.count)?;
            mesh.influence_counts.extend(repeat_n(1, read.count));
            mesh.influences
                .extend(repeat_n((*binding, 1.0), read.count));
            return Ok(());
        }
        Bound::Skin(bindings) => bindings,
    };
    let sets = sets(faults, primitive, read.path)?;
    hold(4 * sets.len() * read.count)?;
    let mut of_sets = Vec::with_capacity(sets.len());
    for set in sets {
        let number = set.number;
        let joints = read.integers(set.joints, &format!("JOINTS_{number}"), JOINTS)?;
        let weights = read.vectors::<4>(set.weights, &format!("WEIGHTS_{number}"), WEIGHTS)?;
        of_sets.push((number, joints, weights));
    }
    for vertex in 0..read.count {
        let before = mesh.influences.len();
        for (number, joints, weights) in &of_sets {
            for (&joint, &weight) in joints[4 * vertex..][..4].iter().zip(&weights[vertex]) {
                // A joint that nothing follows may be any.
                if weight == 0.0 {
                    continue;
                }
                let Some(&binding) = bindings.get(joint as usize) else {
                    let path = format!("{}.attributes.JOINTS_{number}, vertex {vertex}", read.path);
                    let expected = format!("one of the {} joints of the skin", bindings.len());
                    return Err(faults.load(&path, expected, joint.to_string()));
                };
                mesh.influences.push((binding, f64::from(weight)));
            }
        }
        mesh.influence_counts
            .push((mesh.influences.len() - before) as u32);
    }
    Ok(())
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
