//! A picture's camera and lights as numbers of 32 bits, which both renderers read. It mirrors `View` in `shaders/common.wgsl`; a test
//! beside the other mirrors compares every offset. Never lives here: what differs from instance to instance.

use crate::scene::{Cone, Falloff, Light, Scene};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};

/// The length of `View::lights` in the shaders.
pub(super) const LIGHTS: usize = 16;

/// Spaces and units as `shaders/common.wgsl` gives them.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct View {
    pub eye_in_world: Vec4,
    pub ambient: Vec3,
    pub light_count: u32,
    pub size_pixels: Vec2,
    _padding: [f32; 2],
    pub lights: [ShaderLight; LIGHTS],
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ShaderLight {
    pub toward_or_position: Vec4,
    pub radiance: Vec4,
    pub cone: Vec4,
}

impl View {
    pub(super) fn of(scene: &Scene) -> Self {
        let mut lights = [ShaderLight::zeroed(); LIGHTS];
        for (slot, light) in lights.iter_mut().zip(&scene.lights) {
            *slot = ShaderLight::of(light);
        }
        Self {
            eye_in_world: scene.camera.eye().as_vec4(),
            ambient: scene.ambient.rgb(),
            light_count: scene.lights.len().min(LIGHTS) as u32,
            size_pixels: Vec2::new(scene.size.width as f32, scene.size.height as f32),
            _padding: [0.0; 2],
            lights,
        }
    }
}

impl ShaderLight {
    fn of(light: &Light) -> Self {
        match *light {
            Light::Directional {
                direction,
                radiance,
            } => Self {
                toward_or_position: (-direction).extend(0.0),
                radiance: radiance.extend(0.0),
                cone: EVERYWHERE,
            },
            Light::Point {
                position,
                radiance,
                falloff,
            } => Self {
                toward_or_position: position.extend(1.0),
                radiance: radiance.extend(match falloff {
                    Falloff::None => 0.0,
                    Falloff::InverseSquare => 1.0,
                }),
                cone: EVERYWHERE,
            },
            Light::Spot {
                position,
                radiance,
                cone,
            } => Self {
                toward_or_position: position.extend(1.0),
                radiance: radiance.extend(1.0),
                cone: falling_off(cone),
            },
        }
    }
}

/// Of a light without a cone: the same in every direction.
const EVERYWHERE: Vec4 = Vec4::W;

/// KHR_lights_punctual has this formula, and the least width, so that a sharp edge is no division by 0.
fn falling_off(cone: Cone) -> Vec4 {
    const LEAST_WIDTH: f32 = 0.001;
    let scale = 1.0 / (cone.cosine_of_inner - cone.cosine_of_outer).max(LEAST_WIDTH);
    (-cone.direction * scale).extend(-cone.cosine_of_outer * scale)
}
