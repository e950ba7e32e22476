//! Where the pictures are taken from, as the options say it. Never lives here: how the camera goes around.

use super::args::CameraArgs;
use crate::protocol::camera::{Camera, LookAt, Orbit as WireOrbit};
use crate::protocol::rig::RigDescription;
use crate::scene::{Bounds, Orbit};
use anyhow::bail;
use glam::{DMat3, DVec3};

/// A camera that looks at a target.
#[derive(Debug, Clone)]
pub(super) struct View {
    /// Radians; `None` for the protocol's own.
    pub azimuth: Option<f64>,
    /// Radians; `None` for the protocol's own.
    inclination: Option<f64>,
    /// `None` for the middle of the rig at rest.
    pub target: Option<DVec3>,
    /// `None` for as far as it takes to see the whole rig.
    pub distance: Option<f64>,
    pub lens: Lens,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Lens {
    /// Radians that the picture is high; `None` for the protocol's own.
    Perspective { fov_y: Option<f64> },
    /// Units of length that the picture is high.
    Orthographic { height: f64 },
}

impl CameraArgs {
    /// `rest` is what the rig takes up at rest.
    pub(super) fn view(&self, rest: &Bounds) -> anyhow::Result<View> {
        let target = self.target.map(|target| DVec3::from_array(target.0));
        let lens = match self.ortho {
            Some(height) => Lens::Orthographic { height },
            None => Lens::Perspective {
                fov_y: self.fov.map(|fov| fov.0),
            },
        };
        let Some(eye) = self.eye else {
            return Ok(View {
                azimuth: self.camera.map(|camera| camera.azimuth.radians),
                inclination: self.camera.map(|camera| camera.inclination.radians),
                target,
                distance: self.camera.and_then(|camera| camera.distance),
                lens,
            });
        };
        // By angles, so that a turntable goes around from there, and straight down is no special case.
        let target = target.unwrap_or_else(|| rest.center());
        let from_target = DVec3::from_array(eye.0) - target;
        let distance = from_target.length();
        let Some(direction) = from_target.try_normalize() else {
            let found = eye.0;
            bail!("--eye: expected a point at a distance from the target, but found {found:?}");
        };
        Ok(View {
            azimuth: Some(direction.x.atan2(direction.z)),
            inclination: Some(direction.y.clamp(-1.0, 1.0).asin()),
            target: Some(target),
            distance: Some(distance),
            lens,
        })
    }
}

impl View {
    /// As a request has it. `rest` is what the rig takes up at rest.
    pub(super) fn camera(&self, rest: &Bounds) -> Camera {
        let height = match self.lens {
            Lens::Orthographic { height } => height,
            Lens::Perspective { fov_y } => {
                return Camera::Orbit(WireOrbit {
                    target: self.target.map(|target| target.to_array()),
                    distance: self.distance,
                    azimuth: self.azimuth,
                    inclination: self.inclination,
                    fov_y,
                    near: None,
                });
            }
        };
        // The protocol's orbit has perspective always.
        let target = self.target.unwrap_or_else(|| rest.center());
        // In front of the whole rig; from how far away makes no difference.
        let before = || 4.0 * rest.radius() + target.distance(rest.center());
        let distance = self.distance.unwrap_or_else(before);
        let azimuth = self.azimuth.unwrap_or(Orbit::AZIMUTH);
        let inclination = self.inclination.unwrap_or(Orbit::INCLINATION);
        let world_from_camera =
            DMat3::from_rotation_y(azimuth) * DMat3::from_rotation_x(-inclination);
        let eye = target + world_from_camera.z_axis * distance;
        Camera::LookAt(LookAt {
            eye: eye.to_array(),
            target: target.to_array(),
            up: Some(world_from_camera.y_axis.to_array()),
            fov_y: None,
            height: Some(height),
            near: None,
        })
    }
}

/// What the rig takes up at rest.
pub(super) fn rest_of(rig: &RigDescription) -> Bounds {
    Bounds {
        min: DVec3::from_array(rig.bounds.bounds.min),
        max: DVec3::from_array(rig.bounds.bounds.max),
    }
}
