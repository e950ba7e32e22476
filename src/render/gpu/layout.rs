//! What the shaders read, byte for byte: `repr(C)` mirrors of the structs in `shaders/*.wgsl`, beside the
//! [`View`](crate::render::view::View), the [`InstanceParams`](crate::render::instance_params::InstanceParams) and the
//! [`MaterialParams`](crate::render::material_params::MaterialParams) that both renderers read.

use bytemuck::{Pod, Zeroable};

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct SkinJob {
    pub first_vertex: u32,
    pub vertex_count: u32,
    pub rig_vertex_count: u32,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::pose::{SkinDualQuaternion, SkinMatrix};
    use crate::render::gpu::shaders;
    use crate::render::instance_params::InstanceParams;
    use crate::render::material_params::MaterialParams;
    use crate::render::view::{LIGHTS, ShaderLight, View};
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
        assert_mirrors!(shaders::BY_MASK.skin, "View", View {
            eye_in_world = "eye_in_world", ambient = "ambient", size_pixels = "size_pixels", lights = "lights",
        });
        assert_mirrors!(shaders::BY_MASK.skin, "InstanceParams", InstanceParams {
            clip_from_model = "clip_from_model", world_from_model = "world_from_model",
            world_from_model_normal = "world_from_model_normal", diffuse = "diffuse", opacity = "opacity", specular = "specular",
            shininess = "shininess", textured_diffuse = "textured_diffuse", flat_normals = "flat_normals",
            least_distance_squared = "least_distance_squared",
        });
        assert_mirrors!(shaders::BY_MASK.skin, "Light", ShaderLight {
            toward_or_position = "toward_or_position", radiance = "radiance", cone = "cone",
        });
        assert_mirrors!(shaders::BY_MASK.material, "MaterialParams", MaterialParams {
            color = "color", specular = "specular", shininess = "shininess", emissive = "emissive", least_alpha = "least_alpha",
            color_place = "color_place", emissive_place = "emissive_place", normal_place = "normal_place",
            normal_scale = "normal_scale", is_translucent = "is_translucent", is_lit = "is_lit", is_flat = "is_flat",
        });
        assert_mirrors!(shaders::SKIN_LINEAR, "SkinJob", SkinJob {
            first_vertex = "first_vertex", vertex_count = "vertex_count", rig_vertex_count = "rig_vertex_count", first_row = "first_row", first_morph_weight = "first_morph_weight",
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
