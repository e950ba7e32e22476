//! Cameras and lights of a frame request, each an object whose `kind` says which other fields it has.
//! Never lives here: what the defaults come to; that depends on the rig.
//!
//! serde reads a tagged enum through a buffer, which forgets the path of a fault. So the fields of all kinds are read into one flat struct,
//! and sorted by kind afterwards.

use super::strict::field_error;
use schemars::{JsonSchema, Schema};
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::json;
use std::f64::consts::PI;
use std::fmt;

/// Where the picture is taken from. World space, right-handed; the camera looks down its own −Z with +Y up on screen.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[schemars(transform = orbit_needs_no_kind)]
pub enum Camera {
    /// On a sphere about a target; the kind where none is given. What is left out frames what is shown of the rig, at rest whatever the
    /// pose: its skin, posed or as bound; its joints and their boxes only where the skeleton is shown or there is no skin.
    Orbit(Orbit),
    /// At one point, looking at another: in perspective, or orthographic where `height` is given.
    LookAt(LookAt),
    /// Calibrated: `x = fx·X/Z + cx`, `y = fy·Y/Z + cy` in pixels from the top left corner, for a point X to the right, Y down, Z ahead
    /// of the camera.
    Pinhole(Pinhole),
}

impl Default for Camera {
    fn default() -> Self {
        Self::Orbit(Orbit::default())
    }
}

/// On a sphere about a target. What is left out frames what is shown of the rig, at rest whatever the pose: its skin, posed or as bound;
/// its joints and their boxes only where the skeleton is shown or there is no skin.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Orbit {
    /// The point to look at. Without it, the middle of what is framed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<[f64; 3]>,
    /// From the target to the eye. Without it, as far as it takes to see all of that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Radians about +Y, from +Z toward +X. Without it, π/6.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = PI / 6.0))]
    pub azimuth: Option<f64>,
    /// Radians above the horizon. Without it, π/9.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = PI / 9.0))]
    pub inclination: Option<f64>,
    /// Radians that the picture is high. Without it, 2π/9.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 2.0 * PI / 9.0))]
    pub fov_y: Option<f64>,
    /// Distance before which nothing is drawn. Without it, a thousandth of the distance to the target.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near: Option<f64>,
}

/// At one point, looking at another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct LookAt {
    /// The point to look from, in world space, apart from `target`.
    pub eye: [f64; 3],
    /// The point to look at.
    pub target: [f64; 3],
    /// The direction that is up on screen. Without it, `[0, 1, 0]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = [0.0, 1.0, 0.0]))]
    pub up: Option<[f64; 3]>,
    /// Radians that the picture is high. Without it, and without `height`, 2π/9 (0.6981317007977318).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fov_y: Option<f64>,
    /// Makes the camera orthographic: units of length that the picture is high. Not together with `fov_y`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
    /// Distance before which nothing is drawn. Without it, a thousandth of the distance to the target.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near: Option<f64>,
}

/// Calibrated: `x = fx·X/Z + cx`, `y = fy·Y/Z + cy` in pixels from the top left corner, for a point X to the right, Y down, Z ahead.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Pinhole {
    /// Focal length across, in pixels, above 0.
    pub fx: f64,
    /// Focal length down, in pixels, above 0.
    pub fy: f64,
    /// Where the axis of the camera meets the picture, in pixels from its left edge; within ±1e12, also outside of the picture.
    pub cx: f64,
    /// Where the axis of the camera meets the picture, in pixels from its top edge; within ±1e12, also outside of the picture.
    pub cy: f64,
    /// Column-major: a rotation and a translation.
    pub world_from_camera: [f64; 16],
    /// Which way the axes of the camera's space point.
    #[schemars(default)]
    pub axes: Axes,
    /// Distance before which nothing is drawn. Without it, a thousandth of the distance to the rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near: Option<f64>,
}

/// Which way the axes of a camera's space point; +X is to the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// +Y up, looking down −Z.
    #[default]
    Gl,
    /// +Y down, looking down +Z.
    Cv,
}

/// What lights a picture.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Lights {
    /// These, at most 16.
    Given(Vec<Light>),
    /// Lights that the rig's file has.
    Named(NamedLights),
}

/// Lights that are found elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NamedLights {
    /// Those of the rig's file, which move with their joints. A rig without any is an error.
    File,
}

/// Where light comes from, in world space. Colors are linear RGB from 0 to 1.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Light {
    /// From so far away that direction and strength are the same everywhere.
    Directional(DirectionalLight),
    /// From one point, in all directions alike.
    Point(PointLight),
}

/// From so far away that it is the same everywhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct DirectionalLight {
    /// The way the light travels; its length does not matter.
    pub direction: [f64; 3],
    /// Without it, white.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = [1.0, 1.0, 1.0]))]
    pub color: Option<[f64; 3]>,
    /// Multiplies the color. Without it, 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1.0))]
    pub intensity: Option<f64>,
}

/// From one point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct PointLight {
    /// In world space, in the rig's units; each number within ±1e12.
    pub position: [f64; 3],
    /// Without it, white.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = [1.0, 1.0, 1.0]))]
    pub color: Option<[f64; 3]>,
    /// Multiplies the color. Without it, 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1.0))]
    pub intensity: Option<f64>,
    /// How the light weakens with distance. Without it, `none`.
    #[schemars(default)]
    pub falloff: Falloff,
}

