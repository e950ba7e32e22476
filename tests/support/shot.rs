//! A picture of one character, all in one value.

use rigd::pose::{Posed, Skinning};
use rigd::render::Plan;
use rigd::scene::{
    Appearance, Background, Camera, Color, Cull, Light, Samples, Scene, Show, Size, Surface,
};
use std::sync::Arc;

#[derive(Clone)]
pub struct Shot {
    pub size: Size,
    pub samples: Samples,
    pub camera: Camera,
    pub lights: Vec<Light>,
    pub ambient: Color,
    pub background: Background,
    pub show: Show,
    pub surface: Surface,
    pub cull: Cull,
}

impl Shot {
    pub fn plan(self, posed: Arc<Posed>, skinning: Skinning, rest_size: f64) -> Plan {
        let (scene, appearance) = self.split();
        Plan::picture(posed, skinning, appearance, scene, rest_size)
    }

    pub fn split(self) -> (Scene, Appearance) {
        let scene = Scene {
            size: self.size,
            samples: self.samples,
            camera: self.camera,
            lights: self.lights,
            ambient: self.ambient,
            background: self.background,
        };
        let appearance = Appearance {
            show: self.show,
            surface: self.surface,
            cull: self.cull,
        };
        (scene, appearance)
    }
}
