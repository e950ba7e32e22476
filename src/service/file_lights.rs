//! The lights of a rig's file, in a pose. Never lives here: those that a request gives.

use crate::pose::Posed;
use crate::rig::{FileLight, FileLightKind};
use crate::scene::{Cone, Falloff, Light};
use glam::DVec3;
use std::f64::consts::PI;

/// As far as joints go. From further off nothing is lit, and the square of the distance would not fit float32.
const FURTHEST: f64 = 1e18;

/// In world space. One that its joint squeezes to nothing, so that it points nowhere, is left out.
pub(super) fn in_pose(posed: &Posed) -> Vec<Light> {
    let lights = posed.rig().lights().iter();
    lights.filter_map(|light| lit(light, posed)).collect()
}

fn lit(light: &FileLight, posed: &Posed) -> Option<Light> {
    let world_from_light = match light.joint {
        Some(joint) => posed.world_from_joint()[joint] * light.joint_from_light,
        None => light.joint_from_light,
    };
    let position = world_from_light.translation;
    if position.abs().max_element() > FURTHEST {
        return None;
    }
    let position = position.as_vec3();
    let along = world_from_light.transform_vector3(DVec3::NEG_Z);
    // A surface of color c that one lux falls on straight has the luminance c / π, which a renderer shows as it is; here light of
    // intensity 1 shows it as c.
    let radiance = light.color * (light.intensity / PI) as f32;
    Some(match light.kind {
        FileLightKind::Directional => Light::Directional {
            direction: along.try_normalize()?.as_vec3(),
            radiance,
        },
        FileLightKind::Point => Light::Point {
            position,
            radiance,
            falloff: Falloff::InverseSquare,
        },
        FileLightKind::Spot { inner, outer } => Light::Spot {
            position,
            radiance,
            cone: Cone::new(along.try_normalize()?.as_vec3(), inner, outer),
        },
    })
}
