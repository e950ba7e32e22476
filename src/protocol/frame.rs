//! `frame.render`: what to draw, and the picture.
//! Never lives here: cameras and lights, which have a file of their own, and the ranges that numbers must be in.

use super::blob::Blob;
use super::pose::Clamped;
use super::{blob, camera, frame, pose};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::de::value::{self, MapDeserializer};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The fields of a frame request, each in this one place: `field: type of the whole => type of a change`. `make` gets them behind what it
/// is given, with the types as seen from where `blob`, `camera`, `frame` and `pose` are in scope.
///
/// A macro, since serde's `flatten` would let unknown fields through.
macro_rules! frame_fields {
    ($make:ident! { $($given:tt)* }) => {
        $make! { { $($given)* }
            /// Name or digest of a loaded rig.
            rig: String => String,
            /// A pose for this request alone. Without it, as if it were `{}`.
            #[serde(default)]
            pose: pose::Pose => Box<pose::Pose>,
            /// By which rule a vertex follows several joints. Without it, `linear`.
            #[serde(default)]
            skinning: frame::Skinning => frame::Skinning,
            /// What of the rig is drawn. Without it, its posed skin alone; of a rig that has no skin, its skeleton.
            #[serde(default)]
            show: frame::Show => Box<frame::Show>,
            /// Where the picture is taken from. Without it, an `orbit` that frames what is shown.
            #[serde(default)]
            camera: camera::Camera => Box<camera::Camera>,
            /// A list of at most 16, or `file`. Without it, a warm key light and a cool fill; an empty list leaves the ambient light alone.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("default" = camera::default_lights()))]
            lights: Option<camera::Lights> => camera::Lights,
            /// Light from everywhere. Without it, just enough to see into the shadows.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("default" = [0.055, 0.06, 0.08]))]
            ambient: Option<[f64; 3]> => [f64; 3],
            /// What the skin's surface is to be in place of the file's materials. Without it, as the file has them.
            #[serde(default)]
            material: frame::Material => Box<frame::Material>,
            /// What stands behind the rig, with straight alpha. Without it, an opaque dark slate.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("default" = [0.012, 0.016, 0.024, 1.0]))]
            background: Option<[f64; 4]> => [f64; 4],
            /// Which triangles are left out. Without it, `auto`.
            #[serde(default)]
            cull: frame::Cull => frame::Cull,
            /// Width and height in pixels.
            #[serde(default = "frame::default_size")]
            size: [u32; 2] => [u32; 2],
            /// How many samples of each pixel are averaged: 1 or 4. Without it, 4.
            #[serde(default)]
            samples: frame::Samples => frame::Samples,
            /// Which pictures to send.
            #[serde(default = "frame::color_alone")]
            outputs: Vec<frame::Output> => Vec<frame::Output>,
            /// What each picture is packed as. Without it, `png`.
            #[serde(default)]
            image: frame::ImageFormat => frame::ImageFormat,
            /// How hard to compress a PNG.
            #[serde(default)]
            compression: frame::Compression => frame::Compression,
            /// Whether pictures come inside the reply or as raw bytes after its line. Without it, `base64`.
            #[serde(default)]
            transport: blob::PictureTransport => blob::PictureTransport,
        }
    };
}

