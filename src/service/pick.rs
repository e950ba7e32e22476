//! `scene.pick`.

use super::appearance::skinning;
use super::call::Call;
use super::fault;
use super::message::{Payload, Permit};
use super::pose::of_pose;
use super::prepared_pose::EvaluatedPose;
use super::response::Responder;
use crate::engine::PickQuery;
use crate::pick::{Hit, What};
use crate::protocol::pick as wire;
use crate::protocol::{Attachments, Fault};
use crate::rig::Rig;
use crate::scene::{BoneRadius, Size};
use glam::DVec2;
use std::sync::Arc;
use std::time::Duration;

impl Call {
    pub(super) fn pick(
        &self,
        params: &wire::PickParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        let frame = params.frame();
        let found = self.engine().rig(&frame.rig)?;
        let rig = Arc::clone(&found.loaded.rig);
        let (scene, appearance) = self.scene(&frame, &found.loaded)?;
        inside(params.pixel, scene.size)?;
        let ray = scene.camera.ray(DVec2::from_array(params.pixel));
        let ray = ray.map_err(fault::at("pixel"))?;
        let radius = params.bone_radius.map(BoneRadius::new).transpose();
        let is_asked_for = |target| params.targets.contains(&target);
        let skin = is_asked_for(wire::PickTarget::Skin) && appearance.show.shows_skin();
        let query = PickQuery {
            ray,
            bones: is_asked_for(wire::PickTarget::Bone),
            bone_radius: radius.map_err(fault::at("bone_radius"))?,
            skin: skin.then(|| appearance.show.skin.shape()),
            cull: appearance.cull,
            variant: appearance.surface.variant,
        };
        let pose = self.prepare_pose(frame.pose, &found)?;
        // Skinned vertices are looked at and dropped, so none of them becomes text.
        let (memory, context) = self.admit(24 * rig.draw_vertex_count() as u64)?;
        let EvaluatedPose { posed, clamped } = pose.evaluate(&found).map_err(of_pose)?;
        let call = self.clone();
        let skinning = skinning(frame.skinning);
        Ok(move |responder: Responder| {
            let stats = Arc::clone(&call.service.stats);
            let engine = call.engine();
            engine.pick(posed, skinning, query, context, move |result| {
                responder.respond(result.map_err(Fault::from).and_then(|(hit, timings)| {
                    let picked = wire::Picked {
                        ray: wire::Ray {
                            origin: ray.origin.to_array(),
                            direction: ray.direction.to_array(),
                        },
                        hit: hit.map(|hit| described(&hit, &rig)),
                        clamped,
                        timings_ms: stats.rendered(0, 0, timings, Duration::ZERO),
                    };
                    Payload::new(&picked, Attachments::default(), Some(Permit::new(memory)))
                }));
            });
        })
    }
}

fn inside(pixel: [f64; 2], size: Size) -> Result<(), Fault> {
    let sides = [size.width, size.height];
    let is_inside = |(at, side): (f64, u32)| (0.0..=f64::from(side)).contains(&at);
    if pixel.into_iter().zip(sides).all(is_inside) {
        return Ok(());
    }
    let problem =
        format!("expected a point of the picture, from [0, 0] to {sides:?}, but found {pixel:?}");
    Err(Fault::invalid_params("pixel", problem))
}

fn described(hit: &Hit, rig: &Rig) -> wire::Hit {
    let joint_name = |joint: usize| rig.skeleton().joints()[joint].name.clone();
    let at = wire::Hit {
        kind: wire::PickTarget::Bone,
        distance: hit.distance,
        position: hit.position.to_array(),
        joint: None,
        along: None,
        mesh: None,
        triangle: None,
        barycentric: None,
        normal: None,
    };
    match hit.what {
        What::Bone { joint, along, .. } => wire::Hit {
            joint: Some(joint_name(joint)),
            along: Some(along),
            ..at
        },
        What::Skin {
            mesh,
            triangle,
            barycentric,
            normal,
            joint,
        } => wire::Hit {
            kind: wire::PickTarget::Skin,
            joint: joint.map(joint_name),
            mesh: Some(rig.meshes()[mesh].name().to_owned()),
            triangle: Some(triangle as u64),
            barycentric: Some(barycentric),
            normal: Some(normal.to_array()),
            ..at
        },
    }
}
