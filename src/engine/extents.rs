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
    /// Of vertices as they were modelled.
    skin_as_modelled: Option<Bounds>,
    joints: Option<Bounds>,
    /// Of the boxes that files give joints.
    boxes: Option<Bounds>,
}

impl Extents {
    pub(super) fn of(rest: &Posed) -> Self {
        let rig = rest.rig();
        // Those of linear skinning, also for requests with dual quaternions: a camera must not depend on the way of skinning.
        let palette = rest.palette(Skinning::Linear);
        let skinned = rig
            .meshes()
            .iter()
            .flat_map(|mesh| cpu::skin_mesh(mesh, palette, rest.morph_weights()).0)
            .map(|position| Vec3::from_array(position).as_dvec3());
        let modelled = rig.meshes().iter().flat_map(|mesh| mesh.positions());
        let placed = rig.skeleton().joints().iter().zip(rest.world_from_joint());
        let corners = placed.flat_map(|(joint, world_from_joint)| {
            let boxes = joint.bounding_box.into_iter();
            let corners = boxes.flat_map(|[min, max]| Bounds { min, max }.corners());
            corners.map(|corner| world_from_joint.transform_point3(corner))
        });
        Self {
            skin: Bounds::of(skinned),
            skin_as_modelled: Bounds::of(modelled.map(|position| position.as_dvec3())),
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
            ShowSkin::Posed => self.skin,
            ShowSkin::Bind => self.skin_as_modelled,
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
        let shown = [skin, joints, boxes].into_iter().flatten();
        shown
            .reduce(|all, bounds| all.and(&bounds))
            .unwrap_or_else(|| self.bounds())
    }
}
