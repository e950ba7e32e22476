//! From the fields of a frame request to a [`Scene`].

use super::appearance::appearance;
use super::call::Call;
use super::camera::camera;
use super::fault;
use super::lights::lights;
use crate::engine::LoadedRig;
use crate::frame::ImageKind;
use crate::protocol::frame as wire;
use crate::protocol::{Fault, FieldFault};
use crate::scene::{Appearance, Background, Color, Samples, Scene, Size};
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
        let lights = lights(params.lights.as_ref(), &rig.rig, limits)?;
        let appearance = appearance(params, &rig.rig)?;
        let framed = rig.extents.framed(&appearance.show);
        let camera = camera(&params.camera, &framed, size)
            .map_err(|error| FieldFault::from(error).within("camera"))?;
        let ambient = params
            .ambient
            .map_or(Ok(Scene::DEFAULT_AMBIENT), Color::new)
            .map_err(fault::at("ambient"))?;
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
        Ok((scene, appearance))
    }
}

/// What is asked for, each kind once.
pub(super) fn image_kinds(params: &wire::FrameParams) -> BTreeSet<ImageKind> {
    let kind = |output: &wire::Output| match output {
        wire::Output::Color => ImageKind::Color,
    };
    params.outputs.iter().map(kind).collect()
}
