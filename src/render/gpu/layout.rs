//! What the shaders read, byte for byte: `repr(C)` mirrors of the structs in `shaders/*.wgsl`.

use crate::render::Picture;
use crate::scene::{Color, Falloff, Light, ShowNormals, Surface};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3, Vec4};

/// The length of `View::lights` in the shaders.
const LIGHTS: usize = 16;

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct View {
    clip_from_world: Mat4,
    eye_in_world: Vec4,
    size_pixels: Vec2,
    light_count: u32,
    flat_normals: u32,
    ambient: Vec3,
    shininess: f32,
    diffuse: Vec3,
    opacity: f32,
    specular: Vec3,
    least_distance_squared: f32,
    textured_diffuse: Vec3,
    _padding: f32,
    lights: [ShaderLight; LIGHTS],
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct ShaderLight {
    toward_or_position: Vec4,
    radiance: Vec4,
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SkinJob {
    pub vertex_count: u32,
    pub first_row: u32,
    pub first_morph_weight: u32,
    pub positions_start: u32,
    pub normals_start: u32,
}

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ResolveJob {
    pub width: u32,
    pub height: u32,
    pub layers: u32,
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
            shininess: scene.surface.shininess,
            diffuse: scene.surface.diffuse.unwrap_or(Surface::DIFFUSE).rgb(),
            opacity: scene.show.skin_opacity(),
            specular: scene.surface.specular.rgb(),
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
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::pose::{SkinDualQuaternion, SkinMatrix};
    use crate::render::gpu::shaders;
    use crate::rig::{Influence, MorphDisplacement};
    use glam::Vec4;
    use std::mem::offset_of;

    /// Offset of every member, and the size, of a struct as the shader compiler lays it out.
    fn shader_layout(source: &str, name: &str) -> (Vec<(String, usize)>, usize) {
        let module = naga::front::wgsl::parse_str(source).expect("the shader parses");
        let found = module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(name));
        let naga::TypeInner::Struct { members, span } =
            &found.expect("the struct is there").1.inner
        else {
            panic!("{name} is no struct");
        };
        let offset =
            |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset as usize);
        (members.iter().map(offset).collect(), *span as usize)
    }

    macro_rules! assert_mirrors {
        ($source:expr, $name:literal, $ty:ty { $($field:ident = $member:literal),* $(,)? }) => {
            let wanted = vec![$(($member.to_owned(), offset_of!($ty, $field)),)*];
            assert_eq!(shader_layout(&$source, $name), (wanted, size_of::<$ty>()), $name);
        };
    }

    #[test]
    fn rust_and_shaders_agree_on_every_offset() {
        assert_mirrors!(shaders::SHADE, "View", View {
            clip_from_world = "clip_from_world", eye_in_world = "eye_in_world", size_pixels = "size_pixels",
            light_count = "light_count", flat_normals = "flat_normals", ambient = "ambient", shininess = "shininess",
            diffuse = "diffuse", opacity = "opacity", specular = "specular",
            least_distance_squared = "least_distance_squared", textured_diffuse = "textured_diffuse", lights = "lights",
        });
        assert_mirrors!(shaders::SHADE, "Light", ShaderLight {
            toward_or_position = "toward_or_position", radiance = "radiance",
        });
        assert_mirrors!(shaders::SKIN_LINEAR, "SkinJob", SkinJob {
            vertex_count = "vertex_count", first_row = "first_row", first_morph_weight = "first_morph_weight",
            positions_start = "positions_start", normals_start = "normals_start",
        });
        assert_mirrors!(shaders::RESOLVE, "ResolveJob", ResolveJob {
            width = "width", height = "height", layers = "layers",
        });
        assert_mirrors!(shaders::SKIN_LINEAR, "Influence", Influence { binding = "binding", weight = "weight" });
        assert_mirrors!(shaders::SKIN_LINEAR, "MorphDisplacement", MorphDisplacement {
            morph = "morph", position = "position", normal = "normal",
        });
        // The shaders read a palette row by row.
        assert_eq!(size_of::<SkinMatrix>(), 3 * size_of::<Vec4>());
        assert_eq!(size_of::<SkinDualQuaternion>(), 5 * size_of::<Vec4>());
    }

    #[test]
    fn as_many_lights_as_the_limit_says_fit() {
        assert_eq!(Limits::default().lights, LIGHTS as u64);
    }
}
