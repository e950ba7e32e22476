//! How far the vertices of a mesh can go: what is moved by each binding and by each morph target, as boxes and lengths.

use crate::rig::{BindingBounds, Mesh};
use glam::DVec3;
use std::collections::BTreeMap;

/// By binding.
pub(super) fn binding_bounds(mesh: &Mesh) -> Vec<BindingBounds> {
    let mut found: Vec<Option<BindingBounds>> = Vec::new();
    for (vertex, &position) in mesh.positions.iter().enumerate() {
        for influence in mesh.influences_of(vertex) {
            let binding = influence.binding;
            if found.len() <= binding as usize {
                found.resize(binding as usize + 1, None);
            }
            let slot = &mut found[binding as usize];
            let own = slot.get_or_insert(BindingBounds {
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

/// Finds where each part is, and what it follows most.
pub(super) fn place_parts(mesh: &mut Mesh) {
    let mut parts = std::mem::take(&mut mesh.parts);
    for part in &mut parts {
        let corners = mesh.triangles[part.triangles.clone()].as_flattened();
        let mut sum = DVec3::ZERO;
        let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
        for &corner in corners {
            sum += mesh.positions[corner as usize].as_dvec3();
            for influence in mesh.influences_of(corner as usize) {
                *weights.entry(influence.binding).or_default() += f64::from(influence.weight);
            }
        }
        part.center = (sum / corners.len().max(1) as f64).as_vec3();
        let heaviest = weights
            .into_iter()
            .reduce(|a, b| if b.1 > a.1 { b } else { a });
        part.follows = heaviest.map_or(0, |(binding, _)| binding);
    }
    mesh.parts = parts;
}
