//! From the fields of a frame request to a [`Scene`].

use super::names::unknown;
use super::pose::no_such;
use super::{Call, fault};
use crate::engine::{EngineError, LoadedRig};
use crate::frame::ImageKind;
use crate::pose::Skinning;
use crate::protocol::Fault;
use crate::protocol::camera as wire_camera;
use crate::protocol::frame as wire;
use crate::rig::Rig;
use crate::scene::{
    Appearance, Background, Bounds, Camera, Color, Cull, Falloff, Light, LookAt, Near, Orbit,
    Pinhole, Samples, Scene, SceneError, Show, ShowNormals, ShowSkeleton, ShowSkin, Size, Surface,
};
use glam::{DMat4, DVec3};

impl Call {
    /// `rig` is what the default camera frames. Lights of its file are left out: they depend on the pose, and [`Call::subject`] adds them.
    pub(super) fn scene(
        &self,
        params: &wire::FrameParams,
        rig: &LoadedRig,
    ) -> Result<(Scene, Appearance), Fault> {
        let limits = self.engine().limits();
        let [width, height] = params.size;
        let size = Size::new(width, height, limits).map_err(EngineError::from)?;
        let capabilities = self.engine().capabilities();
        for output in &params.outputs {
            capabilities.accept_raster(of_output(*output), size)?;
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
                let light =
                    |(index, light)| of_light(light).map_err(|error| fault::of_light(index, error));
                lights
                    .iter()
                    .enumerate()
                    .map(light)
                    .collect::<Result<_, _>>()?
            }
        };
        let variant = of_variant(&params.material, &rig.rig)?;
        let scene = || -> Result<(Scene, Appearance), SceneError> {
            let show = of_show(&params.show)?;
            let camera = of_camera(&params.camera, &rig.extents.framed(&show), size)?;
            let ambient = params.ambient.map(|ambient| Color::new(ambient, "ambient"));
            let ambient = ambient.unwrap_or(Ok(Scene::DEFAULT_AMBIENT))?;
            let surface = Surface {
                variant,
                ..of_material(&params.material)?
            };
            let background = params.background.map(Background::new);
            let scene = Scene {
                size,
                samples: match params.samples {
                    wire::Samples::One => Samples::One,
                    wire::Samples::Four => Samples::Four,
                },
                camera,
                lights,
                ambient,
                background: background.unwrap_or(Ok(Background::default()))?,
            };
            let cull = match params.cull {
                wire::Cull::Auto => Cull::Auto,
                wire::Cull::Never => Cull::Never,
            };
            let appearance = Appearance {
                show,
                surface,
                cull,
            };
            Ok((scene, appearance))
        };
        scene().map_err(|error| EngineError::from(error).into())
    }
}

fn of_camera(
    camera: &wire_camera::Camera,
    framed: &Bounds,
    size: Size,
) -> Result<Camera, SceneError> {
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

fn of_light(light: &wire_camera::Light) -> Result<Light, SceneError> {
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

pub(super) fn of_output(output: wire::Output) -> ImageKind {
    match output {
        wire::Output::Color => ImageKind::Color,
    }
}

pub(super) fn of_skinning(skinning: wire::Skinning) -> Skinning {
    match skinning {
        wire::Skinning::Linear => Skinning::Linear,
        wire::Skinning::DualQuaternion => Skinning::DualQuaternion,
    }
}

fn of_variant(material: &wire::Material, rig: &Rig) -> Result<Option<usize>, EngineError> {
    let Some(name) = &material.variant else {
        return Ok(None);
    };
    match rig.variants().iter().position(|variant| variant == name) {
        Some(variant) => Ok(Some(variant)),
        None => {
            let known = rig.variants().iter().map(String::as_str);
            let problem = unknown("variant", name, known);
            Err(no_such("material.variant", problem))
        }
    }
}

fn of_material(material: &wire::Material) -> Result<Surface, SceneError> {
    let color = |given: Option<[f64; 3]>, field| {
        given
            .map(|channels| Color::new(channels, field))
            .transpose()
    };
    Surface::new(
        color(material.diffuse, "material.diffuse")?,
        color(material.specular, "material.specular")?,
        material.shininess,
    )
}

fn of_show(show: &wire::Show) -> Result<Show, SceneError> {
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
    Show::new(skin, skeleton, normals, show.skin_opacity)
}
