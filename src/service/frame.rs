//! `frame.render`.

use super::answer::Answer;
use super::scene::of_skinning;
use super::{Call, describe};
use crate::encode::{self, Compression};
use crate::engine::{HeldBytes, Timings};
use crate::frame::Frame;
use crate::protocol::blob::{Blob, Picture};
use crate::protocol::frame as wire;
use crate::protocol::{Attachments, Fault};
use crate::scene::{Camera, Size};
use glam::DMat4;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Bytes that a pixel takes at the most on its way out: bare, and again as base64.
const BYTES_PER_PIXEL: u64 = 10;

impl Call<'_> {
    pub(super) fn render(
        &self,
        params: wire::FrameParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let found = self.engine().rig(&params.rig)?;
        let scene = self.scene(&params, &found.loaded)?;
        let (posed, clamped) = self.posed(&params.pose, &found)?;
        let (held, terms) = self.take_on(BYTES_PER_PIXEL * scene.size.pixels() as u64)?;

        let reply = FrameReply {
            camera: described(&scene.camera),
            vertices: posed.rig().vertex_count() as u64,
            digest: found.loaded.digest.clone(),
            clamped: describe::clamped(posed.rig(), &clamped),
            image: params.image,
            compression: params.compression,
            transport: params.transport,
        };
        let Some(answer) = answer.take() else {
            return Ok(());
        };
        let stats = Arc::clone(&self.service.stats);
        self.engine().render(
            &found.loaded,
            posed,
            of_skinning(params.skinning),
            scene,
            terms,
            move |result| match result {
                Ok((frame, timings)) => {
                    stats.rendered(1, reply.vertices, timings.render);
                    reply.send(answer, frame, timings, held);
                }
                Err(error) => answer.fail(error.into()),
            },
        );
        Ok(())
    }
}

/// What a frame's reply says beside the picture.
struct FrameReply {
    camera: wire::FrameCamera,
    vertices: u64,
    digest: String,
    clamped: Vec<crate::protocol::pose::Clamped>,
    image: wire::ImageFormat,
    compression: wire::Compression,
    transport: crate::protocol::blob::PictureTransport,
}

impl FrameReply {
    fn send(self, answer: Answer, frame: Frame, timings: Timings, held: HeldBytes) {
        let started = Instant::now();
        let Size { width, height } = frame.size;
        let picture = match self.image {
            wire::ImageFormat::Rgba8 => Picture::Rgba8 {
                width,
                height,
                pixels: frame.pixels.into_vec(),
            },
            wire::ImageFormat::Png => match encode::png(&frame, of_compression(self.compression)) {
                Ok(file) => Picture::Png(file),
                Err(error) => {
                    return answer.fail(Fault::Internal {
                        message: error.to_string(),
                    });
                }
            },
        };
        let mut attachments = Attachments::default();
        let color = Blob::picture(picture, self.transport, &mut attachments);
        let milliseconds = |duration: std::time::Duration| duration.as_secs_f64() * 1e3;
        let result = wire::Frame {
            width,
            height,
            images: BTreeMap::from([("color".to_owned(), color)]),
            camera: self.camera,
            rig: self.digest,
            renderer: wire::Renderer {
                name: env!("CARGO_PKG_NAME").to_owned(),
                version: env!("CARGO_PKG_VERSION").to_owned(),
            },
            clamped: self.clamped,
            timings_ms: wire::Timings {
                queue: milliseconds(timings.queue),
                render: milliseconds(timings.render),
                encode: milliseconds(started.elapsed()),
            },
        };
        answer.send(&result, attachments, Some(held));
    }
}

fn of_compression(compression: wire::Compression) -> Compression {
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
