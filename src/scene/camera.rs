//! Cameras of three kinds, brought to one form. All are right-handed; the camera looks down its own −Z with +Y up on screen.

use super::{Bounds, InvalidValue, Ray, Size};
use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, DVec4};
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::RangeInclusive;

/// How camera space falls onto pixels; (0, 0) is the top left corner of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// In pixels: `x = fx·X/−Z + cx`, `y = −fy·Y/−Z + cy`.
    Perspective {
        /// Focal length across the picture, in pixels.
        fx: f64,
        /// Focal length down the picture, in pixels.
        fy: f64,
        /// From the left edge of the picture to the principal point, in pixels.
        cx: f64,
        /// From the upper edge of the picture to the principal point, in pixels.
        cy: f64,
    },
    /// `scale` pixels to a unit of length, the middle of the picture on the axis; what is further than `far` is cut off.
    Orthographic {
        /// Pixels to a world unit, across and down alike.
        scale: f64,
        /// From the eye's plane to the far plane, in world units.
        far: f64,
    },
}

/// Where a picture is taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    size: Size,
    world_from_camera: DAffine3,
    projection: Projection,
    near: f64,
}

/// From the eye to the near plane along the camera's −Z, in world units; `None` is 1/1000 of the distance to what is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Near(pub Option<f64>);

/// A camera on a sphere about a target. What is `None` frames the bounds.
#[derive(Debug, Clone, Copy, Default)]
pub struct Orbit {
    /// The point in world space that is looked at; `None` is the middle of the framed bounds.
    pub target: Option<DVec3>,
    /// From the target to the eye, in world units; `None` is that of [`Camera::distance_to_fit`].
    pub distance: Option<f64>,
    /// Radians about +Y, from +Z toward +X.
    pub azimuth: Option<f64>,
    /// Radians above the horizon.
    pub inclination: Option<f64>,
    /// The angle from the lower to the upper edge of the picture, in radians; `None` is 2π/9, which is 40°.
    pub fov_y: Option<f64>,
    /// `Near(None)` is 1/1000 of the distance.
    pub near: Near,
}

/// A camera at a point, looking at another. Either `fov_y` or the orthographic `height` may be given.
#[derive(Debug, Clone, Copy)]
pub struct LookAt {
    /// In world space; anywhere but at the target.
    pub eye: DVec3,
    /// The point in world space that falls onto the middle of the picture.
    pub target: DVec3,
    /// A direction in world space, of any length, that points up on the picture; off the line of sight.
    pub up: DVec3,
    /// The angle from the lower to the upper edge of the picture, in radians; `None` is 2π/9, which is 40°.
    pub fov_y: Option<f64>,
    /// World units from the lower to the upper edge of the picture, which make the camera orthographic; `None` gives perspective.
    pub height: Option<f64>,
    /// `Near(None)` is 1/1000 of the distance from the eye to the target.
    pub near: Near,
}

/// A calibrated camera.
#[derive(Debug, Clone, Copy)]
pub struct Pinhole {
    /// Focal length across the picture, in pixels.
    pub fx: f64,
    /// Focal length down the picture, in pixels.
    pub fy: f64,
    /// From the left edge of the picture to the principal point, in pixels.
    pub cx: f64,
    /// From the upper edge of the picture to the principal point, in pixels.
    pub cy: f64,
    /// Camera space of the `gl` kind.
    pub world_from_camera: DMat4,
    /// `Near(None)` is 1/1000 of the distance from the eye to the middle of the framed bounds, or of their radius where that is more.
    pub near: Near,
}

/// What of a camera a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraField {
    /// Where the camera stands, whatever it was given by.
    Position,
    /// [`Orbit::distance`], given or made to fit.
    Distance,
    /// [`LookAt::eye`], which is at the target or not finite.
    Eye,
    /// [`LookAt::up`], which is zero, not finite, or on the line of sight.
    Up,
    /// The field of view of an [`Orbit`] or a [`LookAt`], which is outside [`FOV_Y_RADIANS`].
    FovY,
    /// [`LookAt::height`], which is outside [`CAMERA_DISTANCES`] or given besides `fov_y`.
    Height,
    /// The near plane, which is outside [`CAMERA_DISTANCES`] or, of an orthographic camera, not before the far plane.
    Near,
    /// [`Pinhole::fx`], which is outside [`CAMERA_DISTANCES`].
    Fx,
    /// [`Pinhole::fy`], which is outside [`CAMERA_DISTANCES`].
    Fy,
    /// [`Pinhole::cx`], which is not within ±1e12.
    Cx,
    /// [`Pinhole::cy`], which is not within ±1e12.
    Cy,
    /// [`Pinhole::world_from_camera`], which scales, shears, mirrors or projects.
    WorldFromCamera,
}

