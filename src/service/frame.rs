//! `frame.render`, and how any picture is prepared, drawn and packed. Never lives here: many pictures at a time.

use super::call::Call;
use super::file_lights;
use super::message::{Payload, Permit};
use super::pose::of_pose;
use super::prepared_pose::{EvaluatedPose, PreparedPose};
use super::response::Responder;
use super::scene::skinning;
use crate::encode::{self, Compression};
use crate::engine::{RigRef, Terms};
use crate::frame::Frame;
use crate::pose::Skinning;
use crate::protocol::blob::{Blob, Picture, PictureTransport};
use crate::protocol::camera::{Lights, NamedLights};
use crate::protocol::frame as wire;
use crate::protocol::pose::Clamped;
use crate::protocol::{Attachments, Fault, FieldFault};
use crate::scene::{Camera, Scene, Size};
use bytes::Bytes;
use glam::DMat4;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Bytes that a pixel takes at the most on its way out: bare, and again as base64.
const BYTES_PER_PIXEL: u64 = 10;

/// Bytes that a picture of so many pixels takes until it is written.
pub(super) fn bytes_of_picture(pixels: u64) -> u64 {
    BYTES_PER_PIXEL * pixels
}

impl Call {
    pub fn render(
        &self,
        mut params: wire::FrameParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        let rig = Arc::new(self.engine().rig(&params.rig)?);
        let scene = self.scene(&params, &rig.loaded)?;
        let pose = self.prepare_pose(std::mem::take(&mut params.pose), &rig)?;
        let frame = PreparedFrame::new(&params, rig, Arc::new(pose), scene);
        let (memory, terms) = self.admit(bytes_of_picture(frame.scene.size.pixels() as u64))?;
        let pose = frame.evaluate().map_err(of_pose)?;
        let call = self.clone();
        Ok(move |responder: Responder| {
            call.draw(frame, pose, terms, move |packed| {
                responder.respond(packed.and_then(|packed| {
                    let mut attachments = Attachments::default();
                    let frame = packed.sent(&mut attachments);
                    Payload::new(&frame, attachments, Some(Permit::new(memory)))
                }));
            });
        })
    }

    /// Draws a picture and packs it. `pose` is the one that it has asked for. `done` runs once.
    pub fn draw(
        &self,
        frame: PreparedFrame,
        pose: EvaluatedPose,
        terms: Terms,
        done: impl FnOnce(Result<PackedFrame, Fault>) + Send + 'static,
    ) {
        let PreparedFrame {
            rig,
            skinning,
            mut scene,
            lights_of_file,
            packing,
            ..
        } = frame;
        let EvaluatedPose { posed, clamped } = pose;
        if lights_of_file {
            scene.lights = file_lights::in_pose(&posed);
        }
        let vertices = posed.rig().vertex_count() as u64;
        let caption = Caption {
            camera: described(&scene.camera),
            digest: rig.loaded.digest.clone(),
            clamped,
        };
        let stats = Arc::clone(&self.service.stats);
        let pack = move |(frame, timings)| {
            let started = Instant::now();
            let picture = packed(frame, packing)?;
            Ok(PackedFrame {
                caption,
                picture,
                transport: packing.transport,
                timings: stats.rendered(1, vertices, timings, started.elapsed()),
            })
        };
        let engine = self.engine();
        engine.render(&rig.loaded, posed, skinning, scene, terms, move |drawn| {
            done(drawn.map_err(Fault::from).and_then(pack));
        });
    }
}

/// A picture to be drawn, in plain types: everything is checked that can be told before its pose is worked out.
pub(super) struct PreparedFrame {
    pub rig: Arc<RigRef>,
    pub pose: Arc<PreparedPose>,
    pub skinning: Skinning,
    pub scene: Scene,
    /// Whether the lights are those of the rig's file, which depend on the pose.
    pub lights_of_file: bool,
    pub packing: Packing,
}

/// How a picture is packed.
#[derive(Clone, Copy)]
pub(super) struct Packing {
    pub image: wire::ImageFormat,
    pub compression: Compression,
    pub transport: PictureTransport,
}

impl PreparedFrame {
    /// The pose of `params` is passed over.
    pub fn new(
        params: &wire::FrameParams,
        rig: Arc<RigRef>,
        pose: Arc<PreparedPose>,
        scene: Scene,
    ) -> Self {
        Self {
            rig,
            pose,
            skinning: skinning(params.skinning),
            scene,
            lights_of_file: matches!(params.lights, Some(Lights::Named(NamedLights::File))),
            packing: Packing {
                image: params.image,
                compression: compression(params.compression),
                transport: params.transport,
            },
        }
    }

