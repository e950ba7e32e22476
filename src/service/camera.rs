//! Cameras of the wire as those that draw. Never lives here: which camera a picture has.

use crate::protocol::camera as wire;
use crate::scene::{Bounds, Camera, CameraError, LookAt, Near, Orbit, Pinhole, Size};
use glam::{DMat4, DVec3};

/// `framed` is what it frames as far as it leaves that open.
pub(super) fn camera(
    camera: &wire::Camera,
    framed: &Bounds,
    size: Size,
) -> Result<Camera, CameraError> {
    match camera {
        wire::Camera::Orbit(given) => Camera::orbit(orbit(given), framed, size),
        wire::Camera::LookAt(given) => Camera::look_at(look_at(given), framed, size),
        wire::Camera::Pinhole(given) => Camera::pinhole(pinhole(given), framed, size),
    }
}

fn orbit(given: &wire::Orbit) -> Orbit {
    let wire::Orbit {
        target,
        distance,
        azimuth,
        inclination,
        fov_y,
        near,
    } = *given;
    Orbit {
        target: target.map(DVec3::from_array),
        distance,
        azimuth,
        inclination,
        fov_y,
        near: Near(near),
    }
}

fn look_at(given: &wire::LookAt) -> LookAt {
    let wire::LookAt {
        eye,
        target,
        up,
        fov_y,
        height,
        near,
    } = *given;
    LookAt {
        eye: DVec3::from_array(eye),
        target: DVec3::from_array(target),
        up: up.map_or(DVec3::Y, DVec3::from_array),
        fov_y,
        height,
        near: Near(near),
    }
}

fn pinhole(given: &wire::Pinhole) -> Pinhole {
    let wire::Pinhole {
        fx,
        fy,
        cx,
        cy,
        world_from_camera,
        axes,
        near,
    } = *given;
    let given = DMat4::from_cols_array(&world_from_camera);
    let world_from_camera = match axes {
        wire::Axes::Gl => given,
        wire::Axes::Cv => given * DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0)),
    };
    Pinhole {
        fx,
        fy,
        cx,
        cy,
        world_from_camera,
        near: Near(near),
    }
}
