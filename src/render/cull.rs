//! Which side of a mesh is not drawn: the back of a single-sided material, and what cannot be seen of a closed and opaque mesh which lies
//! wholly before the camera, seen from outside. Leaving that out saves half of the work and changes no picture, but where a pose turns
//! skin inside out.

use super::Instance;
use crate::pose::Palette;
use crate::rig::{Mesh, Part, Sides};
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

/// Draw triangles of one part of a mesh that are drawn alike.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub triangles: Range<usize>,
    /// Those seen from this side are left out.
    pub culled: Option<Side>,
}

/// What can be left out of a mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Culling {
    is_asked_for: bool,
    is_mirrored: bool,
    hides_its_inside: bool,
    /// Of the rig, which says what parts are made of.
    variant: Option<usize>,
}

impl Culling {
    /// `bounds` are those of the mesh's posed vertices, or larger; `None` where they are not known.
    pub fn of(instance: &Instance, mesh: &Mesh, scene: &Scene, bounds: Option<Bounds>) -> Self {
        let is_mirrored = instance.mirrors(mesh);
        let is_seen_from_outside = bounds.is_some_and(|bounds| is_ahead(&bounds, &scene.camera));
        let is_opaque = scene.show.skin_opacity() == 1.0;
        Self {
            is_asked_for: scene.cull == Cull::Auto,
            is_mirrored,
            hides_its_inside: is_opaque && is_seen_from_outside && !is_mirrored,
            variant: scene.surface.variant,
        }
    }

    /// All draw triangles of a part of the mesh, with the side of them that can be left out.
    pub fn pieces(self, part: &Part) -> impl Iterator<Item = Piece> + use<> {
        let Range { start, end } = part.triangles;
        let piece = |triangles, culled| Piece { triangles, culled };
        let halves = match part.look(self.variant).sides {
            Sides::Outside { count } if self.is_asked_for && self.hides_its_inside => [
                piece(start..start + count, Some(Side::Back)),
                piece(start + count..end, Some(Side::Front)),
            ],
            Sides::Front { count } if self.is_asked_for => {
                let (first, second) = if self.is_mirrored {
                    (Side::Front, Side::Back)
                } else {
                    (Side::Back, Side::Front)
                };
                [
                    piece(start..start + count, Some(first)),
                    piece(start + count..end, Some(second)),
                ]
            }
            Sides::Both | Sides::Outside { .. } | Sides::Front { .. } => {
                [piece(start..end, None), piece(end..end, None)]
            }
        };
        let halves = halves.into_iter();
        halves.filter(|piece| !piece.triangles.is_empty())
    }
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