    /// Works the pose out. A fault is as seen from the pose.
    pub fn evaluate(&self) -> Result<EvaluatedPose, FieldFault> {
        self.pose.evaluate(&self.rig)
    }

    /// Bytes as it is written, as far as they are known before it is drawn.
    pub fn least_bytes(&self) -> u64 {
        let pixels = self.scene.size.pixels() as u64;
        match self.packing.image {
            wire::ImageFormat::Rgba8 => written_bytes(4 * pixels, self.packing.transport),
            // Of a plain color next to nothing is left.
            wire::ImageFormat::Png => 0,
        }
    }
}

/// What a frame's reply says beside the picture.
struct Caption {
    camera: wire::FrameCamera,
    digest: String,
    clamped: Vec<Clamped>,
}

/// A picture, ready to be sent.
pub(super) struct PackedFrame {
    caption: Caption,
    picture: Picture,
    transport: PictureTransport,
    timings: wire::Timings,
}

impl PackedFrame {
    /// Its bytes go into `attachments` where they are to be attached.
    pub fn sent(self, attachments: &mut Attachments) -> wire::Frame {
        let Self {
            caption,
            picture,
            transport,
            timings,
        } = self;
        let [width, height] = picture.size();
        let color = Blob::picture(picture, transport, attachments);
        wire::Frame {
            width,
            height,
            images: BTreeMap::from([("color".to_owned(), color)]),
            camera: caption.camera,
            rig: caption.digest,
            renderer: wire::Renderer {
                name: env!("CARGO_PKG_NAME").to_owned(),
                version: env!("CARGO_PKG_VERSION").to_owned(),
            },
            clamped: caption.clamped,
            timings_ms: timings,
        }
    }

    /// As it is written.
    pub fn written_bytes(&self) -> u64 {
        written_bytes(self.picture.bytes() as u64, self.transport)
    }
}

fn packed(frame: Frame, packing: Packing) -> Result<Picture, Fault> {
    let Size { width, height } = frame.size;
    let file = match packing.image {
        wire::ImageFormat::Rgba8 => {
            return Ok(Picture::Rgba8 {
                width,
                height,
                pixels: Bytes::from_owner(frame.pixels),
            });
        }
        wire::ImageFormat::Png => encode::png(&frame, packing.compression),
    };
    let file = file.map_err(|error| Fault::Internal {
        message: error.to_string(),
    })?;
    Ok(Picture::Png {
        width,
        height,
        file: file.into(),
    })
}

fn written_bytes(bytes: u64, transport: PictureTransport) -> u64 {
    match transport {
        PictureTransport::Attach => bytes,
        // Themselves, and as text.
        PictureTransport::Base64 => bytes + bytes.div_ceil(3) * 4,
    }
}

fn compression(compression: wire::Compression) -> Compression {
    match compression {
        wire::Compression::Fast => Compression::Fast,
        wire::Compression::Default => Compression::Default,
        wire::Compression::Best => Compression::Best,
    }
}

fn described(camera: &Camera) -> wire::FrameCamera {
    let [fx, fy, cx, cy] = camera.intrinsics();
    wire::FrameCamera {
        world_from_camera: DMat4::from(camera.world_from_camera()).to_cols_array(),
        clip_from_world: camera.clip_from_world().to_cols_array(),
        fx,
        fy,
        cx,
        cy,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Spare;

    #[test]
    fn bare_pixels_that_are_attached_go_back_to_their_pool() {
        let pool = Arc::new(Spare::default());
        let size = Size {
            width: 4,
            height: 2,
        };
        let pixels = pool.take(32);
        let memory = pixels.as_ptr();
        let packing = Packing {
            image: wire::ImageFormat::Rgba8,
            compression: Compression::Fast,
            transport: PictureTransport::Attach,
        };
        let picture = packed(Frame { size, pixels }, packing).unwrap();
        let mut attachments = Attachments::default();
        Blob::picture(picture, PictureTransport::Attach, &mut attachments);
        let parts = attachments.into_parts();
        assert_eq!(parts[0].as_ptr(), memory, "it was copied");
        let other = pool.take(32);
        assert_ne!(other.as_ptr(), memory, "it is not written yet");
        drop(parts);
        assert_eq!(pool.take(32).as_ptr(), memory);
    }
}
