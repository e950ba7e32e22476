//! Where light comes from.

use super::{Color, InvalidValue};
use glam::{DVec3, Vec3};

/// How a point light weakens with distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Falloff {
    /// The light is the same at every distance.
    #[default]
    None,
    /// Divided by max(d², 1e-4·size²), `size` being the rig's at rest.
    InverseSquare,
}

/// What of a light a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightField {
    /// Of a directional light; it is zero or not finite.
    Direction,
    /// Of a point light; a coordinate is not within ±1e12.
    Position,
    /// The factor on the color, which is not from 0 to 1e12.
    Intensity,
}

/// A light that cannot be drawn with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct LightError {
    /// Which of the light's values cannot be drawn with.
    pub field: LightField,
    /// What was accepted in its place, and what it is.
    pub problem: InvalidValue,
}

impl LightError {
    fn of(field: LightField) -> impl FnOnce(InvalidValue) -> Self {
        move |problem| Self { field, problem }
    }
}

/// A light in world space. Its `radiance` is color times intensity, linear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Infinitely far, so that it comes from one direction and never weakens.
    Directional {
        /// The way the light travels, unit length.
        direction: Vec3,
        /// Linear RGB, as a white surface that faces the light gives it back.
        radiance: Vec3,
    },
    /// Shines from one point to all sides.
    Point {
        /// In world space.
        position: Vec3,
        /// Linear RGB, as it is before `falloff`.
        radiance: Vec3,
        /// What it is divided by on its way.
        falloff: Falloff,
    },
    /// A point light that weakens by [`Falloff::InverseSquare`] and shines into a cone. Only files have them.
    Spot {
        /// In world space.
        position: Vec3,
        /// Linear RGB, as it is before distance and cone weaken it.
        radiance: Vec3,
        /// Which way it shines, and how far to the sides.
        cone: Cone,
    },
}

/// Where a spot light shines: in full up to one angle from its direction, from there to another by the square of how far the cosine of the
/// angle is on its way from one to the other, and no further.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// The way the light travels, unit length.
    pub direction: Vec3,
    /// Of the angle from the direction up to which it shines in full.
    pub cosine_of_inner: f32,
    /// Not above the other one.
    pub cosine_of_outer: f32,
}

impl Cone {
    /// Angles from the direction, in radians, `inner` not above `outer`.
    pub fn new(direction: Vec3, inner: f64, outer: f64) -> Self {
        Self {
            direction,
            cosine_of_inner: libm::cos(inner) as f32,
            cosine_of_outer: libm::cos(outer) as f32,
        }
    }
}

impl Light {
    /// # Errors
    /// Where the direction is zero or a number cannot be drawn with.
    pub fn directional(direction: DVec3, color: Color, intensity: f64) -> Result<Self, LightError> {
        let expected = "a direction other than zero";
        let unit = direction
            .try_normalize()
            .ok_or_else(|| InvalidValue::new(expected, direction.to_array()))
            .map_err(LightError::of(LightField::Direction))?;
        Ok(Self::Directional {
            direction: unit.as_vec3(),
            radiance: radiance(color, intensity)?,
        })
    }

    /// # Errors
    /// Where a number cannot be drawn with.
    pub fn point(
        position: DVec3,
        color: Color,
        intensity: f64,
        falloff: Falloff,
    ) -> Result<Self, LightError> {
        let found = position.to_array();
        let inside = found.iter().all(|number| number.abs() <= MOST);
        InvalidValue::unless(inside, "numbers within ±1e12", found)
            .map_err(LightError::of(LightField::Position))?;
        Ok(Self::Point {
            position: position.as_vec3(),
            radiance: radiance(color, intensity)?,
            falloff,
        })
    }

    /// A warm key light from the upper left front and a cool fill from the right, behind, for a rig that faces +Z.
    pub fn default_pair() -> Vec<Self> {
        let travelling = |x, y, z| Vec3::new(x, y, z).normalize_or(Vec3::NEG_Y);
        vec![
            Self::Directional {
                direction: travelling(0.7, -0.65, -0.6),
                radiance: Vec3::new(1.0, 0.87, 0.70) * 1.7,
            },
            Self::Directional {
                direction: travelling(-0.8, -0.25, 0.5),
                radiance: Vec3::new(0.40, 0.60, 1.0) * 1.2,
            },
        ]
    }
}

/// Largest position or intensity of a light: its square still fits float32.
const MOST: f64 = 1e12;

fn radiance(color: Color, intensity: f64) -> Result<Vec3, LightError> {
    let inside = (0.0..=MOST).contains(&intensity);
    InvalidValue::unless(inside, "a number from 0 to 1e12", intensity)
        .map_err(LightError::of(LightField::Intensity))?;
    Ok(color.rgb() * intensity as f32)
}
