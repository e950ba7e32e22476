//! Which sides of each part of a mesh there are to be seen, and its draw triangles sorted by them.
//! Never lives here: whether a surface encloses anything.

use super::closed;
use crate::rig::{Material, Mesh, Opacity, Part, Sides};

/// `mesh` has its draw triangles in the order of the file's.
pub(super) fn sort(mesh: &mut Mesh, materials: &[Material]) {
    let material_of = |part: &Part| part.material.map(|material| &materials[material]);
    let is_opaque = |part: &Part| material_of(part).is_none_or(|it| it.opacity == Opacity::Opaque);
    // What is seen through a hole in it is its inside.
    let are_outward = if mesh.parts.iter().all(is_opaque) {
        closed::are_outward(mesh)
    } else {
        None
    };
    let mut parts = std::mem::take(&mut mesh.parts);
    for part in &mut parts {
        let own = part.triangles.clone();
        if material_of(part).is_some_and(|material| material.is_single_sided) {
            let file = &mesh.triangles[own.clone()];
            let as_in_file = file.iter().zip(&mesh.draw_triangles[own.clone()]);
            let is_front: Vec<bool> = as_in_file.map(|(file, draw)| file == draw).collect();
            let count = first_those(&mut mesh.draw_triangles[own], &is_front);
            part.sides = Sides::Front { count };
        } else if let Some(are_outward) = &are_outward {
            let count = first_those(&mut mesh.draw_triangles[own.clone()], &are_outward[own]);
            part.sides = Sides::Outside { count };
        }
    }
    mesh.parts = parts;
}

/// Puts those first of which it is so, in their order, and says how many they are.
fn first_those(triangles: &mut [[u32; 3]], is_so: &[bool]) -> usize {
    let mut sorted = Vec::with_capacity(triangles.len());
    for wanted in [true, false] {
        let own = triangles.iter().zip(is_so);
        sorted.extend(own.filter(|(_, is)| **is == wanted).map(|(it, _)| *it));
    }
    triangles.copy_from_slice(&sorted);
    is_so.iter().filter(|is| **is).count()
}
