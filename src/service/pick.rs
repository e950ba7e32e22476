//! `scene.pick`.

use super::answer::Answer;
use super::scene::of_skinning;
use super::{Call, describe};
use crate::engine::{EngineError, PickQuery};
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
        params: wire::PickParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let (pixel, radius) = (params.pixel, params.bone_radius);
        let is_asked_for = |target| params.targets.contains(&target);
        let (bones, skin) = (
            is_asked_for(wire::PickTarget::Bone),
            is_asked_for(wire::PickTarget::Skin),
        );
        let params = params.frame();
        let found = self.engine().rig(&params.rig)?;
        let rig = Arc::clone(&found.loaded.rig);
        let (scene, appearance) = self.scene(&params, &found.loaded)?;
        inside(pixel, scene.size)?;
        let ray = scene.camera.ray(DVec2::from_array(pixel));
        let ray = ray.map_err(EngineError::from)?;
        let query = PickQuery {
            ray,
            bones,
            bone_radius: radius
                .map(BoneRadius::new)
                .transpose()
                .map_err(EngineError::from)?,
            skin: (skin && appearance.show.shows_skin()).then(|| appearance.show.skin.shape()),
            cull: appearance.cull,
            variant: appearance.surface.variant,
        };
        let (posed, clamped) = self.posed(&params.pose, &found)?;
        let clamped = describe::clamped(&rig, &clamped);
        // Skinned vertices are looked at and dropped, so none of them becomes text.
        let (held, terms) = self.take_on(24 * rig.draw_vertex_count() as u64)?;
        let Some(answer) = answer.take() else {
            return Ok(());
        };
        let stats = Arc::clone(&self.service.stats);
        let skinning = of_skinning(params.skinning);
        self.engine()
            .pick(posed, skinning, query, terms, move |result| match result {
                Ok((hit, timings)) => {
                    let timings = stats.rendered(0, 0, timings, Duration::ZERO);
                    let picked = wire::Picked {
                        ray: wire::Ray {
                            origin: ray.origin.to_array(),
                            direction: ray.direction.to_array(),
                        },
                        hit: hit.map(|hit| described(&hit, &rig)),
                        clamped,
                        timings_ms: timings,
                    };
                    answer.send(&picked, Attachments::default(), Some(held));
                }
                Err(error) => answer.fail(error.into()),
            });
        Ok(())
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
