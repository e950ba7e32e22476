//! What a ray meets first: bones as solid cylinders, skin as its triangles, all in world space and f64.
//! Never lives here: where rays come from, and what skins and poses.

mod bones;
mod skin;

use crate::frame::SkinnedVertices;
use crate::pose::Posed;
use crate::scene::{BoneRadius, Cull, Ray, Shape};
use glam::DVec3;

/// What a ray may meet; what is `None` is not asked for.
#[derive(Debug, Clone, Copy, Default)]
pub struct Targets<'a> {
    /// Bones to meet.
    pub bones: Option<Bones<'a>>,
    /// Skin to meet.
    pub skin: Option<Skin<'a>>,
}

/// The bones of a pose: cylinders from joint to child, closed by flat discs.
#[derive(Debug, Clone, Copy)]
pub struct Bones<'a> {
    /// Whose joints they connect, in world space.
    pub posed: &'a Posed,
    /// Of all of them; `None` leaves each as thick as it is drawn.
    pub radius: Option<BoneRadius>,
}

/// The triangles of a rig, its vertices where a renderer put them.
#[derive(Debug, Clone, Copy)]
pub struct Skin<'a> {
    /// The rig in its pose, which may turn the sides of its triangles over.
    pub posed: &'a Posed,
    /// Which form of the skin `meshes` holds: in its pose, or as it was modelled.
    pub shape: Shape,
    /// Whether the backs of single-sided materials are met as well.
    pub cull: Cull,
    /// Of the rig, which says what is single-sided.
    pub variant: Option<usize>,
    /// All vertices of each mesh of the rig, in its order. Where positions are left out there is nothing to meet; where normals are,
    /// triangles count as flat.
    pub meshes: &'a [SkinnedVertices],
}

/// The nearest thing that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// From the ray's origin, in the rig's units.
    pub distance: f64,
    /// In world space.
    pub position: DVec3,
    /// Which bone, or which place of the skin.
    pub what: What,
}

/// What a ray met, and where on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum What {
    /// A bone, on its wall or on one of its discs.
    Bone {
        /// The joint that turns the bone.
        joint: usize,
        /// The joint that the bone leads to.
        child: usize,
        /// How far along it, 0 at `joint` and 1 at `child`.
        along: f64,
    },
    /// A triangle of a mesh.
    Skin {
        /// Index into [`Rig::meshes`](crate::rig::Rig::meshes).
        mesh: usize,
        /// Index into [`Mesh::triangles`](crate::rig::Mesh::triangles).
        triangle: usize,
        /// Shares of the triangle's corners in the file's order; their sum is 1.
        barycentric: [f64; 3],
        /// Unit length, interpolated between the corners; it stands on the side of the triangle that the ray comes from.
        normal: DVec3,
        /// The joint that weighs most here, of equal ones the first; `None` where the skin follows no joint.
        joint: Option<usize>,
    },
}

/// The nearest of what is asked for, between [`Ray::from`] and [`Ray::to`]. Everything but single-sided skin has two
/// sides: from inside, the far wall is met. At
/// the same distance skin comes before bones, and among bones or triangles the first in the rig's order.
pub fn pick(ray: &Ray, targets: &Targets) -> Option<Hit> {
    let skin = targets.skin.and_then(|skin| skin::nearest(ray, skin));
    let bone = targets.bones.and_then(|bones| bones::nearest(ray, bones));
    skin.into_iter().chain(bone).reduce(nearer)
}

fn nearer(first: Hit, second: Hit) -> Hit {
    if second.distance < first.distance {
        second
    } else {
        first
    }
}

#[cfg(test)]
mod tests;
