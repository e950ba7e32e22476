//! `frame.render`: what to draw, and the picture.
//! Never lives here: cameras and lights, which have a file of their own, and the ranges that numbers must be in.

use super::blob::{Blob, PictureTransport};
use super::camera::{Camera, Lights};
use super::pose::{Clamped, Pose};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A type with the fields of a frame request and some more: serde's `flatten` would let unknown fields through.
macro_rules! frame_request {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            /// Name or digest of a loaded rig.
            pub rig: String,
            /// A pose for this request alone. Without it, as if it were `{}`.
            #[serde(default)]
            pub pose: Pose,
            #[serde(default)]
            pub skinning: Skinning,
            #[serde(default)]
            pub show: Show,
            #[serde(default)]
            pub camera: Camera,
            /// A list of at most 16, or `file`. Without it, a warm key light and a cool fill; an empty list leaves the ambient light alone.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("default" = crate::protocol::camera::default_lights()))]
            pub lights: Option<Lights>,
            /// Light from everywhere. Without it, just enough to see into the shadows.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("default" = [0.055, 0.06, 0.08]))]
            pub ambient: Option<[f64; 3]>,
            #[serde(default)]
            pub material: Material,
            /// What stands behind the rig, with straight alpha. Without it, an opaque dark slate.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(extend("default" = [0.012, 0.016, 0.024, 1.0]))]
            pub background: Option<[f64; 4]>,
            #[serde(default)]
            pub cull: Cull,
            /// Width and height in pixels.
            #[serde(default = "crate::protocol::frame::default_size")]
            pub size: [u32; 2],
            #[serde(default)]
            pub samples: Samples,
            /// Which pictures to send.
            #[serde(default = "crate::protocol::frame::color_alone")]
            pub outputs: Vec<Output>,
            #[serde(default)]
            pub image: ImageFormat,
            /// How hard to compress a PNG.
            #[serde(default)]
            pub compression: Compression,
            #[serde(default)]
            pub transport: PictureTransport,
            $($(#[$field_doc])* pub $field: $type,)*
        }

        impl $name {
            /// The frame request in it.
            pub fn frame(&self) -> FrameParams {
                FrameParams {
                    rig: self.rig.clone(),
                    pose: self.pose.clone(),
                    skinning: self.skinning,
                    show: self.show,
                    camera: self.camera.clone(),
                    lights: self.lights.clone(),
                    ambient: self.ambient,
                    material: self.material.clone(),
                    background: self.background,
                    cull: self.cull,
                    size: self.size,
                    samples: self.samples,
                    outputs: self.outputs.clone(),
                    image: self.image,
                    compression: self.compression,
                    transport: self.transport,
                }
            }
        }
    };
}

pub(super) use frame_request;

frame_request! {
    /// Asks for a picture of a rig. Colors are linear RGB from 0 to 1.
    FrameParams {}
}

impl FrameParams {
    /// A picture of this rig with everything else left to its default.
    pub fn of(rig: impl Into<String>) -> Self {
        Self {
            rig: rig.into(),
            pose: Pose::default(),
            skinning: Skinning::default(),
            show: Show::default(),
            camera: Camera::default(),
            lights: None,
            ambient: None,
            material: Material::default(),
            background: None,
            cull: Cull::default(),
            size: default_size(),
            samples: Samples::default(),
            outputs: color_alone(),
            image: ImageFormat::default(),
            compression: Compression::default(),
            transport: PictureTransport::default(),
        }
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
    pub skin: ShowSkin,
    pub skeleton: ShowSkeleton,
    /// From 0 to 1. Below 1, what stands behind the nearest surface of the skin shines through.
    pub skin_opacity: f64,
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
    /// Color that light is scattered in. Where neither this nor the file gives one, white under a texture and else [0.6, 0.5, 0.42].
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
    One,
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
    pub camera: FrameCamera,
    /// Digest of the rig.
    pub rig: String,
    pub renderer: Renderer,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
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
    pub name: String,
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
