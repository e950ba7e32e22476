//! What to ask of a rig besides a picture: some of its vertices, or what stands along a ray. Never lives here: the answers.

use super::InvalidValue;
use glam::DVec3;

/// Which form of a rig's skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// By the joints and the morph weights of the pose.
    Posed,
    /// As it was modelled, whatever the pose.
    Bind,
}

/// A range of one mesh's vertices, inside the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VertexQuery {
    /// Which of the characters that are asked about together, by its index.
    pub instance: usize,
    /// Index into [`Rig::meshes`](crate::rig::Rig::meshes).
    pub mesh: usize,
    /// The first vertex, by its index in the mesh: those of the file come first, then the copies that drawing needs.
    pub start: usize,
    /// How many vertices there are from `start` on.
    pub count: usize,
    /// Whether positions are wanted, in model space.
    pub positions: bool,
    /// Whether normals are wanted, in model space and of unit length.
    pub normals: bool,
}

/// A line of sight in world space; [`Camera::ray`](super::Camera::ray) makes them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The eye, or for an orthographic camera a point of the plane through the eye.
    pub origin: DVec3,
    /// Unit length.
    pub direction: DVec3,
    /// Distance from the origin at which it enters what is drawn: at the near plane.
    pub from: f64,
    /// Distance at which it leaves it again: infinity where there is no far plane.
    pub to: f64,
}

impl Ray {
    /// The point at a distance from the origin.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// Whether what stands at this distance is drawn.
    pub fn reaches(&self, distance: f64) -> bool {
        (self.from..=self.to).contains(&distance)
    }
}

/// How thick bones are where a request says so: positive, in the rig's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoneRadius(f64);

impl BoneRadius {
    /// # Errors
    /// Where the radius is not a positive number of sane size.
    pub fn new(radius: f64) -> Result<Self, InvalidValue> {
        // The range of a camera's lengths: its square neither overflows nor vanishes.
        let inside = (1e-12..=1e12).contains(&radius);
        InvalidValue::unless(inside, "a number from 1e-12 to 1e12", radius)?;
        Ok(Self(radius))
    }

    /// In the rig's units, from 1e-12 to 1e12.
    pub fn length(self) -> f64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Bounds, Camera, LookAt, Near, Orbit, Pinhole, Size};
    use glam::{DAffine3, DMat4, DQuat, DVec2};

    const SIZE: Size = Size {
        width: 400,
        height: 200,
    };
    const FRAMED: Bounds = Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };
    /// Of a pixel: what a matrix and its inverse lose in f64.
    const ROUNDING_PIXELS: f64 = 1e-7;

    /// Pixel and depth of a point, by the matrix that is drawn with.
    fn project(camera: &Camera, point: DVec3) -> (DVec2, f64) {
        let ndc = camera.clip_from_world().project_point3(point);
        let [width, height] = [SIZE.width, SIZE.height].map(f64::from);
        let pixel = DVec2::new((ndc.x + 1.0) / 2.0 * width, (1.0 - ndc.y) / 2.0 * height);
        (pixel, ndc.z)
    }

    fn look_at(fov_y: Option<f64>, height: Option<f64>) -> Camera {
        let look = LookAt {
            eye: DVec3::new(1.0, 2.0, 5.0),
            target: DVec3::new(0.3, -0.2, 0.1),
            up: DVec3::new(0.2, 1.0, 0.0),
            fov_y,
            height,
            near: Near(None),
        };
        Camera::look_at(look, &FRAMED, SIZE).unwrap()
    }

    fn pinhole() -> Camera {
        let turned = DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(-0.3);
        let placed = DAffine3::from_rotation_translation(turned, DVec3::new(2.0, 1.0, 4.0));
        // Files print matrices rounded, so cameras are let in that are a little off a rotation.
        let rounded = DMat4::from(placed).to_cols_array();
        let rounded = rounded.map(|number| (number * 1e4).round() / 1e4);
        let pinhole = Pinhole {
            fx: 310.0,
            fy: 250.0,
            cx: 130.0,
            cy: 260.0,
            world_from_camera: DMat4::from_cols_array(&rounded),
            near: Near(Some(0.2)),
        };
        Camera::pinhole(pinhole, &FRAMED, SIZE).unwrap()
    }

    fn cameras() -> [Camera; 4] {
        let orbit = Camera::orbit(Orbit::default(), &FRAMED, SIZE).unwrap();
        [
            orbit,
            look_at(Some(0.8), None),
            look_at(None, Some(4.0)),
            pinhole(),
        ]
    }

    #[test]
    fn every_point_of_a_ray_falls_onto_its_pixel() {
        for camera in cameras() {
            for (x, y) in [(0.0, 0.0), (200.0, 100.0), (399.5, 0.5), (-70.0, 913.0)] {
                let asked = DVec2::new(x, y);
                let ray = camera.ray(asked).unwrap();
                assert!((ray.direction.length() - 1.0).abs() < 1e-12);
                for further in [0.0, 0.7, 3.0, 20.0] {
                    let (pixel, _) = project(&camera, ray.at(ray.from + further));
                    let missed_by = pixel.distance(asked);
                    assert!(missed_by < ROUNDING_PIXELS, "{camera:?}: {pixel} {asked}");
                }
            }
        }
    }

    #[test]
    fn a_ray_begins_at_the_near_plane_and_ends_at_the_far_one() {
        for camera in cameras() {
            for pixel in [DVec2::ZERO, DVec2::new(311.0, 42.0)] {
                let ray = camera.ray(pixel).unwrap();
                let (_, depth) = project(&camera, ray.at(ray.from));
                assert!((depth - 1.0).abs() < 1e-9, "{camera:?}: {depth}");
                if ray.to.is_finite() {
                    let (_, depth) = project(&camera, ray.at(ray.to));
                    assert!(depth.abs() < 1e-9, "{camera:?}: {depth}");
                }
                let in_front = project(&camera, ray.at(ray.from + 1e-3)).1;
                assert!(in_front < 1.0, "{camera:?}: it looks ahead");
            }
        }
        let [.., orthographic, pinhole] = cameras();
        assert!(orthographic.ray(DVec2::ZERO).unwrap().to.is_finite());
        assert_eq!(pinhole.ray(DVec2::ZERO).unwrap().to, f64::INFINITY);
    }

    #[test]
    fn rays_start_at_the_eye_or_on_its_plane() {
        let [orbit, .., orthographic, pinhole] = cameras();
        for camera in [orbit, pinhole] {
            let eye = camera.world_from_camera().translation;
            assert_eq!(camera.ray(DVec2::new(3.0, 4.0)).unwrap().origin, eye);
        }
        let corner = orthographic.ray(DVec2::ZERO).unwrap();
        let camera_from_world = orthographic.world_from_camera().inverse();
        let origin = camera_from_world.transform_point3(corner.origin);
        // A height of 4 units is 200 pixels.
        assert!(origin.distance(DVec3::new(-4.0, 2.0, 0.0)) < 1e-12);
        let ahead = camera_from_world.transform_vector3(corner.direction);
        assert!(ahead.distance(DVec3::NEG_Z) < 1e-12);
    }

    #[test]
    fn a_pixel_or_radius_beyond_numbers_is_refused() {
        for x in [f64::NAN, f64::INFINITY, 1e300] {
            for pixel in [DVec2::new(x, 0.0), DVec2::new(0.0, x)] {
                assert!(pinhole().ray(pixel).is_err(), "{pixel}");
            }
        }
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            assert!(BoneRadius::new(radius).is_err(), "{radius}");
        }
        assert_eq!(BoneRadius::new(0.25).unwrap().length(), 0.25);
    }
}
