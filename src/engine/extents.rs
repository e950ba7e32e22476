//! How far a rig reaches at rest, apart for its skin and its skeleton: what a camera frames. Never lives here: cameras.

use crate::pose::{Posed, Skinning};
use crate::render::cpu;
use crate::scene::{Bounds, Show, ShowSkeleton, ShowSkin};
use glam::Vec3;

/// Boxes in the rig's own space, at rest; `None` of what the rig does not have.
#[derive(Debug)]
pub struct Extents {
    /// Of skinned vertices.
    skin: Option<Bounds>,
    /// Of those that triangles have: the others cannot be seen.
    drawn: Option<Bounds>,
    /// Of the same as they were modelled.
    drawn_as_modelled: Option<Bounds>,
    joints: Option<Bounds>,
    /// Of the boxes that files give joints.
    boxes: Option<Bounds>,
}

impl Extents {
    pub(super) fn of(rest: &Posed) -> Self {
        let rig = rest.rig();
        // Those of linear skinning, also for requests with dual quaternions: a camera must not depend on the way of skinning.
        let palette = rest.palette(Skinning::Linear);
        let (mut skin, mut drawn, mut drawn_as_modelled) = (None, None, None);
        for mesh in rig.meshes() {
            let (skinned_positions, _) = cpu::skin_mesh(mesh, palette, rest.morph_weights());
            let skinned = |vertex: usize| Vec3::from_array(skinned_positions[vertex]).as_dvec3();
            let modelled = |vertex: usize| mesh.positions()[vertex].as_dvec3();
            let corners = || {
                mesh.triangles()
                    .as_flattened()
                    .iter()
                    .map(|&it| it as usize)
            };
            let positions = skinned_positions.as_flattened();
            skin = joined(skin, Bounds::of_positions(positions));
            drawn = joined(drawn, Bounds::of(corners().map(skinned)));
            drawn_as_modelled = joined(drawn_as_modelled, Bounds::of(corners().map(modelled)));
        }
        let placed = rig.skeleton().joints().iter().zip(rest.world_from_joint());
        let corners = placed.flat_map(|(joint, world_from_joint)| {
            let boxes = joint.bounding_box.into_iter();
            let corners = boxes.flat_map(|[min, max]| Bounds { min, max }.corners());
            corners.map(|corner| world_from_joint.transform_point3(corner))
        });
        Self {
            skin,
            drawn,
            drawn_as_modelled,
            joints: Bounds::of(
                rest.world_from_joint()
                    .iter()
                    .map(|joint| joint.translation),
            ),
            boxes: Bounds::of(corners),
        }
    }

    /// Of skinned vertices.
    pub fn skin(&self) -> Option<Bounds> {
        self.skin
    }

    /// Of the origins of all joints, also of those that move nothing.
    pub fn joints(&self) -> Option<Bounds> {
        self.joints
    }

    /// Of the skin, else of the joints: joints that move nothing, like the node of a camera, say nothing of how large a character is.
    pub fn bounds(&self) -> Bounds {
        self.skin.or(self.joints).unwrap_or(Bounds::ORIGIN)
    }

    /// What the default camera frames, whatever the pose: what is shown of the rig.
    pub fn framed(&self, show: &Show) -> Bounds {
        let skin = match show.skin {
            ShowSkin::Posed => self.drawn,
            ShowSkin::Bind => self.drawn_as_modelled,
            ShowSkin::None => None,
        };
        // Without a skin the skeleton is drawn whatever is asked for, and its boxes give a single joint a size.
        let is_bare = self.skin.is_none();
        let joints = self
            .joints
            .filter(|_| is_bare || show.skeleton != ShowSkeleton::None);
        let boxes = self
            .boxes
            .filter(|_| is_bare || show.skeleton == ShowSkeleton::Boxes);
        joined(joined(skin, joints), boxes).unwrap_or_else(|| self.bounds())
    }
}

fn joined(one: Option<Bounds>, other: Option<Bounds>) -> Option<Bounds> {
    one.into_iter()
        .chain(other)
        .reduce(|all, bounds| all.and(&bounds))
}
