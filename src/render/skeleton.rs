//! Views of the skeleton as plain shapes in model space, which both renderers draw. Sizes come from the rig where its files give none.
//! Never lives here: pixels.

use super::solids::{Fineness, SolidShape, Solids};
use crate::pose::{Bone, Posed};
use crate::scene::ShowSkeleton;
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// What one view of a skeleton consists of.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct SkeletonView {
    /// Of a wireframe; otherwise there are none.
    pub lines: Vec<Segment>,
    /// Of boxes, sticks or cylinders; otherwise there are none.
    pub solids: Solids,
}

/// A line of constant width in pixels, its ends round enough to be a dot where they coincide.
#[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct Segment {
    /// Where it starts.
    pub from_in_model: Vec3,
    /// Across the line, whatever its distance from the eye.
    pub width_pixels: f32,
    /// Where it ends; at a dot, the same point.
    pub to_in_model: Vec3,
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

/// `rest_size` is that of the rest bounds, for joints that have no bone to be measured by.
pub(super) fn view(posed: &Posed, how: ShowSkeleton, rest_size: f64) -> SkeletonView {
    let mut view = SkeletonView::default();
    match how {
        ShowSkeleton::None => {}
        ShowSkeleton::Wireframe => view.lines = wireframe(posed),
        ShowSkeleton::Boxes => add_boxes(&mut view.solids, posed, rest_size),
        ShowSkeleton::Sticks => {
            add_balls(&mut view.solids, posed, rest_size);
            add_along_bones(&mut view.solids, posed, SolidShape::Taper);
        }
        ShowSkeleton::Cylinders => add_along_bones(&mut view.solids, posed, SolidShape::Cylinder),
    }
    view
}

/// A line along each bone, then a dot at each joint, so that a skeleton of one joint shows too.
fn wireframe(posed: &Posed) -> Vec<Segment> {
    let bones = posed.bones().map(|bone| Segment {
        from_in_model: bone.from.as_vec3(),
        to_in_model: bone.to.as_vec3(),
        width_pixels: BONE_WIDTH_PIXELS,
        color: LINE_COLOR,
    });
    let dots = posed.world_from_joint().iter().map(|world_from_joint| {
        let at = world_from_joint.translation.as_vec3();
        Segment {
            from_in_model: at,
            to_in_model: at,
            width_pixels: JOINT_DOT_PIXELS,
            color: DOT_COLOR,
        }
    });
    bones.chain(dots).collect()
}

fn add_boxes(solids: &mut Solids, posed: &Posed, rest_size: f64) {
    let radii = ball_radii(posed, rest_size);
    let joints = posed.rig().skeleton().joints().iter().zip(radii);
    for ((joint, radius), world_from_joint) in joints.zip(posed.world_from_joint()) {
        let half = DVec3::splat(BOX_RADII * radius);
        let [min, max] = joint.bounding_box.unwrap_or([-half, half]);
        let joint_from_box = DAffine3::from_mat3_translation(
            DMat3::from_diagonal((max - min) / 2.0),
            (min + max) / 2.0,
        );
        solids.add(
            SolidShape::Box,
            &(*world_from_joint * joint_from_box),
            BOX_COLOR,
        );
    }
}

fn add_balls(solids: &mut Solids, posed: &Posed, rest_size: f64) {
    let radii = ball_radii(posed, rest_size);
    let ball = SolidShape::Ball(Fineness::for_balls(radii.len()));
    for (world_from_joint, radius) in posed.world_from_joint().iter().zip(radii) {
        let sized = DMat3::from_diagonal(DVec3::splat(radius));
        let placed = DAffine3::from_mat3_translation(sized, world_from_joint.translation);
        solids.add(ball, &placed, BALL_COLOR);
    }
}

/// Of each joint: as the thickest bone that meets in it asks for.
fn ball_radii(posed: &Posed, rest_size: f64) -> Vec<f64> {
    /// Of the rig's size, where there is no bone at all.
    const ALONE: f64 = 0.05;
    let mut thickest = vec![0.0f64; posed.world_from_joint().len()];
    for bone in posed.bones() {
        for joint in [bone.owner, bone.child] {
            thickest[joint] = thickest[joint].max(bone.radius);
        }
    }
    let size = if rest_size > 0.0 { rest_size } else { 1.0 };
    // Where others of the skeleton have bones, a joint that has none is as large as they are.
    let usual = posed.rig().skeleton().bone_radius();
    let alone = usual.map_or(ALONE * size, |radius| BALL_RADII * radius);
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
fn add_along_bones(solids: &mut Solids, posed: &Posed, shape: SolidShape) {
    for bone in posed.bones() {
        if let Some(frame) = bone_frame(&bone, &posed.world_from_joint()[bone.owner]) {
            solids.add(shape, &frame, BONE_COLOR);
        }
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
