//! Which side of a mesh is not drawn: the back of a single-sided material, and what cannot be seen of a closed and opaque mesh which lies
//! wholly before the camera, seen from outside. Leaving that out saves half of the work and changes no picture, but where a pose turns
//! skin inside out.

use super::{Instance, Skin};
use crate::pose::Palette;
use crate::rig::{Mesh, Part, Sides};
use crate::scene::{Bounds, Camera, Cull};
use glam::{DMat4, DVec3, DVec4};
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
    hides_its_inside: bool,
    /// Whether the side of a triangle is the other one in the world than in the file.
    is_turned_over: bool,
    /// Whether the instance's transform is what turns it over.
    is_mirrored: bool,
    /// Of the rig, which says what parts are made of.
    variant: Option<usize>,
}

impl Culling {
    /// `bounds` are those of the mesh's posed vertices in model space, or larger; `None` where they are not known.
    pub(super) fn of(
        instance: &Instance,
        mesh: &Mesh,
        camera: &Camera,
        bounds: Option<Bounds>,
    ) -> Self {
        let appearance = instance.appearance();
        let clip_from_model = instance.clip_from_model(camera.clip_from_world());
        let is_seen_from_outside = bounds.is_some_and(|bounds| is_ahead(&bounds, clip_from_model));
        let is_opaque = !instance.is_translucent();
        let skin_mirrors = instance.skin().mirrors(mesh);
        let is_mirrored = instance.world_from_model().matrix3.determinant() < 0.0;
        Self {
            is_asked_for: appearance.cull == Cull::Auto,
            hides_its_inside: is_opaque && is_seen_from_outside && !skin_mirrors,
            is_turned_over: skin_mirrors != is_mirrored,
            is_mirrored,
            variant: appearance.surface.variant,
        }
    }

    /// All draw triangles of a part of the mesh, with the side of them that can be left out.
    pub(super) fn pieces(self, part: &Part) -> impl Iterator<Item = Piece> + use<> {
        let Range { start, end } = part.triangles;
        let piece = |triangles, culled| Piece { triangles, culled };
        let backs_of = |count, is_turned_over| {
            let (first, second) = if is_turned_over {
                (Side::Front, Side::Back)
            } else {
                (Side::Back, Side::Front)
            };
            [
                piece(start..start + count, Some(first)),
                piece(start + count..end, Some(second)),
            ]
        };
        let halves = match part.look(self.variant).sides {
            Sides::Outside { count } if self.is_asked_for && self.hides_its_inside => {
                backs_of(count, self.is_mirrored)
            }
            Sides::Front { count } if self.is_asked_for => backs_of(count, self.is_turned_over),
            Sides::Both | Sides::Outside { .. } | Sides::Front { .. } => {
                [piece(start..end, None), piece(end..end, None)]
            }
        };
        let halves = halves.into_iter();
        halves.filter(|piece| !piece.triangles.is_empty())
    }
}

/// Wholly beyond the near plane, and so before the eye.
fn is_ahead(bounds: &Bounds, clip_from_model: DMat4) -> bool {
    bounds.corners().all(|corner| {
        let DVec4 { z, w, .. } = clip_from_model * corner.extend(1.0);
        // Not so for what is no number either.
        z < w
    })
}

/// A box in model space that no vertex of `mesh` leaves, found without skinning one: what follows a binding lies in its box, and where a vertex follows
/// several it lies between. `None` for ways of skinning of which that is not so.
pub(super) fn reach(skin: &Skin, mesh: &Mesh) -> Option<Bounds> {
    let Palette::Linear(palette) = skin.palette() else {
        return None;
    };
    if mesh.has_negative_weights() {
        return None;
    }
    let morphed = mesh
        .morph_reach()
        .iter()
        .map(|&(morph, furthest)| f64::from(skin.morph_weights()[morph].abs() * furthest))
        .sum();
    let boxes = mesh.binding_bounds().iter().map(|of_binding| {
        let rows = palette[of_binding.binding as usize].rows;
        let margin = DVec3::splat(morphed);
        let in_bind = Bounds {
            min: of_binding.min.as_dvec3() - margin,
            max: of_binding.max.as_dvec3() + margin,
        };
        let moved = in_bind.corners().map(move |corner| {
            let corner = corner.extend(1.0);
            DVec3::from_array(rows.map(|row| row.as_dvec4().dot(corner)))
        });
        Bounds::of(moved)
    });
    let bounds = boxes.flatten().reduce(|a, b| a.and(&b))?;
    // Sums of numbers of 32 bits end up a little outside.
    let margin = DVec3::splat(1e-4 * bounds.size());
    Some(Bounds {
        min: bounds.min - margin,
        max: bounds.max + margin,
    })
}