/// A camera that cannot be drawn with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct CameraError {
    /// Which of the camera's values cannot be drawn with.
    pub field: CameraField,
    /// What was accepted in its place, and what it is.
    pub problem: InvalidValue,
}

impl CameraError {
    fn new(field: CameraField, expected: &'static str, found: impl std::fmt::Debug) -> Self {
        let problem = InvalidValue::new(expected, found);
        Self { field, problem }
    }

    fn unless(
        holds: bool,
        field: CameraField,
        expected: &'static str,
        found: impl std::fmt::Debug,
    ) -> Result<(), Self> {
        if holds {
            return Ok(());
        }
        Err(Self::new(field, expected, found))
    }
}

impl Orbit {
    /// Where none is given.
    pub const AZIMUTH: f64 = PI / 6.0;
    /// Where none is given.
    pub const INCLINATION: f64 = PI / 9.0;
}

/// Fields of view that a camera can have. Closer to 0 or π nothing but rounding is left of a picture.
pub const FOV_Y_RADIANS: RangeInclusive<f64> = 1e-4..=PI - 1e-4;

/// How far a camera can be from its target. Coordinates go as far to either side.
pub const CAMERA_DISTANCES: RangeInclusive<f64> = LEAST..=MOST;

/// Height of the field of view where none is given.
const FOV_Y: f64 = 2.0 * PI / 9.0;
/// Share of the distance to the target at which the near plane stands.
const NEAR: f64 = 1e-3;
/// Largest distance or coordinate of a camera; see `MOST` of lights.
const MOST: f64 = 1e12;
/// Smallest length of a camera: in float32 depth something of it has to be left.
const LEAST: f64 = 1e-12;

impl Camera {
    /// Eye = target + distance · (sin azimuth · cos inclination, sin inclination, cos azimuth · cos inclination).
    ///
    /// # Errors
    /// [`CameraError`].
    pub fn orbit(orbit: Orbit, framed: &Bounds, size: Size) -> Result<Self, CameraError> {
        let fov_y = checked_fov(orbit.fov_y)?;
        let target = orbit.target.unwrap_or_else(|| framed.center());
        let distance = orbit
            .distance
            .unwrap_or_else(|| Self::distance_to_fit(framed, Some(fov_y), size));
        positive(distance, CameraField::Distance)?;
        let (azimuth, inclination) = (
            orbit.azimuth.unwrap_or(Orbit::AZIMUTH),
            orbit.inclination.unwrap_or(Orbit::INCLINATION),
        );
        // Turning the camera itself, rather than looking at the target, keeps straight up and straight down defined.
        let turned = DMat3::from_rotation_y(azimuth) * DMat3::from_rotation_x(-inclination);
        let eye = target + turned.z_axis * distance;
        let world_from_camera = DAffine3::from_mat3_translation(turned, eye);
        let projection = perspective(fov_y, size);
        Self::checked(world_from_camera, projection, orbit.near, distance, size)
    }

    /// From which the sphere about `framed` just fits the narrower side of the picture.
    pub fn distance_to_fit(framed: &Bounds, fov_y: Option<f64>, size: Size) -> f64 {
        let half_y = fov_y.unwrap_or(FOV_Y) / 2.0;
        let aspect = f64::from(size.width) / f64::from(size.height);
        let half_x = libm::atan(libm::tan(half_y) * aspect);
        framed.radius() / libm::sin(half_x.min(half_y).min(FRAC_PI_2))
    }

