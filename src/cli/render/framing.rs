//! A camera for a whole clip: the protocol's own frames the rig at rest, and a clip may lead it away from there.
//! Never lives here: where the camera looks from.

use super::view::{Lens, View};
use crate::cli::local::{self, Drawing};
use crate::engine::{Engine, RigRef};
use crate::frame::SkinnedVertices;
use crate::protocol::Fault;
use crate::protocol::frame::FrameParams;
use crate::scene::{Bounds, Camera, ShowSkeleton, ShowSkin, Size, VertexQuery};
use crate::service::{Service, Subject};
use glam::DVec3;
use std::sync::{Arc, mpsc};

/// Moments of a clip that are looked at: a stride has a few, and what happens between two of them is seldom far outside of both.
const MOMENTS: u32 = 24;

/// Chooses target and distance, where the user has not, so that the rig stays in the picture from `start` to `end`, in seconds. They are
/// the same in every frame.
pub(super) fn frame_clip(
    view: &mut View,
    request: &FrameParams,
    [start, end]: [f64; 2],
    service: &Arc<Service>,
    loaded: &RigRef,
) -> Result<(), Fault> {
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
        let request = FrameParams {
            pose,
            ..request.clone()
        };
        let subject = service.subject(&request, loaded)?;
        corners.extend(extent(service.engine(), subject)?);
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

/// Points that have in their midst what is shown of the rig: the corners of its skin's bounds, and its joints where they are shown or there
/// is no skin.
fn extent(engine: &Engine, subject: Subject) -> Result<Vec<DVec3>, Fault> {
    let show = subject.appearance.show;
    let joints = subject.posed.world_from_joint().iter();
    let joints: Vec<DVec3> = joints.map(|joint| joint.translation).collect();
    let mut points = Vec::new();
    if show.skin != ShowSkin::None {
        points.extend(corners_of_skin(engine, subject)?);
    }
    if show.skeleton != ShowSkeleton::None || points.is_empty() {
        points.extend(joints);
    }
    Ok(points)
}

/// None where there is no skin.
fn corners_of_skin(engine: &Engine, subject: Subject) -> Result<Vec<DVec3>, Fault> {
    let meshes = subject.posed.rig().meshes().iter().enumerate();
    let queries = meshes.map(|(mesh, of_mesh)| VertexQuery {
        instance: 0,
        mesh,
        start: 0,
        count: of_mesh.vertex_count(),
        positions: true,
        normals: false,
    });
    let (queries, shape) = (queries.collect(), subject.appearance.show.skin.shape());
    let (sender, receiver) = mpsc::sync_channel(1);
    let (posed, skinning) = (subject.posed, subject.skinning);
    let context = local::job_context(engine)?;
    engine.vertices(posed, skinning, shape, queries, context, move |skinned| {
        // The receiver waits.
        let _ = sender.send(skinned.map_err(Fault::from));
    });
    let (meshes, _) = Drawing(receiver).wait()?;
    let bounds = meshes.iter().filter_map(SkinnedVertices::bounds);
    let bounds = bounds.reduce(|all, one| all.and(&one));
    Ok(bounds.map_or(Vec::new(), |bounds| vec![bounds.min, bounds.max]))
}
