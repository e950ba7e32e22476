//! `frame.render`, and how any picture is drawn and packed. Never lives here: many pictures at a time.

use super::call::Call;
use super::message::{Payload, Permit};
use super::pose::of_pose;
use super::prepared_frame::{Packing, Subject};
use super::response::Responder;
use crate::encode;
use crate::engine::{JobContext, RigRef, Timings};
use crate::frame::{ImageKind, Outputs, Raster};
use crate::protocol::blob::{Blob, Picture};
use crate::protocol::frame as wire;
use crate::protocol::pose::Clamped;
use crate::protocol::{Attachments, Fault};
use crate::scene::{Camera, Size};
use bytes::Bytes;
use glam::DMat4;
use std::sync::Arc;
use std::time::Instant;

/// Bytes that a pixel takes at the most on its way out: bare, and again as base64.
const BYTES_PER_PIXEL: u64 = 10;

/// Bytes that a picture of so many pixels takes until it is written.
pub(super) fn bytes_of_picture(pixels: u64) -> u64 {
    BYTES_PER_PIXEL * pixels
}

impl Call {
    pub(super) fn render(
        &self,
        params: wire::FrameParams,
    ) -> Result<impl FnOnce(Responder) + use<>, Fault> {
        let rig = Arc::new(self.engine().rig(&params.rig)?);
        let frame = self.prepare_frame(params, &rig)?;
        let (memory, context) = self.admit(bytes_of_picture(frame.pixels()))?;
        let subject = frame.evaluate().map_err(of_pose)?;
        let call = self.clone();
        Ok(move |responder: Responder| {
            call.draw(&rig, subject, frame.packing, context, move |packed| {
                responder.respond(packed.and_then(|packed| {
                    let mut attachments = Attachments::default();
                    let frame = packed.sent(&mut attachments);
                    Payload::new(&frame, attachments, Some(Permit::new(memory)))
                }));
            });
        })
    }

    /// Draws a picture of a rig and packs it. `done` runs once.
    pub(super) fn draw(
        &self,
        rig: &RigRef,
        mut subject: Subject,
        packing: Packing,
        context: JobContext,
        done: impl FnOnce(Result<PackedFrame, Fault>) + Send + 'static,
    ) {
        let vertices = subject.posed.rig().vertex_count() as u64;
        let caption = Caption {
            size: subject.scene.size,
            camera: described(&subject.scene.camera),
            digest: rig.loaded.digest.clone(),
            clamped: std::mem::take(&mut subject.clamped),
        };
        let stats = Arc::clone(&self.service.stats);
        let pack = move |(outputs, timings): (Outputs, Timings)| {
            let started = Instant::now();
            let pack = |raster: Raster| Ok((raster.kind, packed(raster, packing)?));
            let images = outputs.images.into_iter().map(pack);
            Ok(PackedFrame {
                caption,
                images: images.collect::<Result<_, Fault>>()?,
                packing,
                timings: stats.rendered(1, vertices, timings, started.elapsed()),
            })
        };
        let engine = self.engine();
        engine.render(subject.query(&rig.loaded), context, move |drawn| {
            done(drawn.map_err(Fault::from).and_then(pack));
        });
    }
}

/// What a frame's reply says beside the pictures.
struct Caption {
    size: Size,
    camera: wire::FrameCamera,
    digest: String,
    clamped: Vec<Clamped>,
}

/// Pictures of one frame, ready to be sent.
pub(super) struct PackedFrame {
    caption: Caption,
    images: Vec<(ImageKind, Picture)>,
    packing: Packing,
    timings: wire::Timings,
}

impl PackedFrame {
    /// Its bytes go into `attachments` where they are to be attached.
    pub(super) fn sent(self, attachments: &mut Attachments) -> wire::Frame {
        let Self {
            caption,
            images,
            packing,
            timings,
        } = self;
        let Size { width, height } = caption.size;
        let mut blob = |picture| Blob::picture(picture, packing.transport, attachments);
        let images = images.into_iter();
        let images = images.map(|(kind, picture)| (name_of(kind).to_owned(), blob(picture)));
        wire::Frame {
            width,
            height,
            images: images.collect(),
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

    pub(super) fn written_bytes(&self) -> u64 {
        let images = self.images.iter();
        let bytes = images.map(|(_, picture)| picture.bytes() as u64);
        self.packing.written_bytes(bytes.sum())
    }
}

/// As the wire spells it.
fn name_of(kind: ImageKind) -> &'static str {
    match kind {
        ImageKind::Color => "color",
    }
}

fn packed(raster: Raster, packing: Packing) -> Result<Picture, Fault> {
    let Size { width, height } = raster.size;
    let file = match packing.image {
        wire::ImageFormat::Rgba8 => {
            return Ok(Picture::Rgba8 {
                width,
                height,
                pixels: Bytes::from_owner(raster.bytes),
            });
        }
        wire::ImageFormat::Png => encode::png(&raster, packing.compression),
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
    use crate::frame::Pool;
    use crate::protocol::blob::PictureTransport;

    #[test]
    fn bare_pixels_that_are_attached_go_back_to_their_pool() {
        let pool = Arc::new(Pool::of_lists());
        let size = Size {
            width: 4,
            height: 2,
        };
        let pixels = pool.take_list(32);
        let memory = pixels.as_ptr();
        let packing = Packing {
            image: wire::ImageFormat::Rgba8,
            compression: Compression::Fast,
            transport: PictureTransport::Attach,
        };
        let raster = Raster {
            kind: ImageKind::Color,
            size,
            bytes: pixels,
        };
        let picture = packed(raster, packing).unwrap();
        let mut attachments = Attachments::default();
        Blob::picture(picture, PictureTransport::Attach, &mut attachments);
        let parts = attachments.into_parts();
        assert_eq!(parts[0].as_ptr(), memory, "it was copied");
        let other = pool.take_list(32);
        assert_ne!(other.as_ptr(), memory, "it is not written yet");
        drop(parts);
        assert_eq!(pool.take_list(32).as_ptr(), memory);
    }
}
