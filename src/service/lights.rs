//! Lights of the wire as those that draw. Never lives here: where lights of a file stand in a pose.

use super::fault;
use crate::limits::Limits;
use crate::protocol::camera as wire;
use crate::protocol::{Fault, FieldFault};
use crate::rig::Rig;
use crate::scene::{Color, Falloff, Light};
use glam::DVec3;

/// Those of the rig's file are left out: they depend on the pose, and evaluating a frame adds them.
pub(super) fn lights(
    given: Option<&wire::Lights>,
    rig: &Rig,
    limits: &Limits,
) -> Result<Vec<Light>, Fault> {
    match given {
        None => Ok(Light::default_pair()),
        Some(wire::Lights::Named(wire::NamedLights::File)) => {
            if rig.lights().is_empty() {
                let problem = "expected a rig with lights in its file, but found none in it";
                return Err(Fault::invalid_params("lights", problem));
            }
            Ok(Vec::new())
        }
        Some(wire::Lights::Given(lights)) => {
            limits.lights(lights.len())?;
            let light = |(index, given)| {
                light(given).map_err(|fault| fault.within(("lights", index)).into())
            };
            lights.iter().enumerate().map(light).collect()
        }
    }
}

fn light(light: &wire::Light) -> Result<Light, FieldFault> {
    let color = |given: Option<[f64; 3]>| {
        let white = [1.0; 3];
        Color::new(given.unwrap_or(white)).map_err(fault::at("color"))
    };
    match light {
        wire::Light::Directional(light) => {
            let direction = DVec3::from_array(light.direction);
            let color = color(light.color)?;
            Ok(Light::directional(
                direction,
                color,
                light.intensity.unwrap_or(1.0),
            )?)
        }
        wire::Light::Point(light) => {
            let color = color(light.color)?;
            let falloff = match light.falloff {
                wire::Falloff::None => Falloff::None,
                wire::Falloff::InverseSquare => Falloff::InverseSquare,
            };
            Ok(Light::point(
                DVec3::from_array(light.position),
                color,
                light.intensity.unwrap_or(1.0),
                falloff,
            )?)
        }
    }
}