    /// # Errors
    /// [`CameraError`].
    pub fn look_at(look: LookAt, framed: &Bounds, size: Size) -> Result<Self, CameraError> {
        let LookAt {
            eye, target, up, ..
        } = look;
        let distance = eye.distance(target);
        let back = (eye - target).try_normalize().ok_or_else(|| {
            let expected = "a point other than the target";
            CameraError::new(CameraField::Eye, expected, eye.to_array())
        })?;
        let right = up
            .try_normalize()
            .map(|up| up.cross(back))
            // A smaller sine than this is rounding.
            .filter(|right| right.length() > 1e-9)
            .and_then(DVec3::try_normalize)
            .ok_or_else(|| {
                let expected = "a direction off the line of sight";
                CameraError::new(CameraField::Up, expected, up.to_array())
            })?;
        let turned = DMat3::from_cols(right, back.cross(right), back);
        let world_from_camera = DAffine3::from_mat3_translation(turned, eye);
        let projection = match look.height {
            Some(height) => {
                let expected = "either fov_y or height";
                let is_alone = look.fov_y.is_none();
                CameraError::unless(is_alone, CameraField::Height, expected, "both")?;
                positive(height, CameraField::Height)?;
                // Orthographic depth is linear: a far plane much further away would leave float32 no steps to tell surfaces apart.
                let reach = 2.0 * distance + 100.0 * framed.radius().max(height);
                Projection::Orthographic {
                    scale: f64::from(size.height) / height,
                    far: reach,
                }
            }
            None => perspective(checked_fov(look.fov_y)?, size),
        };
        Self::checked(world_from_camera, projection, look.near, distance, size)
    }

    /// # Errors
    /// [`CameraError`].
    pub fn pinhole(pinhole: Pinhole, framed: &Bounds, size: Size) -> Result<Self, CameraError> {
        let Pinhole {
            fx,
            fy,
            cx,
            cy,
            world_from_camera: matrix,
            near,
        } = pinhole;
        positive(fx, CameraField::Fx)?;
        positive(fy, CameraField::Fy)?;
        for (field, number) in [(CameraField::Cx, cx), (CameraField::Cy, cy)] {
            let expected = "a number within ±1e12";
            CameraError::unless(number.abs() <= MOST, field, expected, number)?;
        }
        let turned = DMat3::from_mat4(matrix);
        let field = CameraField::WorldFromCamera;
        // Files print rotations with four decimals or so; a camera that scales or mirrors is a mistake.
        let is_rotation = (turned.transpose() * turned).abs_diff_eq(DMat3::IDENTITY, 1e-3)
            && turned.determinant() > 0.0
            && matrix.row(3) == DVec4::W;
        let expected = "16 numbers by column: a rotation, a translation, and a last row of 0 0 0 1";
        CameraError::unless(is_rotation, field, expected, matrix.to_cols_array())?;
        let world_from_camera = DAffine3::from_mat4(matrix);
        let eye = world_from_camera.translation;
        let distance = eye.distance(framed.center()).max(framed.radius());
        let projection = Projection::Perspective { fx, fy, cx, cy };
        Self::checked(world_from_camera, projection, near, distance, size)
    }

    fn checked(
        world_from_camera: DAffine3,
        projection: Projection,
        near: Near,
        distance: f64,
        size: Size,
    ) -> Result<Self, CameraError> {
        let near = near.0.unwrap_or(distance * NEAR);
        positive(near, CameraField::Near)?;
        if let Projection::Orthographic { far, .. } = projection {
            let expected = "a plane before the far plane";
            CameraError::unless(near < far, CameraField::Near, expected, near)?;
        }
        let eye = world_from_camera.translation.to_array();
        let inside = eye.iter().all(|number| number.abs() <= MOST);
        let expected = "an eye within ±1e12";
        CameraError::unless(inside, CameraField::Position, expected, eye)?;
        Ok(Self {
            size,
            world_from_camera,
            projection,
            near,
        })
    }

    /// Of the picture that pixels and clip space are of.
    pub fn size(&self) -> Size {
        self.size
    }

    /// Camera space is of the `gl` kind: −Z ahead, +Y up.
    pub fn world_from_camera(&self) -> DAffine3 {
        self.world_from_camera
    }

    /// In pixels of a picture of that [size](Self::size).
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Depth is reversed: 1 at the near plane, and 0 at infinity (perspective) or at the far plane (orthographic).
    pub fn clip_from_world(&self) -> DMat4 {
        self.clip_from_camera() * DMat4::from(self.world_from_camera.inverse())
    }

