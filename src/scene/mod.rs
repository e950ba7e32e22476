//! What to draw and how to look at it: plain values whose constructors check what drawing relies on.
//! Never lives here: the rig that is looked at, and anything that draws.

mod bounds;
mod camera;
mod light;
mod query;

pub use bounds::Bounds;
pub use camera::{
    CAMERA_DISTANCES, Camera, FOV_Y_RADIANS, LookAt, Near, Orbit, Pinhole, Projection,
};
pub use light::{Cone, Falloff, Light};
pub use query::{BoneRadius, Ray, Shape, VertexQuery};

use crate::limits::{LimitExceeded, Limits};
use glam::{Vec3, Vec4};

/// A value of a scene that cannot be drawn with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{expected}, but found {found}")]
pub struct SceneError {
    /// The field as the wire spells it, e.g. `camera.up`.
    pub field: &'static str,
    pub expected: &'static str,
    pub found: String,
}

impl SceneError {
    fn unless(
        holds: bool,
        field: &'static str,
        expected: &'static str,
        found: impl std::fmt::Debug,
    ) -> Result<(), Self> {
        if holds {
            return Ok(());
        }
        let found = format!("{found:?}");
        Err(Self {
            field,
            expected,
            found,
        })
    }
}

/// Width and height of a picture in pixels, neither of them 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Size {
    pub width: u32,
    pub height: u32,
}

/// Why a size is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SizeError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
}

impl Size {
    /// # Errors
    /// Where a side is 0, or sides or area exceed their ceilings.
    pub fn new(width: u32, height: u32, limits: &Limits) -> Result<Self, SizeError> {
        let found = [width, height];
        SceneError::unless(
            width > 0 && height > 0,
            "size",
            "two positive numbers",
            found,
        )?;
        limits.side(width.max(height))?;
        limits.pixels(u64::from(width) * u64::from(height))?;
        Ok(Self { width, height })
    }

    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// Linear RGB, each channel 0..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Color(Vec3);

impl Color {
    pub const WHITE: Self = Self::constant(1.0, 1.0, 1.0);

    /// # Errors
    /// Where a channel is outside 0..1.
    pub fn new(channels: [f64; 3], field: &'static str) -> Result<Self, SceneError> {
        let inside = channels.iter().all(|channel| (0.0..=1.0).contains(channel));
        SceneError::unless(inside, field, "numbers from 0 to 1", channels)?;
        Ok(Self(Vec3::from_array(
            channels.map(|channel| channel as f32),
        )))
    }

    pub const fn constant(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }

    pub fn rgb(self) -> Vec3 {
        self.0
    }
}

/// What stands behind the rig: linear RGB and straight alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    pub color: Color,
    pub alpha: f32,
}

impl Background {
    /// # Errors
    /// Where a channel is outside 0..1.
    pub fn new([r, g, b, alpha]: [f64; 4]) -> Result<Self, SceneError> {
        let inside = (0.0..=1.0).contains(&alpha);
        SceneError::unless(inside, "background", "an alpha from 0 to 1", alpha)?;
        Ok(Self {
            color: Color::new([r, g, b], "background")?,
            alpha: alpha as f32,
        })
    }

    /// As it is blended and averaged.
    pub fn premultiplied(self) -> Vec4 {
        (self.color.rgb() * self.alpha).extend(self.alpha)
    }
}

impl Default for Background {
    /// A dark slate, so that both a warm and a cool light stand out against it.
    fn default() -> Self {
        Self {
            color: Color::constant(0.012, 0.016, 0.024),
            alpha: 1.0,
        }
    }
}

/// The surface of a character, for Blinn-Phong. What is given stands in place of what a file's material says.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Surface {
    /// Where neither gives it, [`Surface::DIFFUSE`], or white under a texture or colors of vertices.
    pub diffuse: Option<Color>,
    /// Where neither gives it, [`Surface::SPECULAR`].
    pub specular: Option<Color>,
    /// The exponent on n·h. Where neither gives it, [`Surface::SHININESS`].
    pub shininess: Option<f32>,
    /// Index into the rig's variants: what these choose stands in place of the file's own materials.
    pub variant: Option<usize>,
}

