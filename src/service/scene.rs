//! From the fields of a frame request to a [`Scene`].

use super::call::Call;
use super::fault;
use super::names::unknown;
use crate::engine::LoadedRig;
use crate::frame::ImageKind;
use crate::pose::Skinning;
use crate::protocol::camera as wire_camera;
use crate::protocol::frame as wire;
use crate::protocol::{Fault, FieldFault};
use crate::rig::Rig;
use crate::scene::{
    Appearance, Background, Bounds, Camera, CameraError, Color, Cull, Falloff, Light, LookAt, Near,
    Orbit, Pinhole, Samples, Scene, Show, ShowNormals, ShowSkeleton, ShowSkin, Size, Surface,
};
use glam::{DMat4, DVec3};
use std::collections::BTreeSet;

impl Call {
    /// `rig` is what the default camera frames. Lights of its file are left out: they depend on the pose, and evaluating a frame adds them.
    pub(super) fn scene(
        &self,
        params: &wire::FrameParams,
        rig: &LoadedRig,
    ) -> Result<(Scene, Appearance), Fault> {
        let limits = self.engine().limits();
        let [width, height] = params.size;
        let size = Size::new(width, height, limits).map_err(fault::of_size)?;
        let capabilities = self.engine().capabilities();
        for kind in image_kinds(params) {
            capabilities.accept_raster(kind, size)?;
        }
        if params.outputs.is_empty() {
            return Err(Fault::invalid_params(
                "outputs",
                "expected at least one output, but found none",
            ));
        }
        let lights = match &params.lights {
            None => Light::default_pair(),
            Some(wire_camera::Lights::Named(wire_camera::NamedLights::File)) => {
                if rig.rig.lights().is_empty() {
                    let problem = "expected a rig with lights in its file, but found none in it";
                    return Err(Fault::invalid_params("lights", problem));
                }
                Vec::new()
            }
            Some(wire_camera::Lights::Given(lights)) => {
                limits.lights(lights.len())?;
                let light = |(index, light)| {
                    light_of(light).map_err(|fault| fault.within(("lights", index)))
                };
                lights
                    .iter()
                    .enumerate()
                    .map(light)
                    .collect::<Result<_, _>>()?
            }
        };
        let of_material = |fault: FieldFault| fault.within("material");
        let variant = variant(&params.material, &rig.rig).map_err(of_material)?;
        let show = show(&params.show).map_err(|fault| fault.within("show"))?;
        let camera = camera(&params.camera, &rig.extents.framed(&show), size)
            .map_err(|error| FieldFault::from(error).within("camera"))?;
        let ambient = params
            .ambient
            .map_or(Ok(Scene::DEFAULT_AMBIENT), Color::new);
        let ambient = ambient.map_err(fault::at("ambient"))?;
        let surface = surface(&params.material).map_err(of_material)?;
        let background = params
            .background
            .map_or(Ok(Background::default()), Background::new)
            .map_err(fault::at("background"))?;
        let scene = Scene {
            size,
            samples: match params.samples {
                wire::Samples::One => Samples::One,
                wire::Samples::Four => Samples::Four,
            },
            camera,
            lights,
            ambient,
            background,
        };
        let appearance = Appearance {
            show,
            surface: Surface { variant, ..surface },
            cull: match params.cull {
                wire::Cull::Auto => Cull::Auto,
                wire::Cull::Never => Cull::Never,
            },
        };
        Ok((scene, appearance))
    }
}

fn camera(
    camera: &wire_camera::Camera,
    framed: &Bounds,
    size: Size,
) -> Result<Camera, CameraError> {
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

fn light_of(light: &wire_camera::Light) -> Result<Light, FieldFault> {
    let color = |given: Option<[f64; 3]>| {
        let white = [1.0; 3];
        Color::new(given.unwrap_or(white)).map_err(fault::at("color"))
    };
    match light {
        wire_camera::Light::Directional(light) => {
            let direction = DVec3::from_array(light.direction);
            let color = color(light.color)?;
            Ok(Light::directional(
                direction,
                color,
                light.intensity.unwrap_or(1.0),
            )?)
        }
        wire_camera::Light::Point(light) => {
            let color = color(light.color)?;
            let falloff = match light.falloff {
                wire_camera::Falloff::None => Falloff::None,
                wire_camera::Falloff::InverseSquare => Falloff::InverseSquare,
            };
            Ok(Light::point(
                DVec3::from_array(light.position),
                color,
                light.intensity.unwrap_or(1.0),
                falloff,
            )?)
        }
    }
}

/// What is asked for, each kind once.
pub(super) fn image_kinds(params: &wire::FrameParams) -> BTreeSet<ImageKind> {
    let kind = |output: &wire::Output| match output {
        wire::Output::Color => ImageKind::Color,
    };
    params.outputs.iter().map(kind).collect()
}

pub(super) fn skinning(skinning: wire::Skinning) -> Skinning {
    match skinning {
        wire::Skinning::Linear => Skinning::Linear,
        wire::Skinning::DualQuaternion => Skinning::DualQuaternion,
    }
}

fn variant(material: &wire::Material, rig: &Rig) -> Result<Option<usize>, FieldFault> {
    let Some(name) = &material.variant else {
        return Ok(None);
    };
    match rig.variants().iter().position(|variant| variant == name) {
        Some(variant) => Ok(Some(variant)),
        None => {
            let known = rig.variants().iter().map(String::as_str);
            let problem = unknown("variant", name, known);
            Err(FieldFault::new("variant", problem))
        }
    }
}

fn surface(material: &wire::Material) -> Result<Surface, FieldFault> {
    let color = |given: Option<[f64; 3]>, field: &'static str| {
        given.map(Color::new).transpose().map_err(fault::at(field))
    };
    let (diffuse, specular) = (
        color(material.diffuse, "diffuse")?,
        color(material.specular, "specular")?,
    );
    Surface::new(diffuse, specular, material.shininess).map_err(fault::at("shininess"))
}

fn show(show: &wire::Show) -> Result<Show, FieldFault> {
    let skin = match show.skin {
        wire::ShowSkin::Posed => ShowSkin::Posed,
        wire::ShowSkin::Bind => ShowSkin::Bind,
        wire::ShowSkin::None => ShowSkin::None,
    };
    let skeleton = match show.skeleton {
        wire::ShowSkeleton::None => ShowSkeleton::None,
        wire::ShowSkeleton::Wireframe => ShowSkeleton::Wireframe,
        wire::ShowSkeleton::Boxes => ShowSkeleton::Boxes,
        wire::ShowSkeleton::Sticks => ShowSkeleton::Sticks,
        wire::ShowSkeleton::Cylinders => ShowSkeleton::Cylinders,
    };
    let normals = match show.normals {
        wire::ShowNormals::Smooth => ShowNormals::Smooth,
        wire::ShowNormals::Flat => ShowNormals::Flat,
    };
    Show::new(skin, skeleton, normals, show.skin_opacity).map_err(fault::at("skin_opacity"))
}
