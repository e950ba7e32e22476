//! `frame.render` and `frame.batch`.

use super::answer::Answer;
use super::batch::{Course, Items};
use super::scene::{of_output, of_skinning};
use super::{Call, describe, file_lights};
use crate::encode::{self, Compression};
use crate::engine::{FrameQuery, RigRef, Terms};
use crate::frame::{ImageKind, Raster};
use crate::pose::{Clamped, Posed};
use crate::protocol::batch::{FrameBatch, FrameBatchParams, FrameChange, FrameReady};
use crate::protocol::blob::{Blob, Picture, PictureTransport};
use crate::protocol::camera::{Lights, NamedLights};
use crate::protocol::frame as wire;
use crate::protocol::{Attachments, Fault, Id};
use crate::scene::{Appearance, Camera, Scene, Size};
use glam::DMat4;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Instant;

/// Bytes that a pixel takes at the most on its way out: bare, and again as base64.
const BYTES_PER_PIXEL: u64 = 10;

impl Call {
    pub(super) fn render(
        &self,
        params: wire::FrameParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let found = self.engine().rig(&params.rig)?;
        let subject = self.subject(&params, &found)?;
        let (held, terms) = self.take_on(bytes_of(&subject.scene))?;
        let Some(answer) = answer.take() else {
            return Ok(());
        };
        self.draw(&params, &found, subject, terms, move |done| match done {
            Ok(done) => {
                let mut attachments = Attachments::default();
                let frame = done.sent(&mut attachments);
                answer.send(&frame, attachments, Some(held));
            }
            Err(fault) => answer.fail(fault),
        });
        Ok(())
    }

    pub(super) fn render_batch(
        &self,
        params: FrameBatchParams,
        answer: &mut Option<Answer>,
    ) -> Result<(), Fault> {
        let limits = self.engine().limits();
        limits.batch_items(params.frames.len())?;
        let request_bytes = params.frames.len() * size_of::<FrameChange>() + self.attached.len();
        // As they are now, whatever is loaded or set while the batch is drawn.
        let mut rigs = BTreeMap::new();
        rigs.insert(params.rig.clone(), self.engine().rig(&params.rig)?);
        for (index, change) in params.frames.iter().enumerate() {
            if let Some(name) = change.rig.as_ref().filter(|name| !rigs.contains_key(*name)) {
                let found = self.engine().rig(name);
                let found = found.map_err(|error| Fault::from(error).within(&place(index)))?;
                rigs.insert(name.clone(), found);
            }
        }
        let items = FrameItems {
            call: self.clone(),
            params,
            rigs,
        };
        if items.count() == 0 {
            items.check(&FrameChange::default())?;
        }
        let (mut item_bytes, mut least_bytes) = (0, 0);
        for index in 0..items.count() {
            self.urgency.check()?;
            let bytes = items.check_at(index)?;
            item_bytes = item_bytes.max(bytes.most);
            least_bytes += bytes.least;
        }
        let course = Course {
            streams: items.params.stream,
            item_bytes,
            least_bytes,
            request_bytes: request_bytes as u64,
        };
        self.run_batch(items, &course, answer)
    }

    fn subject(&self, params: &wire::FrameParams, found: &RigRef) -> Result<Subject, Fault> {
        let (mut scene, appearance) = self.scene(params, &found.loaded)?;
        let (posed, clamped) = self.posed(&params.pose, found)?;
        if let Some(Lights::Named(NamedLights::File)) = params.lights {
            scene.lights = file_lights::in_pose(&posed);
        }
        Ok(Subject {
            scene,
            appearance,
            posed,
            clamped,
        })
    }

    /// Draws and packs a picture. `done` runs once.
    fn draw(
        &self,
        params: &wire::FrameParams,
        found: &RigRef,
        subject: Subject,
        terms: Terms,
        done: impl FnOnce(Result<Done, Fault>) + Send + 'static,
    ) {
        let Subject {
            scene,
            appearance,
            posed,
            clamped,
        } = subject;
        let vertices = posed.rig().vertex_count() as u64;
        let head = Head {
            size: scene.size,
            camera: described(&scene.camera),
            digest: found.loaded.digest.clone(),
            clamped: describe::clamped(posed.rig(), &clamped),
            transport: params.transport,
        };
        let (image, compression) = (params.image, of_compression(params.compression));
        let stats = Arc::clone(&self.service.stats);
        let skinning = of_skinning(params.skinning);
        let query = FrameQuery {
            outputs: kinds_of(params),
            ..FrameQuery::color(&found.loaded, posed, skinning, appearance, scene)
        };
        self.engine().render(query, terms, move |result| {
            done(result.map_err(Fault::from).and_then(|(outputs, timings)| {
                let started = Instant::now();
                let pack = |raster: Raster| {
                    let kind = raster.kind;
                    packed(raster, image, compression).map(|picture| (kind, picture))
                };
                let images = outputs.images.into_iter().map(pack);
                let images = images.collect::<Result<Vec<_>, _>>()?;
                let timings = stats.rendered(1, vertices, timings, started.elapsed());
                Ok(Done {
                    head,
                    images,
                    timings,
                })
            }));
        });
    }
}

/// What is to be drawn.
struct Subject {
    scene: Scene,
    appearance: Appearance,
    posed: Arc<Posed>,
    clamped: Vec<Clamped>,
}

fn bytes_of(scene: &Scene) -> u64 {
    BYTES_PER_PIXEL * scene.size.pixels() as u64
}