    fn clip_from_camera(&self) -> DMat4 {
        let [width, height] = [self.size.width, self.size.height].map(f64::from);
        match self.projection {
            Projection::Perspective { fx, fy, cx, cy } => DMat4::from_cols(
                DVec4::new(2.0 * fx / width, 0.0, 0.0, 0.0),
                DVec4::new(0.0, 2.0 * fy / height, 0.0, 0.0),
                DVec4::new(1.0 - 2.0 * cx / width, 2.0 * cy / height - 1.0, 0.0, -1.0),
                DVec4::new(0.0, 0.0, self.near, 0.0),
            ),
            Projection::Orthographic { scale, far } => {
                let depth = far - self.near;
                DMat4::from_cols(
                    DVec4::new(2.0 * scale / width, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, 2.0 * scale / height, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, 1.0 / depth, 0.0),
                    DVec4::new(0.0, 0.0, far / depth, 1.0),
                )
            }
        }
    }

    /// What is seen at a point of the picture, or beside it: (0, 0) is its top left corner, the middle of a pixel is at +0.5.
    ///
    /// # Errors
    /// Where `pixel` is no point that numbers reach.
    pub fn ray(&self, pixel: DVec2) -> Result<Ray, InvalidValue> {
        let inside = pixel.to_array().iter().all(|number| number.abs() <= MOST);
        InvalidValue::unless(inside, "two numbers within ±1e12", pixel.to_array())?;
        let [fx, fy, cx, cy] = self.intrinsics();
        let (x, y) = ((pixel.x - cx) / fx, (cy - pixel.y) / fy);
        let (start, ahead, far) = match self.projection {
            Projection::Perspective { .. } => (DVec3::ZERO, DVec3::new(x, y, -1.0), f64::INFINITY),
            Projection::Orthographic { far, .. } => (DVec3::new(x, y, 0.0), DVec3::NEG_Z, far),
        };
        // `ahead` advances by 1 in depth, so its length is what both planes' distances are stretched by.
        let ahead = self.world_from_camera.transform_vector3(ahead);
        let length = ahead.length();
        Ok(Ray {
            origin: self.world_from_camera.transform_point3(start),
            direction: ahead / length,
            from: self.near * length,
            to: far * length,
        })
    }

    /// Where the eye is, as a homogeneous point: the direction back to it where it is infinitely far (orthographic).
    pub fn eye(&self) -> DVec4 {
        match self.projection {
            Projection::Perspective { .. } => self.world_from_camera.translation.extend(1.0),
            Projection::Orthographic { .. } => self.world_from_camera.matrix3.z_axis.extend(0.0),
        }
    }

    /// `fx, fy, cx, cy` in pixels; for an orthographic camera pixels to a unit of length.
    pub fn intrinsics(&self) -> [f64; 4] {
        match self.projection {
            Projection::Perspective { fx, fy, cx, cy } => [fx, fy, cx, cy],
            Projection::Orthographic { scale, .. } => {
                let [cx, cy] =
                    [self.size.width, self.size.height].map(|side| f64::from(side) / 2.0);
                [scale, scale, cx, cy]
            }
        }
    }
}

fn positive(number: f64, field: CameraField) -> Result<(), CameraError> {
    let inside = CAMERA_DISTANCES.contains(&number);
    CameraError::unless(inside, field, "a number from 1e-12 to 1e12", number)
}

fn checked_fov(fov_y: Option<f64>) -> Result<f64, CameraError> {
    let fov_y = fov_y.unwrap_or(FOV_Y);
    let (inside, expected) = (
        FOV_Y_RADIANS.contains(&fov_y),
        "radians from 0.0001 to 3.1414",
    );
    CameraError::unless(inside, CameraField::FovY, expected, fov_y)?;
    Ok(fov_y)
}

