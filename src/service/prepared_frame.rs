//! What a frame request asks for in plain types: checked once, worked out when its turn comes. Never lives here: drawing.

use super::appearance::skinning;
use super::call::Call;
use super::file_lights;
use super::prepared_pose::{EvaluatedPose, PreparedPose};
use super::scene::image_kinds;
use crate::encode::Compression;
use crate::engine::{FrameQuery, LoadedRig, RigRef};
use crate::frame::ImageKind;
use crate::pose::{Posed, Skinning};
use crate::protocol::blob::PictureTransport;
use crate::protocol::camera::{Lights, NamedLights};
use crate::protocol::frame as wire;
use crate::protocol::pose::Clamped;
use crate::protocol::{Fault, FieldFault};
use crate::scene::{Appearance, Scene};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A picture to be drawn: everything is checked that can be told before its pose is worked out.
pub(super) struct PreparedFrame {
    pub rig: Arc<RigRef>,
    pose: Arc<PreparedPose>,
    skinning: Skinning,
    scene: Scene,
    appearance: Appearance,
    outputs: BTreeSet<ImageKind>,
    /// Whether the lights are those of the rig's file, which depend on the pose.
    has_lights_of_file: bool,
    pub packing: Packing,
}

/// How a picture is packed.
#[derive(Clone, Copy)]
pub(super) struct Packing {
    pub image: wire::ImageFormat,
    pub compression: Compression,
    pub transport: PictureTransport,
}

/// What is to be drawn.
pub struct Subject {
    pub scene: Scene,
    pub outputs: BTreeSet<ImageKind>,
    pub appearance: Appearance,
    pub posed: Arc<Posed>,
    pub skinning: Skinning,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
}

impl Call {
    pub(super) fn prepare_frame(
        &self,
        mut params: wire::FrameParams,
        rig: &Arc<RigRef>,
    ) -> Result<PreparedFrame, Fault> {
        let pose = std::mem::take(&mut params.pose);
        self.prepare_frame_in(&params, rig, || Ok(Arc::new(self.prepare_pose(pose, rig)?)))
    }

    /// The same in a pose that `pose` prepares, after everything else is checked; that of `params` is passed over.
    pub(super) fn prepare_frame_in(
        &self,
        params: &wire::FrameParams,
        rig: &Arc<RigRef>,
        pose: impl FnOnce() -> Result<Arc<PreparedPose>, FieldFault>,
    ) -> Result<PreparedFrame, Fault> {
        let (scene, appearance) = self.scene(params, &rig.loaded)?;
        Ok(PreparedFrame {
            scene,
            appearance,
            outputs: image_kinds(params),
            pose: pose()?,
            skinning: skinning(params.skinning),
            has_lights_of_file: matches!(params.lights, Some(Lights::Named(NamedLights::File))),
            packing: Packing {
                image: params.image,
                compression: compression(params.compression),
                transport: params.transport,
            },
            rig: Arc::clone(rig),
        })
    }
}

impl PreparedFrame {
    pub(super) fn pixels(&self) -> u64 {
        self.scene.size.pixels() as u64
    }

    /// Bytes of its pictures as they are written, as far as they are known before they are drawn.
    pub(super) fn least_bytes(&self) -> u64 {
        let bytes = |kind: &ImageKind| kind.bytes(self.scene.size) as u64;
        match self.packing.image {
            wire::ImageFormat::Rgba8 => {
                let bytes = self.outputs.iter().map(bytes).sum();
                self.packing.written_bytes(bytes)
            }
            // Of a plain color next to nothing is left.
            wire::ImageFormat::Png => 0,
        }
    }

    /// Works the pose out. A fault is as seen from the pose.
    pub(super) fn evaluate(&self) -> Result<Subject, FieldFault> {
        let EvaluatedPose { posed, clamped } = self.pose.evaluate(&self.rig)?;
        let mut scene = self.scene.clone();
        if self.has_lights_of_file {
            scene.lights = file_lights::in_pose(&posed);
        }
        Ok(Subject {
            scene,
            outputs: self.outputs.clone(),
            appearance: self.appearance,
            posed,
            skinning: self.skinning,
            clamped,
        })
    }
}

impl Subject {
    /// What to ask the engine for; `loaded` is the rig.
    pub fn query(self, loaded: &LoadedRig) -> FrameQuery {
        let Self {
            scene,
            outputs,
            appearance,
            posed,
            skinning,
            ..
        } = self;
        FrameQuery {
            outputs,
            ..FrameQuery::color(loaded, posed, skinning, appearance, scene)
        }
    }
}

impl Packing {
    /// Bytes of packed pictures as they are written.
    pub(super) fn written_bytes(self, bytes: u64) -> u64 {
        match self.transport {
            PictureTransport::Attach => bytes,
            // Themselves, and as text.
            PictureTransport::Base64 => bytes + bytes.div_ceil(3) * 4,
        }
    }
}

pub(crate) fn compression(compression: wire::Compression) -> Compression {
    match compression {
        wire::Compression::Fast => Compression::Fast,
        wire::Compression::Default => Compression::Balanced,
        wire::Compression::Best => Compression::Best,
    }
}
