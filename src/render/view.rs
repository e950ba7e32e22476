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
    _padding: f32,
    pub size_pixels: Vec2,
    _more_padding: [f32; 2],
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
        let mut lights = [ShaderLight::NONE; LIGHTS];
        for (slot, light) in lights.iter_mut().zip(&scene.lights) {
            *slot = ShaderLight::of(light);
        }
        Self {
            eye_in_world: scene.camera.eye().as_vec4(),
            ambient: scene.ambient.rgb(),
            size_pixels: Vec2::new(scene.size.width as f32, scene.size.height as f32),
            _padding: 0.0,
            _more_padding: [0.0; 2],
            lights,
        }
    }

    /// Those of the scene.
    pub(super) fn lights(&self) -> impl Iterator<Item = &ShaderLight> {
        let is_light = |light: &&ShaderLight| light.toward_or_position.w <= 1.0;
        self.lights.iter().take_while(is_light)
    }
}

impl ShaderLight {
    /// What stands behind the last one. The shaders stop there, and not at a count: Mesa's lavapipe compiles a loop to a count in a uniform
    /// anew for each draw, and keeps what it compiled.
    const NONE: Self = Self {
        toward_or_position: Vec4::new(0.0, 0.0, 0.0, 2.0),
        radiance: Vec4::ZERO,
        cone: Vec4::ZERO,
    };

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