/// A type with the fields of a frame request and some more.
macro_rules! frame_request {
    (
        { $(#[$doc:meta])* $name:ident { $($(#[$more_attribute:meta])* $more:ident: $more_type:ty,)* } }
        $($(#[$attribute:meta])* $field:ident: $type:ty => $change:ty,)*
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            $($(#[$attribute])* pub $field: $type,)*
            $($(#[$more_attribute])* pub $more: $more_type,)*
        }

        impl $name {
            /// The frame request in it.
            pub fn frame(&self) -> frame::FrameParams {
                frame::FrameParams { $($field: self.$field.clone(),)* }
            }
        }
    };
}

/// A type with any of the fields of a frame request, to be laid over a whole one.
macro_rules! frame_change {
    (
        { $(#[$doc:meta])* $name:ident over $common:ident }
        $($(#[$attribute:meta])* $field:ident: $type:ty => $change:ty,)*
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields, default)]
        pub struct $name {
            $(
                /// In place of the common part's field of this name. Without it, that field holds.
                #[serde(skip_serializing_if = "Option::is_none")] pub $field: Option<$change>,
            )*
        }

        impl $name {
            /// The whole request: what is given here stands in place of the same field of the common part.
            pub fn over(&self, common: &$common) -> frame::FrameParams {
                frame::FrameParams { $($field: self.$field.over(&common.$field),)* }
            }
        }
    };
}

pub(super) use {frame_change, frame_fields, frame_request};

/// A field that may be given, to stand in place of one of a common part.
pub(super) trait Over<T> {
    fn over(&self, common: &T) -> T;
}

impl<T: Clone> Over<T> for Option<T> {
    fn over(&self, common: &T) -> T {
        self.as_ref().unwrap_or(common).clone()
    }
}

impl<T: Clone> Over<T> for Option<Box<T>> {
    fn over(&self, common: &T) -> T {
        self.as_deref().unwrap_or(common).clone()
    }
}

impl<T: Clone> Over<Self> for Option<T> {
    fn over(&self, common: &Self) -> Self {
        self.as_ref().or(common.as_ref()).cloned()
    }
}

frame_fields! { frame_request! {
    /// Asks for a picture of a rig. Colors are linear RGB from 0 to 1.
    FrameParams {}
} }

impl FrameParams {
    /// A picture of this rig with everything else left to its default.
    pub fn of(rig: impl Into<String>) -> Self {
        let given = [("rig", rig.into())].into_iter();
        let read = Self::deserialize(MapDeserializer::<_, value::Error>::new(given));
        read.expect("every field but the rig has a default")
    }
}

pub(super) fn default_size() -> [u32; 2] {
    [512, 512]
}

pub(super) fn color_alone() -> Vec<Output> {
    vec![Output::Color]
}

macro_rules! words {
    ($($(#[$doc:meta])* $name:ident { $($(#[$inner:meta])* $variant:ident,)* })*) => {
        $($(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum $name { $($(#[$inner])* $variant,)* })*
    };
}

words! {
    /// How a vertex follows several joints.
    Skinning {
        /// Their matrices are averaged by weight.
        #[default]
        Linear,
        /// Their rigid motions are averaged as dual quaternions, which keeps the volume where joints twist or bend far; scale and shear are
        /// averaged as matrices first.
        DualQuaternion,
    }

    /// How the skin is shown.
    ShowSkin {
        /// In the pose.
        #[default]
        Posed,
        /// Where it was modelled, whatever the pose.
        Bind,
        /// Not at all.
        None,
    }

    /// How the skeleton is shown.
    ShowSkeleton {
        /// Not at all.
        #[default]
        None,
        /// A line along each bone and a dot at each joint, of constant width in pixels.
        Wireframe,
        /// Each joint's own box, lit.
        Boxes,
        /// A ball at each joint, and a box along each bone that grows thinner, lit.
        Sticks,
        /// A six-sided cylinder along each bone, lit.
        Cylinders,
    }

    /// Which normals light the skin.
    ShowNormals {
        /// Those of the vertices.
        #[default]
        Smooth,
        /// Each triangle's own.
        Flat,
    }

    /// Which triangles are left out.
    Cull {
        /// The far side of closed, opaque skin, which cannot be seen but where a pose turns skin inside out.
        #[default]
        Auto,
        /// None.
        Never,
    }

    /// A picture that a frame can have.
    Output {
        /// The lit rig.
        #[default]
        Color,
    }

    /// What a picture is packed as.
    ImageFormat {
        /// A PNG file: RGBA, 8 bits, sRGB, straight alpha.
        #[default]
        Png,
        /// The same pixels bare: uint8 of shape `[height, width, 4]`, rows from the top.
        Rgba8,
    }

    /// How hard to compress.
    Compression {
        /// Soonest done; this is what a request that says nothing gets.
        #[default]
        Fast,
        /// A fair trade.
        Default,
        /// Smallest.
        Best,
    }
}

/// What of the rig is drawn. A rig without skin shows its skeleton, one without skeleton its skin as it was modelled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Show {
    /// Whether the skin is drawn, in the pose or as modelled. Without it, `posed`.
    pub skin: ShowSkin,
    /// The shape that joints and bones are drawn in. Without it, `none`; a rig that has no skin then gets `wireframe`.
    pub skeleton: ShowSkeleton,
    /// From 0 to 1. Below 1, what stands behind the nearest surface of the skin shines through.
    pub skin_opacity: f64,
    /// Whether the skin looks rounded or faceted. Without it, `smooth`.
    pub normals: ShowNormals,
}

impl Default for Show {
    fn default() -> Self {
        Self {
            skin: ShowSkin::default(),
            skeleton: ShowSkeleton::default(),
            skin_opacity: 1.0,
            normals: ShowNormals::default(),
        }
    }
}

/// The surface of the skin (Blinn-Phong). What is left out is as the file has it, and else a warm grey with a slight gloss.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Color that light is scattered in. Where neither this nor the file gives one, white under a texture or colors of vertices, else [0.6, 0.5, 0.42].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diffuse: Option<[f64; 3]>,
    /// Color of the highlight. Where neither this nor the file gives one, [0.14, 0.14, 0.14].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub specular: Option<[f64; 3]>,
    /// Exponent of the highlight: the higher, the smaller. Where neither this nor the file gives one, 32.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shininess: Option<f64>,
    /// Name of one of the rig's `variants`, which chooses other materials of the file. Without it, the file's own choice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variant: Option<String>,
}

/// Samples of a pixel, which are averaged: 1 or 4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Samples {
    /// Taken at one place of the pixel: edges show steps.
    One,
    /// Averaged: edges are smoothed.
    #[default]
    Four,
}

impl Serialize for Samples {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(match self {
            Self::One => 1,
            Self::Four => 4,
        })
    }
}

impl<'de> Deserialize<'de> for Samples {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match u64::deserialize(deserializer)? {
            1 => Ok(Self::One),
            4 => Ok(Self::Four),
            other => Err(D::Error::custom(format_args!(
                "expected 1 or 4, but found {other}"
            ))),
        }
    }
}

impl JsonSchema for Samples {
    fn schema_name() -> Cow<'static, str> {
        "Samples".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Samples of a pixel, which are averaged.",
            "type": "integer",
            "enum": [1, 4],
        })
    }
}

/// A picture of a rig, and what it takes to make sense of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Frame {
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// By the names in `outputs`.
    pub images: BTreeMap<String, Blob>,
    /// The camera that took the picture, with all defaults worked out.
    pub camera: FrameCamera,
    /// Digest of the rig.
    pub rig: String,
    /// The program that drew the picture.
    pub renderer: Renderer,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
    /// What this picture took, in milliseconds.
    pub timings_ms: Timings,
}

/// The camera that the picture was taken with, whatever the request's `kind`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrameCamera {
    /// Column-major. The camera looks down its own −Z, +Y up.
    pub world_from_camera: [f64; 16],
    /// Column-major. Depth is 1 at the near plane and falls toward 0 with distance.
    pub clip_from_world: [f64; 16],
    /// Focal length in pixels, across; for an orthographic camera, pixels to a unit of length.
    pub fx: f64,
    /// Focal length in pixels, down; for an orthographic camera, pixels to a unit of length.
    pub fy: f64,
    /// The pixel on the axis of the camera, from the left.
    pub cx: f64,
    /// The pixel on the axis of the camera, from the top.
    pub cy: f64,
}

/// What drew.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Renderer {
    /// `rigd`.
    pub name: String,
    /// Version of the program, as in `server.info`.
    pub version: String,
}

/// How long the parts of the work took, in milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Timings {
    /// Waiting for the renderer.
    pub queue: f64,
    /// Skinning, drawing, and copying out.
    pub render: f64,
    /// Packing what came of it.
    pub encode: f64,
}
