//! What to draw and how to look at it: plain values whose constructors check what drawing relies on.
//! Never lives here: the rig that is looked at, and anything that draws.

mod bounds;
mod camera;
mod light;
mod query;

pub use bounds::Bounds;
pub use camera::{
    CAMERA_DISTANCES, Camera, CameraError, CameraField, FOV_Y_RADIANS, LookAt, Near, Orbit,
    Pinhole, Projection,
};
pub use light::{Cone, Falloff, Light, LightError, LightField};
pub use query::{BoneRadius, Ray, Shape, VertexQuery};

use crate::limits::{LimitExceeded, Limits};
use glam::{Vec3, Vec4};

/// A value that cannot be drawn with. Which one it is, whoever gave it knows.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("expected {expected}, but found {found}")]
pub struct InvalidValue {
    /// What is accepted, as a phrase that reads on from `expected`.
    pub expected: &'static str,
    /// The value as it was given, in Rust's debug form.
    pub found: String,
}

impl InvalidValue {
    fn new(expected: &'static str, found: impl std::fmt::Debug) -> Self {
        let found = format!("{found:?}");
        Self { expected, found }
    }

    fn unless(
        holds: bool,
        expected: &'static str,
        found: impl std::fmt::Debug,
    ) -> Result<(), Self> {
        if holds {
            return Ok(());
        }
        Err(Self::new(expected, found))
    }
}

/// Width and height of a picture in pixels, neither of them 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Size {
    /// Pixels of a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
}

/// Why a size is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SizeError {
    /// A side is 0.
    #[error(transparent)]
    Value(#[from] InvalidValue),
    /// A side is over [`Limits::side`], or the area over [`Limits::pixels`].
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
}

impl Size {
    /// # Errors
    /// Where a side is 0, or sides or area exceed their ceilings.
    pub fn new(width: u32, height: u32, limits: &Limits) -> Result<Self, SizeError> {
        let found = [width, height];
        InvalidValue::unless(width > 0 && height > 0, "two positive numbers", found)?;
        limits.side(width.max(height))?;
        limits.pixels(u64::from(width) * u64::from(height))?;
        Ok(Self { width, height })
    }

    /// Those of the whole picture: width times height.
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// Linear RGB, each channel 0..1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Color(Vec3);

impl Color {
    /// 1 in every channel.
    pub const WHITE: Self = Self::constant(1.0, 1.0, 1.0);

    /// # Errors
    /// Where a channel is outside 0..1.
    pub fn new(channels: [f64; 3]) -> Result<Self, InvalidValue> {
        let inside = channels.iter().all(|channel| (0.0..=1.0).contains(channel));
        InvalidValue::unless(inside, "numbers from 0 to 1", channels)?;
        Ok(Self(Vec3::from_array(
            channels.map(|channel| channel as f32),
        )))
    }

    /// Unchecked, for values in the code: each channel is to be in 0..1.
    pub const fn constant(r: f32, g: f32, b: f32) -> Self {
        Self(Vec3::new(r, g, b))
    }

    /// Red, green and blue, each 0..1.
    pub fn rgb(self) -> Vec3 {
        self.0
    }
}

/// What stands behind the rig: linear RGB and straight alpha.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// Not multiplied by `alpha`.
    pub color: Color,
    /// From 0, which leaves the picture transparent where nothing is drawn, to 1.
    pub alpha: f32,
}

impl Background {
    /// # Errors
    /// Where a channel is outside 0..1.
    pub fn new([r, g, b, alpha]: [f64; 4]) -> Result<Self, InvalidValue> {
        let inside = (0.0..=1.0).contains(&alpha);
        InvalidValue::unless(inside, "an alpha from 0 to 1", alpha)?;
        Ok(Self {
            color: Color::new([r, g, b])?,
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
    /// Of skin for which neither a request nor a material gives a diffuse color, without a texture or colors of vertices.
    pub const DIFFUSE: Color = Color::constant(0.60, 0.50, 0.42);
    /// Of skin for which neither a request nor a material gives a specular color.
    pub const SPECULAR: Color = Color::constant(0.14, 0.14, 0.14);
    /// The exponent where neither a request nor a material gives one.
    pub const SHININESS: f32 = 32.0;

    /// # Errors
    /// Where the exponent is outside 0..10000.
    pub fn new(
        diffuse: Option<Color>,
        specular: Option<Color>,
        shininess: Option<f64>,
    ) -> Result<Self, InvalidValue> {
        // Past this an exponent's highlight is smaller than a pixel and pow underflows everywhere else.
        let inside = shininess.is_none_or(|shininess| (0.0..=10_000.0).contains(&shininess));
        let found = shininess.unwrap_or_default();
        InvalidValue::unless(inside, "a number from 0 to 10000", found)?;
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
    /// As the joints and the morph weights of the pose move it.
    #[default]
    Posed,
    /// As it was modelled, whatever the pose.
    Bind,
    /// Not at all.
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
    /// Not at all, except that a rig without vertices is then shown as [`Wireframe`](Self::Wireframe).
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
    /// Those of the vertices, interpolated; parts of a mesh whose file gives none stay flat.
    #[default]
    Smooth,
    /// Each triangle's own.
    Flat,
}

/// What of the rig is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Show {
    /// In which shape, if at all.
    pub skin: ShowSkin,
    /// In which form, if at all; what of it is behind opaque skin is hidden.
    pub skeleton: ShowSkeleton,
    /// Of the skin alone; the solids of a skeleton keep theirs.
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
    ) -> Result<Self, InvalidValue> {
        let inside = (0.0..=1.0).contains(&skin_opacity);
        InvalidValue::unless(inside, "a number from 0 to 1", skin_opacity)?;
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
    /// Backs of single-sided materials, and the insides of closed and opaque skin that is seen from outside.
    #[default]
    Auto,
    /// Every triangle is drawn, whichever side is seen.
    Never,
}

/// Samples of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Samples {
    /// At the pixel's center: edges are jagged.
    One,
    /// At the four standard positions of multisampling: edges are smooth.
    #[default]
    Four,
}

impl Samples {
    /// How many there are, 1 or 4.
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
    /// Which of skin and skeleton are drawn, and in what form.
    pub show: Show,
    /// What stands in place of the file's materials; by default nothing does.
    pub surface: Surface,
    /// By default, what cannot be seen is left out.
    pub cull: Cull,
}

/// Everything about a picture but the characters in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Of the picture, the same as that of `camera`.
    pub size: Size,
    /// How many of each pixel are drawn and averaged; by default four.
    pub samples: Samples,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// At most [`Limits::lights`].
    pub lights: Vec<Light>,
    /// Linear RGB of the light from everywhere, by which the diffuse color is multiplied.
    pub ambient: Color,
    /// What is left to be seen where nothing is drawn.
    pub background: Background,
}

impl Scene {
    /// Light from everywhere where a request names none: enough to keep the shadow side readable.
    pub const DEFAULT_AMBIENT: Color = Color::constant(0.055, 0.060, 0.080);
}