fn perspective(fov_y: f64, size: Size) -> Projection {
    let [width, height] = [size.width, size.height].map(f64::from);
    let f = height / 2.0 / libm::tan(fov_y / 2.0);
    Projection::Perspective {
        fx: f,
        fy: f,
        cx: width / 2.0,
        cy: height / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size {
        width: 400,
        height: 200,
    };
    const FRAMED: Bounds = Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };

    /// Pixel and depth of a point, by the matrix that is drawn with.
    fn project(camera: &Camera, point: DVec3) -> (DVec2, f64) {
        let clip = camera.clip_from_world() * point.extend(1.0);
        let ndc = clip / clip.w;
        let [width, height] = [SIZE.width, SIZE.height].map(f64::from);
        let pixel = DVec2::new((ndc.x + 1.0) / 2.0 * width, (1.0 - ndc.y) / 2.0 * height);
        (pixel, ndc.z)
    }

    fn look(eye: DVec3, fov_y: Option<f64>, height: Option<f64>) -> LookAt {
        LookAt {
            eye,
            target: DVec3::ZERO,
            up: DVec3::Y,
            fov_y,
            height,
            near: Near(None),
        }
    }

    #[test]
    fn the_target_is_the_middle_of_the_picture_and_up_is_up() {
        let orbit = Camera::orbit(Orbit::default(), &FRAMED, SIZE).unwrap();
        let eye = DVec3::new(1.0, 2.0, 5.0);
        let look_at = Camera::look_at(look(eye, Some(0.8), None), &FRAMED, SIZE).unwrap();
        let orthographic = Camera::look_at(look(eye, None, Some(4.0)), &FRAMED, SIZE).unwrap();
        for camera in [orbit, look_at, orthographic] {
            let (middle, depth) = project(&camera, DVec3::ZERO);
            assert!(middle.distance(DVec2::new(200.0, 100.0)) < 1e-9, "{middle}");
            assert!(depth > 0.0 && depth < 1.0);
            let (above, _) = project(&camera, DVec3::Y * 0.5);
            assert!(
                above.y < middle.y && (above.x - middle.x).abs() < 1e-9,
                "{above}"
            );
        }
    }

    #[test]
    fn depth_is_one_at_the_near_plane_and_falls_with_distance() {
        let camera = Camera::look_at(look(DVec3::Z * 10.0, None, None), &FRAMED, SIZE).unwrap();
        let (_, near) = project(&camera, DVec3::Z * (10.0 - 0.01));
        let (_, far) = project(&camera, DVec3::Z * -1e9);
        assert!((near - 1.0).abs() < 1e-9 && far < 1e-6, "{near} {far}");
    }

    #[test]
    fn the_default_orbit_stands_where_the_wire_says() {
        let camera = Camera::orbit(Orbit::default(), &FRAMED, SIZE).unwrap();
        let eye = camera.world_from_camera().translation;
        let distance = 3f64.sqrt() / (PI / 9.0).sin();
        let (az, inc) = (PI / 6.0, PI / 9.0);
        let wanted = DVec3::new(az.sin() * inc.cos(), inc.sin(), az.cos() * inc.cos()) * distance;
        assert!(eye.distance(wanted) < 1e-9, "{eye} {wanted}");
    }

    #[test]
    fn straight_down_is_a_picture_too() {
        let orbit = Orbit {
            inclination: Some(FRAC_PI_2),
            azimuth: Some(0.0),
            ..Orbit::default()
        };
        let camera = Camera::orbit(orbit, &FRAMED, SIZE).unwrap();
        let (behind, _) = project(&camera, DVec3::NEG_Z * 0.5);
        assert!(behind.y < 100.0, "what lies away from the viewer is up");
    }

    #[test]
    fn a_pinhole_projects_by_its_own_formula() {
        let matrix = DMat4::from_translation(DVec3::new(0.1, 0.2, 3.0));
        let pinhole = Pinhole {
            fx: 300.0,
            fy: 280.0,
            cx: 190.0,
            cy: 120.0,
            world_from_camera: matrix,
            near: Near(Some(0.1)),
        };
        let camera = Camera::pinhole(pinhole, &FRAMED, SIZE).unwrap();
        let (pixel, _) = project(&camera, DVec3::new(0.4, 0.5, 1.0));
        let wanted = DVec2::new(300.0 * 0.3 / 2.0 + 190.0, -280.0 * 0.3 / 2.0 + 120.0);
        assert!(pixel.distance(wanted) < 1e-9, "{pixel} {wanted}");
        let scaled = Pinhole {
            world_from_camera: DMat4::from_scale(DVec3::splat(2.0)),
            ..pinhole
        };
        let refused = Camera::pinhole(scaled, &FRAMED, SIZE).unwrap_err();
        assert_eq!(refused.field, CameraField::WorldFromCamera);
    }

    #[test]
    fn what_cannot_be_looked_at_is_refused_by_field() {
        let same_point = look(DVec3::ZERO, None, None);
        let along_up = look(DVec3::Y, None, None);
        let both = look(DVec3::Z, Some(1.0), Some(1.0));
        let flat = look(DVec3::Z, Some(0.0), None);
        for (given, field) in [
            (same_point, CameraField::Eye),
            (along_up, CameraField::Up),
            (both, CameraField::Height),
            (flat, CameraField::FovY),
        ] {
            assert_eq!(
                Camera::look_at(given, &FRAMED, SIZE).unwrap_err().field,
                field
            );
        }
    }
}
