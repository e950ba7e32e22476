//! From what was typed to a frame request. Never lives here: which frames of a sequence are asked for.

use super::args::{LightArgs, LookArgs, PoseArgs, RenderArgs};
use crate::cli::values::{Assignment, LightArg, Rotation};
use crate::protocol::camera::{Light, Lights, NamedLights};
use crate::protocol::frame::{FrameParams, Material, Show, ShowNormals};
use crate::protocol::pose::Pose;
use anyhow::bail;

impl RenderArgs {
    /// A request for one frame, but for the camera and the moment of a clip.
    pub(super) fn request(&self, rig: &str) -> anyhow::Result<FrameParams> {
        Ok(FrameParams {
            pose: self.pose.pose(),
            skinning: self.pose.skinning.into(),
            show: self.look.show(),
            lights: self.light.lights()?,
            ambient: self.light.ambient.map(|ambient| ambient.0),
            material: self.look.material(),
            background: self.look.background.map(|background| background.0),
            cull: self.look.cull.into(),
            size: self.output.size.0,
            samples: self.output.samples.into(),
            compression: self.output.compression.into(),
            ..FrameParams::of(rig)
        })
    }
}

impl PoseArgs {
    fn pose(&self) -> Pose {
        let dofs = self.assignments.iter().cloned();
        let dofs = dofs.map(|Assignment { dof, value }| (dof, value.radians));
        let morphs = self.morphs.iter();
        let morphs = morphs.map(|morph| (morph.dof(), morph.weight));
        let rotations = self.rotations.iter().cloned();
        let rotations = rotations.map(|Rotation { joint, quaternion }| (joint, quaternion));
        Pose {
            rotations: rotations.collect(),
            dofs: dofs.chain(morphs).collect(),
            limits: self.limits.into(),
            ..Pose::default()
        }
    }
}

impl LookArgs {
    fn show(&self) -> Show {
        Show {
            skin: self.skin.into(),
            skeleton: self.skeleton.into(),
            skin_opacity: self.skin_opacity,
            normals: if self.flat {
                ShowNormals::Flat
            } else {
                ShowNormals::Smooth
            },
        }
    }

    fn material(&self) -> Material {
        Material {
            diffuse: self.diffuse.map(|diffuse| diffuse.0),
            specular: self.specular.map(|specular| specular.0),
            shininess: self.shininess,
            variant: self.variant.clone(),
        }
    }
}

impl LightArgs {
    /// `None` for those of the protocol.
    fn lights(&self) -> anyhow::Result<Option<Lights>> {
        match self.lights.as_slice() {
            [] => Ok(None),
            [LightArg::None] => Ok(Some(Lights::Given(Vec::new()))),
            [LightArg::File] => Ok(Some(Lights::Named(NamedLights::File))),
            several => {
                let light = |light: &LightArg| match light {
                    LightArg::Light(light) => Ok(light.clone()),
                    LightArg::None => bail!("`--light none` goes with no other light"),
                    LightArg::File => bail!("`--light file` goes with no other light"),
                };
                let lights: Vec<Light> = several.iter().map(light).collect::<Result<_, _>>()?;
                Ok(Some(Lights::Given(lights)))
            }
        }
    }
}
