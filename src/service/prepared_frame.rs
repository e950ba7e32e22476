//! What a frame request asks for in plain types: checked once, worked out when its turn comes. Never lives here: drawing.

use super::call::Call;
use super::file_lights;
use super::prepared_pose::{EvaluatedPose, PreparedPose};
use super::scene::skinning;
use crate::encode::Compression;
use crate::engine::RigRef;
use crate::pose::{Posed, Skinning};
use crate::protocol::blob::PictureTransport;
use crate::protocol::camera::{Lights, NamedLights};
use crate::protocol::frame as wire;
use crate::protocol::pose::Clamped;
use crate::protocol::{Fault, FieldFault};
use crate::scene::Scene;
use std::sync::Arc;

/// A picture to be drawn: everything is checked that can be told before its pose is worked out.
pub(super) struct PreparedFrame {
    pub rig: Arc<RigRef>,
    pose: Arc<PreparedPose>,
    skinning: Skinning,
    scene: Scene,
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
    pub posed: Arc<Posed>,
    pub skinning: Skinning,
    /// Values of the pose that their limits changed.
    pub clamped: Vec<Clamped>,
}

impl Call {
    pub fn prepare_frame(
        &self,
        mut params: wire::FrameParams,
        rig: &Arc<RigRef>,
    ) -> Result<PreparedFrame, Fault> {
        let pose = std::mem::take(&mut params.pose);
        self.prepare_frame_in(&params, rig, || Ok(Arc::new(self.prepare_pose(pose, rig)?)))
    }

    /// The same in a pose that `pose` prepares, after everything else is checked; that of `params` is passed over.
    pub fn prepare_frame_in(
        &self,
        params: &wire::FrameParams,
        rig: &Arc<RigRef>,
        pose: impl FnOnce() -> Result<Arc<PreparedPose>, FieldFault>,
    ) -> Result<PreparedFrame, Fault> {
        Ok(PreparedFrame {
            scene: self.scene(params, &rig.loaded)?,
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
    pub fn pixels(&self) -> u64 {
        self.scene.size.pixels() as u64
    }

    /// Works the pose out. A fault is as seen from the pose.
    pub fn evaluate(&self) -> Result<Subject, FieldFault> {
        let EvaluatedPose { posed, clamped } = self.pose.evaluate(&self.rig)?;
        let mut scene = self.scene.clone();
        if self.has_lights_of_file {
            scene.lights = file_lights::in_pose(&posed);
        }
        Ok(Subject {
            scene,
            posed,
            skinning: self.skinning,
            clamped,
        })
    }
}

impl Packing {
    /// Bytes of a picture of so many pixels as it is written, as far as they are known before it is drawn.
    pub fn least_bytes(self, pixels: u64) -> u64 {
        match self.image {
            wire::ImageFormat::Rgba8 => self.written_bytes(4 * pixels),
            // Of a plain color next to nothing is left.
            wire::ImageFormat::Png => 0,
        }
    }

    /// Bytes of a packed picture as it is written.
    pub fn written_bytes(self, bytes: u64) -> u64 {
        match self.transport {
            PictureTransport::Attach => bytes,
            // Themselves, and as text.
            PictureTransport::Base64 => bytes + bytes.div_ceil(3) * 4,
        }
    }
}

fn compression(compression: wire::Compression) -> Compression {
    match compression {
        wire::Compression::Fast => Compression::Fast,
        wire::Compression::Default => Compression::Default,
        wire::Compression::Best => Compression::Best,
    }
}
