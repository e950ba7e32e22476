//! How far the vertices of a mesh can go: what is moved by each binding and by each morph target, as boxes and lengths.

use crate::rig::{Followers, Mesh};
use std::collections::BTreeMap;

/// By binding.
pub(super) fn followers(mesh: &Mesh) -> Vec<Followers> {
    let mut found: Vec<Option<Followers>> = Vec::new();
    for (vertex, &position) in mesh.positions.iter().enumerate() {
        for influence in mesh.influences_of(vertex) {
            let binding = influence.binding;
            if found.len() <= binding as usize {
                found.resize(binding as usize + 1, None);
            }
            let slot = &mut found[binding as usize];
            let own = slot.get_or_insert(Followers {
                binding,
                min: position,
                max: position,
            });
            own.min = own.min.min(position);
            own.max = own.max.max(position);
        }
    }
    found.into_iter().flatten().collect()
}

/// By morph target, how far it moves a vertex at the most.
pub(super) fn of_morphs(mesh: &Mesh) -> Vec<(usize, f32)> {
    let mut found: BTreeMap<usize, f32> = BTreeMap::new();
    for moved in &mesh.morph_displacements {
        let furthest = found.entry(moved.morph as usize).or_default();
        *furthest = furthest.max(moved.position.length());
    }
    found.into_iter().collect()
}
