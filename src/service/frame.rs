//! `frame.render`, and how any picture is drawn and packed. Never lives here: many pictures at a time.

use super::call::Call;
use super::message::{Payload, Permit};
use super::pose::of_pose;
use super::prepared_frame::{Packing, Subject};
use super::response::Responder;
use crate::encode;
use crate::engine::{RigRef, Terms};
use crate::frame::Frame;
use crate::protocol::blob::{Blob, Picture};
use crate::protocol::frame as wire;
use crate::protocol::pose::Clamped;
use crate::protocol::{Attachments, Fault};
use crate::scene::{Camera, Size};
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
        params: wire::FrameParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        let rig = Arc::new(self.engine().rig(&params.rig)?);
        let frame = self.prepare_frame(params, &rig)?;
        let (memory, terms) = self.admit(bytes_of_picture(frame.pixels()))?;
        let subject = frame.evaluate().map_err(of_pose)?;
        let call = self.clone();
        Ok(move |responder: Responder| {
            call.draw(&rig, subject, frame.packing, terms, move |packed| {
                responder.respond(packed.and_then(|packed| {
                    let mut attachments = Attachments::default();
                    let frame = packed.sent(&mut attachments);
                    Payload::new(&frame, attachments, Some(Permit::new(memory)))
                }));
            });
        })
    }

    /// Draws a picture of a rig and packs it. `done` runs once.
    pub fn draw(
        &self,
        rig: &RigRef,
        subject: Subject,
        packing: Packing,
        terms: Terms,
        done: impl FnOnce(Result<PackedFrame, Fault>) + Send + 'static,
    ) {
        let Subject {
            scene,
            posed,
            skinning,
            clamped,
        } = subject;
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
                packing,
                timings: stats.rendered(1, vertices, timings, started.elapsed()),
            })
        };
        let engine = self.engine();
        engine.render(&rig.loaded, posed, skinning, scene, terms, move |drawn| {
            done(drawn.map_err(Fault::from).and_then(pack));
        });
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
    packing: Packing,
    timings: wire::Timings,
}

impl PackedFrame {
    /// Its bytes go into `attachments` where they are to be attached.
    pub fn sent(self, attachments: &mut Attachments) -> wire::Frame {
        let Self {
            caption,
            picture,
            packing,
            timings,
        } = self;
        let [width, height] = picture.size();
        let color = Blob::picture(picture, packing.transport, attachments);
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

    pub fn written_bytes(&self) -> u64 {
        self.packing.written_bytes(self.picture.bytes() as u64)
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
    use crate::encode::Compression;
    use crate::frame::Spare;
    use crate::protocol::blob::PictureTransport;

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