impl Surface {
    pub const DIFFUSE: Color = Color::constant(0.60, 0.50, 0.42);
    pub const SPECULAR: Color = Color::constant(0.14, 0.14, 0.14);
    pub const SHININESS: f32 = 32.0;

    /// # Errors
    /// Where the exponent is outside 0..10000.
    pub fn new(
        diffuse: Option<Color>,
        specular: Option<Color>,
        shininess: Option<f64>,
    ) -> Result<Self, SceneError> {
        // Past this an exponent's highlight is smaller than a pixel and pow underflows everywhere else.
        let inside = shininess.is_none_or(|shininess| (0.0..=10_000.0).contains(&shininess));
        SceneError::unless(
            inside,
            "material.shininess",
            "a number from 0 to 10000",
            shininess.unwrap_or_default(),
        )?;
        Ok(Self {
            diffuse,
            specular,
            shininess: shininess.map(|shininess| shininess as f32),
            variant: None,
        })
    }
}

/// How the skin is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShowSkin {
    #[default]
    Posed,
    /// As it was modelled, whatever the pose.
    Bind,
    None,
}

impl ShowSkin {
    /// The form of the skin that is looked at, if it is looked at.
    pub fn shape(self) -> Shape {
        match self {
            Self::Posed | Self::None => Shape::Posed,
            Self::Bind => Shape::Bind,
        }
    }
}

/// How the skeleton is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShowSkeleton {
    #[default]
    None,
    /// A line along each bone and a dot at each joint, of constant width in pixels.
    Wireframe,
    /// Each joint's own box.
    Boxes,
    /// A ball at each joint, and a box along each bone that grows thinner.
    Sticks,
    /// A six-sided cylinder along each bone.
    Cylinders,
}

/// Which normals light the skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShowNormals {
    #[default]
    Smooth,
    /// Each triangle's own.
    Flat,
}

/// What of the rig is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Show {
    pub skin: ShowSkin,
    pub skeleton: ShowSkeleton,
    pub normals: ShowNormals,
    skin_opacity: f32,
}

impl Show {
    /// # Errors
    /// Where the opacity is outside 0..1.
    pub fn new(
        skin: ShowSkin,
        skeleton: ShowSkeleton,
        normals: ShowNormals,
        skin_opacity: f64,
    ) -> Result<Self, SceneError> {
        let inside = (0.0..=1.0).contains(&skin_opacity);
        let expected = "a number from 0 to 1";
        SceneError::unless(inside, "show.skin_opacity", expected, skin_opacity)?;
        Ok(Self {
            skin,
            skeleton,
            normals,
            skin_opacity: skin_opacity as f32,
        })
    }

    /// Whether any of the skin is to be seen.
    pub fn shows_skin(self) -> bool {
        self.skin != ShowSkin::None && self.skin_opacity > 0.0
    }

    /// Below 1 what stands behind the nearest surface of the skin shines through.
    pub fn skin_opacity(self) -> f32 {
        self.skin_opacity
    }
}

impl Default for Show {
    fn default() -> Self {
        let (skin, skeleton, normals) = Default::default();
        Self {
            skin,
            skeleton,
            normals,
            skin_opacity: 1.0,
        }
    }
}

/// Whether sides of a surface that cannot be seen are left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Cull {
    #[default]
    Auto,
    Never,
}

/// Samples of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Samples {
    One,
    #[default]
    Four,
}

impl Samples {
    pub fn count(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
        }
    }
}

/// How one character of a picture looks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Appearance {
    pub show: Show,
    pub surface: Surface,
    pub cull: Cull,
}

/// Everything about a picture but the characters in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    pub size: Size,
    pub samples: Samples,
    pub camera: Camera,
    /// At most [`Limits::lights`].
    pub lights: Vec<Light>,
    pub ambient: Color,
    pub background: Background,
}

impl Scene {
    /// Light from everywhere where a request names none: enough to keep the shadow side readable.
    pub const DEFAULT_AMBIENT: Color = Color::constant(0.055, 0.060, 0.080);
}
