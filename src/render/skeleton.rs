//! Views of the skeleton as plain shapes in world space, which both renderers draw. Sizes come from the rig where its files give none.
//! Never lives here: pixels.

use super::solids::{Solid, SolidShape, Solids};
use crate::pose::{Bone, Posed};
use crate::scene::ShowSkeleton;
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// What one view of a skeleton consists of.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SkeletonView {
    pub lines: Vec<Segment>,
    /// Each shape at most once.
    pub solids: Vec<Solids>,
}

/// A line of constant width in pixels, its ends round enough to be a dot where they coincide.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Segment {
    pub from_in_world: Vec3,
    pub width_pixels: f32,
    pub to_in_world: Vec3,
    /// Linear RGB.
    pub color: Vec3,
}

/// Wide enough to be seen in a 128-pixel thumbnail, thin enough to show a finger.
const BONE_WIDTH_PIXELS: f32 = 2.0;
const JOINT_DOT_PIXELS: f32 = 5.0;
const LINE_COLOR: Vec3 = Vec3::new(0.85, 0.72, 0.30);
const DOT_COLOR: Vec3 = Vec3::new(0.95, 0.33, 0.15);
/// Solids are lit, so their colors leave room for light.
const BONE_COLOR: Vec3 = Vec3::new(0.60, 0.48, 0.20);
const BALL_COLOR: Vec3 = Vec3::new(0.68, 0.20, 0.09);
const BOX_COLOR: Vec3 = Vec3::new(0.16, 0.34, 0.55);
/// A ball stands out from the bones that meet in it.
const BALL_RADII: f64 = 1.4;
/// Where a format knows of no box, half the side of one, in ball radii: the ball just fits in.
const BOX_RADII: f64 = 1.0;

/// `rig_size` is that of the rest bounds, for joints that have no bone to be measured by.
pub(super) fn view(posed: &Posed, how: ShowSkeleton, rig_size: f64) -> SkeletonView {
    let solids = |solids: Vec<Solids>| SkeletonView {
        lines: Vec::new(),
        solids,
    };
    match how {
        ShowSkeleton::None => SkeletonView::default(),
        ShowSkeleton::Wireframe => SkeletonView {
            lines: wireframe(posed),
            solids: Vec::new(),
        },
        ShowSkeleton::Boxes => solids(vec![boxes(posed, rig_size)]),
        ShowSkeleton::Sticks => {
            let sticks = along_bones(posed, SolidShape::Taper);
            solids(vec![balls(posed, rig_size), sticks])
        }
        ShowSkeleton::Cylinders => solids(vec![along_bones(posed, SolidShape::Cylinder)]),
    }
}

/// A line along each bone, then a dot at each joint, so that a skeleton of one joint shows too.
fn wireframe(posed: &Posed) -> Vec<Segment> {
    let bones = posed.bones().map(|bone| Segment {
        from_in_world: bone.from.as_vec3(),
        to_in_world: bone.to.as_vec3(),
        width_pixels: BONE_WIDTH_PIXELS,
        color: LINE_COLOR,
    });
    let dots = posed.world_from_joint().iter().map(|world_from_joint| {
        let at = world_from_joint.translation.as_vec3();
        Segment {
            from_in_world: at,
            to_in_world: at,
            width_pixels: JOINT_DOT_PIXELS,
            color: DOT_COLOR,
        }
    });
    bones.chain(dots).collect()
}

fn boxes(posed: &Posed, rig_size: f64) -> Solids {
    let radii = ball_radii(posed, rig_size);
    let joints = posed.rig().skeleton().joints().iter().zip(radii);
    let placed = joints.zip(posed.world_from_joint());
    let instances = placed.map(|((joint, radius), world_from_joint)| {
        let half = DVec3::splat(BOX_RADII * radius);
        let [min, max] = joint.bounding_box.unwrap_or([-half, half]);
        let joint_from_box = DAffine3::from_mat3_translation(
            DMat3::from_diagonal((max - min) / 2.0),
            (min + max) / 2.0,
        );
        Solid::new(*world_from_joint * joint_from_box, BOX_COLOR)
    });
    Solids {
        shape: SolidShape::Box,
        instances: instances.collect(),
    }
}

fn balls(posed: &Posed, rig_size: f64) -> Solids {
    let radii = ball_radii(posed, rig_size);
    let placed = posed.world_from_joint().iter().zip(radii);
    let instances = placed.map(|(world_from_joint, radius)| {
        let sized = DMat3::from_diagonal(DVec3::splat(radius));
        let at = world_from_joint.translation;
        Solid::new(DAffine3::from_mat3_translation(sized, at), BALL_COLOR)
    });
    Solids {
        shape: SolidShape::Ball,
        instances: instances.collect(),
    }
}

/// Of each joint: as the thickest bone that meets in it asks for.
fn ball_radii(posed: &Posed, rig_size: f64) -> Vec<f64> {
    /// Of the rig's size, where no bone meets.
    const ALONE: f64 = 0.05;
    let mut thickest = vec![0.0f64; posed.world_from_joint().len()];
    for bone in posed.bones() {
        for joint in [bone.owner, bone.child] {
            thickest[joint] = thickest[joint].max(bone.radius);
        }
    }
    let alone = ALONE * if rig_size > 0.0 { rig_size } else { 1.0 };
    let radius = |thickest: f64| {
        if thickest > 0.0 {
            BALL_RADII * thickest
        } else {
            alone
        }
    };
    thickest.into_iter().map(radius).collect()
}

/// A shape from the start to the end of each bone.
fn along_bones(posed: &Posed, shape: SolidShape) -> Solids {
    let instances = posed.bones().filter_map(|bone| {
        let frame = bone_frame(&bone, &posed.world_from_joint()[bone.owner])?;
        Some(Solid::new(frame, BONE_COLOR))
    });
    Solids {
        shape,
        instances: instances.collect(),
    }
}

/// From the space of a shape that stands on its origin and is 1 high along y. Its sides turn with the joint, so that a roll is seen.
fn bone_frame(bone: &Bone, world_from_joint: &DAffine3) -> Option<DAffine3> {
    let along = bone.to - bone.from;
    let axis = along.try_normalize()?;
    // Whichever of two of the joint's axes stands off the bone more.
    let candidates = [
        world_from_joint.matrix3.x_axis,
        world_from_joint.matrix3.z_axis,
    ];
    let off = candidates.map(|side| side - axis * side.dot(axis));
    let side = if off[0].length_squared() >= off[1].length_squared() {
        off[0]
    } else {
        off[1]
    };
    let side = side.try_normalize()?;
    let turned = DMat3::from_cols(side * bone.radius, along, side.cross(axis) * bone.radius);
    Some(DAffine3::from_mat3_translation(turned, bone.from))
}
