//! Which sides of each part of a mesh there are to be seen, and its draw triangles sorted by them.
//! Never lives here: whether a surface encloses anything.

use super::closed;
use crate::rig::{Material, Mesh, Opacity, Sides};

/// `mesh` has its draw triangles in the order of the file's. Of a part there is one order for all variants: where it is single-sided in
/// one, it is sorted for that one, and shows both sides in others.
pub(super) fn sort(mesh: &mut Mesh, materials: &[Material]) {
    let material_of = |material: Option<usize>| material.map(|material| &materials[material]);
    let is_single_sided =
        |material| material_of(material).is_some_and(|material| material.is_single_sided);
    let is_opaque = |material| material_of(material).is_none_or(|it| it.opacity == Opacity::Opaque);
    // What is seen through a hole in it is its inside.
    let all_are_opaque = mesh
        .parts
        .iter()
        .all(|part| part.materials().all(is_opaque));
    let are_outward = if all_are_opaque {
        closed::are_outward(mesh)
    } else {
        None
    };
    let mut parts = std::mem::take(&mut mesh.parts);
    for part in &mut parts {
        let own = part.triangles.clone();
        if part.materials().any(is_single_sided) {
            let file = &mesh.triangles[own.clone()];
            let as_in_file = file.iter().zip(&mesh.draw_triangles[own.clone()]);
            let is_front: Vec<bool> = as_in_file.map(|(file, draw)| file == draw).collect();
            let count = first_those(&mut mesh.draw_triangles[own], &is_front);
            part.set_sides(|material| match is_single_sided(material) {
                true => Sides::Front { count },
                false => Sides::Both,
            });
        } else if let Some(are_outward) = &are_outward {
            let count = first_those(&mut mesh.draw_triangles[own.clone()], &are_outward[own]);
            part.set_sides(|_| Sides::Outside { count });
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
