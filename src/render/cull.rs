//! Which side of a mesh cannot be seen: that of a closed and opaque one which lies wholly before the camera, seen from outside.
//! Leaving it out saves half of the work and changes no picture, but where a pose turns skin inside out.

use super::Instance;
use crate::pose::Palette;
use crate::rig::Mesh;
use crate::scene::{Bounds, Camera, Cull, Scene};
use glam::{DVec3, DVec4};
use std::ops::Range;

/// Of a triangle, as its corners run around on the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Side {
    /// Counter-clockwise.
    Front,
    Back,
}

/// Draw triangles that are drawn alike.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Part {
    pub triangles: Range<usize>,
    /// Those seen from this side are left out.
    pub culled: Option<Side>,
}

/// All draw triangles of `mesh`, with the side of them that can be left out. `bounds` are those of its posed vertices, or larger; `None`
/// where they are not known.
pub(super) fn parts(
    instance: &Instance,
    mesh: &Mesh,
    scene: &Scene,
    bounds: Option<Bounds>,
) -> impl Iterator<Item = Part> + use<> {
    let all = mesh.draw_triangles().len();
    let may_cull = scene.cull == Cull::Auto && scene.show.skin_opacity() == 1.0;
    let outward_count = mesh.outward_count().filter(|_| {
        let is_seen_from_outside = bounds.is_some_and(|bounds| is_ahead(&bounds, &scene.camera));
        may_cull && is_seen_from_outside && !is_mirrored(instance, mesh)
    });
    let part = |triangles, culled| Part { triangles, culled };
    let parts = match outward_count {
        None => [part(0..all, None), part(all..all, None)],
        Some(outward) => [
            part(0..outward, Some(Side::Back)),
            part(outward..all, Some(Side::Front)),
        ],
    };
    parts.into_iter().filter(|part| !part.triangles.is_empty())
}

/// Wholly beyond the near plane, and so before the eye.
fn is_ahead(bounds: &Bounds, camera: &Camera) -> bool {
    let clip_from_world = camera.clip_from_world();
    bounds.corners().all(|corner| {
        let DVec4 { z, w, .. } = clip_from_world * corner.extend(1.0);
        // Not so for what is no number either.
        z < w
    })
}

/// A box that no vertex of `mesh` leaves, found without skinning one: what follows a binding lies in its box, and where a vertex follows
/// several it lies between. `None` for ways of skinning of which that is not so.
pub(super) fn reach(instance: &Instance, mesh: &Mesh) -> Option<Bounds> {
    let Palette::Linear(palette) = instance.palette() else {
        return None;
    };
    if mesh.has_negative_weights() {
        return None;
    }
    let morphed = mesh
        .morph_reach()
        .iter()
        .map(|&(morph, furthest)| f64::from(instance.morph_weights()[morph].abs() * furthest))
        .sum();
    let followers = mesh.followers().iter().map(|followers| {
        let rows = palette[followers.binding as usize].rows;
        let margin = DVec3::splat(morphed);
        let in_bind = Bounds {
            min: followers.min.as_dvec3() - margin,
            max: followers.max.as_dvec3() + margin,
        };
        let moved = in_bind.corners().map(move |corner| {
            let corner = corner.extend(1.0);
            DVec3::from_array(rows.map(|row| row.as_dvec4().dot(corner)))
        });
        Bounds::of(moved)
    });
    let bounds = followers.flatten().reduce(|a, b| a.and(&b))?;
    // Sums of numbers of 32 bits end up a little outside.
    let margin = DVec3::splat(1e-4 * bounds.size());
    Some(Bounds {
        min: bounds.min - margin,
        max: bounds.max + margin,
    })
}

/// Whether anything that the mesh follows turns left into right, and so inside into outside.
fn is_mirrored(instance: &Instance, mesh: &Mesh) -> bool {
    let mut followed = mesh.followers().iter();
    followed.any(|followers| {
        let binding = followers.binding as usize;
        let rows = match instance.palette() {
            Palette::Linear(palette) => palette[binding].rows,
            Palette::DualQuaternion(palette) => palette[binding].stretch,
        };
        let [x, y, z] = rows.map(|row| row.truncate().as_dvec3());
        // What is flat has no inside.
        x.dot(y.cross(z)) <= 0.0
    })
}
