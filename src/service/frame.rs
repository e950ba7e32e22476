//! `frame.render`.

use super::answer::Answer;
use super::{Call, describe, fault};
use crate::encode::{self, Compression};
use crate::engine::{EngineError, HeldBytes, Terms, Timings};
use crate::frame::Frame;
use crate::protocol::blob::{Blob, Picture};
use crate::protocol::camera as wire_camera;
use crate::protocol::frame as wire;
use crate::protocol::{Attachments, Fault};
use crate::scene::{
    Background, Bounds, Camera, Color, Falloff, Light, LookAt, Near, Orbit, Pinhole, Samples,
    Scene, Show, ShowNormals, ShowSkeleton, ShowSkin, Size, Surface,
};
use glam::{DMat4, DVec3};
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
        let scene = self.scene(&params, &found.loaded.rest_bounds)?;
        let (posed, clamped) = self.posed(&params.pose, &found)?;
        let held = self
            .engine()
            .admission()
            .hold(BYTES_PER_PIXEL * scene.size.pixels() as u64);
        let held = held.map_err(|error| self.busy(error))?;
        let ticket = self
            .engine()
            .admission()
            .admit()
            .map_err(|error| self.busy(error))?;

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
        let terms = Terms {
            urgency: self.urgency.clone(),
            ticket,
        };
        self.engine().render(
            &found.loaded,
            posed,
            scene,
            terms,
            move |result| match result {
                Ok((frame, timings)) => {
                    stats.rendered(1, reply.vertices, timings.render);
                    reply.send(answer, &frame, timings, held);
                }
                Err(error) => answer.fail(error.into()),
            },
        );
        Ok(())
    }

    fn scene(&self, params: &wire::FrameParams, framed: &Bounds) -> Result<Scene, Fault> {
        let limits = self.engine().limits();
        let [width, height] = params.size;
        let size = Size::new(width, height, limits).map_err(EngineError::from)?;
        self.engine().capabilities().accept_size(size)?;
        if params.outputs.is_empty() {
            return Err(Fault::invalid_params(
                "outputs",
                "expected at least one output, but found none",
            ));
        }
        let lights = match &params.lights {
            None => Light::default_pair(),
            Some(lights) => {
                limits.lights(lights.len())?;
                let light =
                    |(index, light)| of_light(light).map_err(|error| fault::of_light(index, error));
                lights
                    .iter()
                    .enumerate()
                    .map(light)
                    .collect::<Result<_, _>>()?
            }
        };
        let scene = || -> Result<Scene, crate::scene::SceneError> {
            Ok(Scene {
                size,
                samples: match params.samples {
                    wire::Samples::One => Samples::One,
                    wire::Samples::Four => Samples::Four,
                },
                camera: of_camera(&params.camera, framed, size)?,
                lights,
                ambient: params
                    .ambient
                    .map_or(Ok(Scene::DEFAULT_AMBIENT), |ambient| {
                        Color::new(ambient, "ambient")
                    })?,
                surface: of_material(&params.material)?,
                background: params
                    .background
                    .map_or(Ok(Background::default()), Background::new)?,
                show: of_show(&params.show)?,
            })
        };
        scene().map_err(|error| EngineError::from(error).into())
    }

    /// With a guess at when the renderer will have room again.
    pub(super) fn busy(&self, error: EngineError) -> Fault {
        match error {
            EngineError::Busy { queue_depth } => {
                let drained = self.service.stats.mean_render()
                    * u32::try_from(queue_depth).unwrap_or(u32::MAX)
                    / 2;
                let retry_after_ms = (drained.as_millis() as u64).clamp(10, 5_000);
                Fault::Busy {
                    retry_after_ms,
                    queue_depth,
                }
            }
            other => other.into(),
        }
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
    fn send(self, answer: Answer, frame: &Frame, timings: Timings, held: HeldBytes) {
        let started = Instant::now();
        let Size { width, height } = frame.size;
        let picture = match self.image {
            wire::ImageFormat::Rgba8 => Picture::Rgba8 {
                width,
                height,
                pixels: frame.pixels.clone(),
            },
            wire::ImageFormat::Png => match encode::png(frame, of_compression(self.compression)) {
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

fn of_camera(
    camera: &wire_camera::Camera,
    framed: &Bounds,
    size: Size,
) -> Result<Camera, crate::scene::SceneError> {
    match camera {
        wire_camera::Camera::Orbit(orbit) => {
            let wire_camera::Orbit {
                target,
                distance,
                azimuth,
                inclination,
                fov_y,
                near,
            } = *orbit;
            let target = target.map(DVec3::from_array);
            Camera::orbit(
                Orbit {
                    target,
                    distance,
                    azimuth,
                    inclination,
                    fov_y,
                    near: Near(near),
                },
                framed,
                size,
            )
        }
        wire_camera::Camera::LookAt(look) => {
            let wire_camera::LookAt {
                eye,
                target,
                up,
                fov_y,
                height,
                near,
            } = *look;
            let (eye, target) = (DVec3::from_array(eye), DVec3::from_array(target));
            let up = up.map_or(DVec3::Y, DVec3::from_array);
            Camera::look_at(
                LookAt {
                    eye,
                    target,
                    up,
                    fov_y,
                    height,
                    near: Near(near),
                },
                framed,
                size,
            )
        }
        wire_camera::Camera::Pinhole(pinhole) => {
            let wire_camera::Pinhole {
                fx,
                fy,
                cx,
                cy,
                world_from_camera,
                axes,
                near,
            } = *pinhole;
            let given = DMat4::from_cols_array(&world_from_camera);
            let world_from_camera = match axes {
                wire_camera::Axes::Gl => given,
                wire_camera::Axes::Cv => given * DMat4::from_scale(DVec3::new(1.0, -1.0, -1.0)),
            };
            Camera::pinhole(
                Pinhole {
                    fx,
                    fy,
                    cx,
                    cy,
                    world_from_camera,
                    near: Near(near),
                },
                framed,
                size,
            )
        }
    }
}

fn of_light(light: &wire_camera::Light) -> Result<Light, crate::scene::SceneError> {
    let white = [1.0; 3];
    match light {
        wire_camera::Light::Directional(light) => {
            let color = Color::new(light.color.unwrap_or(white), "lights.color")?;
            Light::directional(
                DVec3::from_array(light.direction),
                color,
                light.intensity.unwrap_or(1.0),
            )
        }
        wire_camera::Light::Point(light) => {
            let color = Color::new(light.color.unwrap_or(white), "lights.color")?;
            let falloff = match light.falloff {
                wire_camera::Falloff::None => Falloff::None,
                wire_camera::Falloff::InverseSquare => Falloff::InverseSquare,
            };
            Light::point(
                DVec3::from_array(light.position),
                color,
                light.intensity.unwrap_or(1.0),
                falloff,
            )
        }
    }
}

fn of_material(material: &wire::Material) -> Result<Surface, crate::scene::SceneError> {
    let Surface {
        diffuse,
        specular,
        shininess,
    } = Surface::default();
    Surface::new(
        material.diffuse.map_or(Ok(diffuse), |diffuse| {
            Color::new(diffuse, "material.diffuse")
        })?,
        material.specular.map_or(Ok(specular), |specular| {
            Color::new(specular, "material.specular")
        })?,
        material.shininess.unwrap_or(f64::from(shininess)),
    )
}

fn of_show(show: &wire::Show) -> Result<Show, crate::scene::SceneError> {
    let skin = match show.skin {
        wire::ShowSkin::Posed => ShowSkin::Posed,
        wire::ShowSkin::Bind => ShowSkin::Bind,
        wire::ShowSkin::None => ShowSkin::None,
    };
    let skeleton = match show.skeleton {
        wire::ShowSkeleton::None => ShowSkeleton::None,
        wire::ShowSkeleton::Wireframe => ShowSkeleton::Wireframe,
    };
    let normals = match show.normals {
        wire::ShowNormals::Smooth => ShowNormals::Smooth,
        wire::ShowNormals::Flat => ShowNormals::Flat,
    };
    Show::new(skin, skeleton, normals, show.skin_opacity)
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