/// How a light weakens with distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Falloff {
    /// It does not.
    #[default]
    None,
    /// Divided by the square of the distance, or by 1e-4 of the square of the rig's size where that is more.
    InverseSquare,
}

/// What lights a picture whose request names no lights.
pub(super) fn default_lights() -> [Light; 2] {
    [
        ([0.7, -0.65, -0.6], [1.0, 0.87, 0.7], 1.7),
        ([-0.8, -0.25, 0.5], [0.4, 0.6, 1.0], 1.2),
    ]
    .map(|(direction, color, intensity)| {
        Light::Directional(DirectionalLight {
            direction,
            color: Some(color),
            intensity: Some(intensity),
        })
    })
}

/// Every field of an orbit camera may be left out, `kind` too, which a derived schema cannot say.
fn orbit_needs_no_kind(schema: &mut Schema) {
    if let Some(required) = schema.pointer_mut("/oneOf/0/required") {
        *required = json!([]);
    }
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum CameraKind {
    #[default]
    Orbit,
    LookAt,
    Pinhole,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFields {
    #[serde(default)]
    kind: CameraKind,
    target: Option<[f64; 3]>,
    distance: Option<f64>,
    azimuth: Option<f64>,
    inclination: Option<f64>,
    fov_y: Option<f64>,
    near: Option<f64>,
    eye: Option<[f64; 3]>,
    up: Option<[f64; 3]>,
    height: Option<f64>,
    fx: Option<f64>,
    fy: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    world_from_camera: Option<[f64; 16]>,
    axes: Option<Axes>,
}

impl<'de> Deserialize<'de> for Camera {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let fields = CameraFields::deserialize(deserializer)?;
        match fields.kind {
            CameraKind::Orbit => fields.into_orbit().map(Self::Orbit),
            CameraKind::LookAt => fields.into_look_at().map(Self::LookAt),
            CameraKind::Pinhole => fields.into_pinhole().map(Self::Pinhole),
        }
    }
}

/// Refuses the first of the fields that is there.
macro_rules! refuse {
    ($fields:ident, $whose:literal: $($field:ident)*) => {
        $(if $fields.$field.is_some() {
            return Err(field_error(stringify!($field), concat!("there is no such field in ", $whose)));
        })*
    };
}

fn needed<T, E: Error>(field: Option<T>, name: &'static str) -> Result<T, E> {
    field.ok_or_else(|| E::missing_field(name))
}

impl CameraFields {
    fn into_orbit<E: Error>(self) -> Result<Orbit, E> {
        refuse!(self, "an `orbit` camera, which is the kind where none is given": eye up height fx fy cx cy world_from_camera axes);
        Ok(Orbit {
            target: self.target,
            distance: self.distance,
            azimuth: self.azimuth,
            inclination: self.inclination,
            fov_y: self.fov_y,
            near: self.near,
        })
    }

    fn into_look_at<E: Error>(self) -> Result<LookAt, E> {
        refuse!(self, "a `look_at` camera": distance azimuth inclination fx fy cx cy world_from_camera axes);
        if self.fov_y.is_some() && self.height.is_some() {
            return Err(field_error(
                "height",
                "expected either `fov_y` or `height`, but found both",
            ));
        }
        Ok(LookAt {
            eye: needed(self.eye, "eye")?,
            target: needed(self.target, "target")?,
            up: self.up,
            fov_y: self.fov_y,
            height: self.height,
            near: self.near,
        })
    }

    fn into_pinhole<E: Error>(self) -> Result<Pinhole, E> {
        refuse!(self, "a `pinhole` camera": target distance azimuth inclination fov_y eye up height);
        Ok(Pinhole {
            fx: needed(self.fx, "fx")?,
            fy: needed(self.fy, "fy")?,
            cx: needed(self.cx, "cx")?,
            cy: needed(self.cy, "cy")?,
            world_from_camera: needed(self.world_from_camera, "world_from_camera")?,
            axes: self.axes.unwrap_or_default(),
            near: self.near,
        })
    }
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum LightKind {
    Directional,
    Point,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightFields {
    kind: LightKind,
    direction: Option<[f64; 3]>,
    position: Option<[f64; 3]>,
    color: Option<[f64; 3]>,
    intensity: Option<f64>,
    falloff: Option<Falloff>,
}

impl<'de> Deserialize<'de> for Lights {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LightsVisitor)
    }
}

struct LightsVisitor;

impl<'de> Visitor<'de> for LightsVisitor {
    type Value = Lights;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of lights or `file`")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Lights, E> {
        match word {
            "file" => Ok(Lights::Named(NamedLights::File)),
            _ => Err(E::invalid_value(Unexpected::Str(word), &self)),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, lights: A) -> Result<Lights, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(lights)).map(Lights::Given)
    }
}

impl<'de> Deserialize<'de> for Light {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let fields = LightFields::deserialize(deserializer)?;
        match fields.kind {
            LightKind::Directional => {
                refuse!(fields, "a `directional` light": position falloff);
                Ok(Self::Directional(DirectionalLight {
                    direction: needed(fields.direction, "direction")?,
                    color: fields.color,
                    intensity: fields.intensity,
                }))
            }
            LightKind::Point => {
                refuse!(fields, "a `point` light": direction);
                Ok(Self::Point(PointLight {
                    position: needed(fields.position, "position")?,
                    color: fields.color,
                    intensity: fields.intensity,
                    falloff: fields.falloff.unwrap_or_default(),
                }))
            }
        }
    }
}
