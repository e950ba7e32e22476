//! A picture's camera, lights and surface as numbers of 32 bits, which both renderers read. It mirrors `View` in
//! `shaders/common.wgsl`; a test beside the other mirrors compares every offset.

use super::Picture;
use crate::scene::{Color, Cone, Falloff, Light, ShowNormals, Surface};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};

/// The length of `View::lights` in the shaders.
pub(super) const LIGHTS: usize = 16;

/// Spaces and units as `shaders/common.wgsl` gives them.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct View {
    pub clip_from_world: Mat4,
    pub eye_in_world: Vec4,
    pub size_pixels: Vec2,
    pub light_count: u32,
    pub flat_normals: u32,
    pub ambient: Vec3,
    pub shininess: f32,
    pub diffuse: Vec3,
    pub opacity: f32,
    pub specular: Vec3,
    pub least_distance_squared: f32,
    pub textured_diffuse: Vec3,
    _padding: f32,
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
    pub(super) fn of(picture: &Picture) -> Self {
        let scene = &picture.scene;
        let mut lights = [ShaderLight::zeroed(); LIGHTS];
        for (slot, light) in lights.iter_mut().zip(&scene.lights) {
            *slot = ShaderLight::of(light);
        }
        Self {
            clip_from_world: scene.camera.clip_from_world().as_mat4(),
            eye_in_world: scene.camera.eye().as_vec4(),
            size_pixels: Vec2::new(scene.size.width as f32, scene.size.height as f32),
            light_count: scene.lights.len().min(LIGHTS) as u32,
            flat_normals: u32::from(scene.show.normals == ShowNormals::Flat),
            ambient: scene.ambient.rgb(),
            shininess: scene.surface.shininess.unwrap_or(Surface::SHININESS),
            diffuse: scene.surface.diffuse.unwrap_or(Surface::DIFFUSE).rgb(),
            opacity: scene.show.skin_opacity(),
            specular: scene.surface.specular.unwrap_or(Surface::SPECULAR).rgb(),
            least_distance_squared: picture.least_distance_squared(),
            // A texture has the color already.
            textured_diffuse: scene.surface.diffuse.unwrap_or(Color::WHITE).rgb(),
            _padding: 0.0,
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
