//! A camera for a whole clip: the protocol's own frames the rig at rest, and a clip may lead it away from there.
//! Never lives here: where the camera looks from.

use super::view::{Lens, View};
use crate::cli::local;
use crate::protocol::blob::ArrayTransport;
use crate::protocol::frame::{FrameParams, ShowSkeleton, ShowSkin};
use crate::protocol::mesh::{VertexState, Vertices, VerticesParams};
use crate::protocol::pose::{JointTransform, Pose, Transforms, TransformsParams};
use crate::scene::{Bounds, Camera, Size};
use crate::service::Service;
use glam::DVec3;
use std::sync::Arc;

/// Moments of a clip that are looked at: a stride has a few, and what happens between two of them is seldom far outside of both.
const MOMENTS: u32 = 24;

/// Chooses target and distance, where the user has not, so that the rig stays in the picture from `start` to `end`, in seconds. They are
/// the same in every frame.
pub(super) fn frame_clip(
    view: &mut View,
    request: &FrameParams,
    [start, end]: [f64; 2],
    service: &Arc<Service>,
) -> anyhow::Result<()> {
    if view.target.is_some() && view.distance.is_some() {
        return Ok(());
    }
    let mut corners = Vec::new();
    for moment in 0..=MOMENTS {
        let share = f64::from(moment) / f64::from(MOMENTS);
        let mut pose = request.pose.clone();
        if let Some(clip) = &mut pose.clip {
            clip.time = start + (end - start) * share;
        }
        corners.extend(extent(request, pose, service)?);
    }
    let bounds = Bounds::of(corners).unwrap_or(Bounds::ORIGIN);
    let [width, height] = request.size;
    let fov_y = match view.lens {
        Lens::Perspective { fov_y } => fov_y,
        // It sees as much from any distance.
        Lens::Orthographic { .. } => None,
    };
    let fits = Camera::distance_to_fit(&bounds, fov_y, Size { width, height });
    view.target = view.target.or(Some(bounds.center()));
    view.distance = view.distance.or(Some(fits));
    Ok(())
}

/// Points that have in their midst what is shown of the rig in a pose: the corners of its skin's bounds, and its joints where they are
/// shown or there is no skin.
fn extent(request: &FrameParams, pose: Pose, service: &Arc<Service>) -> anyhow::Result<Vec<DVec3>> {
    let mut points = Vec::new();
    if request.show.skin != ShowSkin::None {
        points.extend(corners_of_skin(request, pose.clone(), service)?);
    }
    if request.show.skeleton != ShowSkeleton::None || points.is_empty() {
        points.extend(origins_of_joints(request, pose, service)?);
    }
    Ok(points)
}

fn origins_of_joints(
    request: &FrameParams,
    pose: Pose,
    service: &Arc<Service>,
) -> anyhow::Result<Vec<DVec3>> {
    let params = TransformsParams {
        rig: request.rig.clone(),
        pose,
    };
    let (transforms, _) = local::ask::<_, Transforms>(service, "joint.transforms", &params)?;
    let origin = |joint: &JointTransform| DVec3::from_slice(&joint.world_from_joint[12..15]);
    Ok(transforms.joints.iter().map(origin).collect())
}

/// None where there is no skin.
fn corners_of_skin(
    request: &FrameParams,
    pose: Pose,
    service: &Arc<Service>,
) -> anyhow::Result<Vec<DVec3>> {
    let params = VerticesParams {
        rig: request.rig.clone(),
        pose,
        skinning: request.skinning,
        state: match request.show.skin {
            ShowSkin::Bind => VertexState::Bind,
            ShowSkin::Posed | ShowSkin::None => VertexState::Posed,
        },
        // Bounds alone.
        attributes: Vec::new(),
        mesh: None,
        range: None,
        transport: ArrayTransport::Attach,
    };
    let (vertices, _) = local::ask::<_, Vertices>(service, "mesh.vertices", &params)?;
    let corners = [vertices.bounds.min, vertices.bounds.max].map(DVec3::from_array);
    let has_skin = vertices.meshes.iter().any(|mesh| mesh.vertex_count > 0);
    Ok(corners.into_iter().filter(|_| has_skin).collect())
}