/// What a frame's reply says beside the pictures.
struct Head {
    size: Size,
    camera: wire::FrameCamera,
    digest: String,
    clamped: Vec<crate::protocol::pose::Clamped>,
    transport: PictureTransport,
}

/// Pictures, packed.
struct Done {
    head: Head,
    images: Vec<(ImageKind, Picture)>,
    timings: wire::Timings,
}

impl Done {
    /// Its bytes go into `attachments` where they are to be attached.
    fn sent(self, attachments: &mut Attachments) -> wire::Frame {
        let Self {
            head,
            images,
            timings,
        } = self;
        let Size { width, height } = head.size;
        let mut blob = |picture| Blob::picture(picture, head.transport, attachments);
        let images = images.into_iter();
        let images = images.map(|(kind, picture)| (name_of(kind).to_owned(), blob(picture)));
        wire::Frame {
            width,
            height,
            images: images.collect(),
            camera: head.camera,
            rig: head.digest,
            renderer: wire::Renderer {
                name: env!("CARGO_PKG_NAME").to_owned(),
                version: env!("CARGO_PKG_VERSION").to_owned(),
            },
            clamped: head.clamped,
            timings_ms: timings,
        }
    }
}

/// Each once, however often it is asked for.
fn kinds_of(params: &wire::FrameParams) -> BTreeSet<ImageKind> {
    params.outputs.iter().copied().map(of_output).collect()
}

/// As the wire spells it.
fn name_of(kind: ImageKind) -> &'static str {
    match kind {
        ImageKind::Color => "color",
    }
}

fn packed(
    raster: Raster,
    image: wire::ImageFormat,
    compression: Compression,
) -> Result<Picture, Fault> {
    let Size { width, height } = raster.size;
    let file = match image {
        wire::ImageFormat::Rgba8 => {
            return Ok(Picture::Rgba8 {
                width,
                height,
                pixels: raster.bytes.into_vec(),
            });
        }
        wire::ImageFormat::Png => encode::png(&raster, compression),
    };
    let file = file.map_err(|error| Fault::Internal {
        message: error.to_string(),
    })?;
    Ok(Picture::Png {
        width,
        height,
        file,
    })
}

/// The pictures of a batch.
struct FrameItems {
    call: Call,
    params: FrameBatchParams,
    /// By the names that the request uses.
    rigs: BTreeMap<String, RigRef>,
}

impl FrameItems {
    /// Whether a picture can be asked for like this, and what it takes.
    fn check(&self, change: &FrameChange) -> Result<ItemBytes, Fault> {
        let params = change.over(&self.params);
        let found = &self.rigs[&params.rig];
        let (scene, _) = self.call.scene(&params, &found.loaded)?;
        self.call.check_pose(&params.pose, found)?;
        let least = match params.image {
            wire::ImageFormat::Rgba8 => {
                let kinds = kinds_of(&params);
                let bytes = kinds.into_iter().map(|kind| kind.bytes(scene.size) as u64);
                written(bytes.sum(), params.transport)
            }
            // Of a plain color next to nothing is left.
            wire::ImageFormat::Png => 0,
        };
        Ok(ItemBytes {
            most: bytes_of(&scene),
            least,
        })
    }

    fn check_at(&self, index: usize) -> Result<ItemBytes, Fault> {
        let checked = self.check(&self.params.frames[index]);
        checked.map_err(|fault| self.located(index, fault))
    }

    /// A fault that the common part has by itself is its own; else it is told by the picture.
    fn located(&self, index: usize, fault: Fault) -> Fault {
        match self.check(&FrameChange::default()) {
            Err(of_common) if of_common == fault => fault,
            _ => fault.within(&place(index)),
        }
    }
}

fn place(index: usize) -> String {
    format!("frames[{index}]")
}

/// What a picture of a batch takes.
struct ItemBytes {
    /// Until it is written.
    most: u64,
    /// As it is written, as far as is known before it is drawn.
    least: u64,
}

impl Items for FrameItems {
    type Done = Done;
    type Sent = wire::Frame;
    const READY: &'static str = "frame.ready";

    fn count(&self) -> usize {
        self.params.frames.len()
    }

    fn begin(
        &self,
        index: usize,
        terms: Terms,
        done: impl FnOnce(Result<Done, Fault>) + Send + 'static,
    ) {
        let params = self.params.frames[index].over(&self.params);
        let found = &self.rigs[&params.rig];
        match self.call.subject(&params, found) {
            Ok(subject) => self.call.draw(&params, found, subject, terms, done),
            Err(fault) => done(Err(self.located(index, fault))),
        }
    }

    fn bytes(done: &Done) -> u64 {
        {
            let images = done.images.iter();
            let bytes = images.map(|(_, picture)| picture.bytes() as u64);
            written(bytes.sum(), done.head.transport)
        }
    }

    fn sent(done: Done, attachments: &mut Attachments) -> wire::Frame {
        done.sent(attachments)
    }

    fn ready(request: &Id, index: usize, frame: wire::Frame) -> impl Serialize {
        FrameReady {
            request: request.clone(),
            index: index as u64,
            frame,
        }
    }

    fn result(&self, frames: Option<Vec<wire::Frame>>) -> impl Serialize {
        FrameBatch {
            frame_count: self.count() as u64,
            frames,
        }
    }
}

fn written(bytes: u64, transport: PictureTransport) -> u64 {
    match transport {
        PictureTransport::Attach => bytes,
        // Themselves, and as text.
        PictureTransport::Base64 => bytes + bytes.div_ceil(3) * 4,
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
