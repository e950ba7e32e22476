//! The WGSL sources, joined as the pipelines compile them.

macro_rules! shader {
    ($($file:literal),*) => {
        concat!($(include_str!(concat!("../../../shaders/", $file)), "\n",)*)
    };
}

pub(super) const SKIN_LINEAR: &str = shader!("common.wgsl", "skin.wgsl", "skin_linear.wgsl");
pub(super) const SKIN_DUAL_QUATERNION: &str =
    shader!("common.wgsl", "skin.wgsl", "skin_dual_quaternion.wgsl");
pub(super) const SHADE: &str = shader!("common.wgsl", "light.wgsl", "shade.wgsl");
pub(super) const COAT: &str = shader!("common.wgsl", "light.wgsl", "coat.wgsl");
pub(super) const LINES: &str = shader!("common.wgsl", "lines.wgsl");
pub(super) const SOLIDS: &str = shader!("common.wgsl", "light.wgsl", "solids.wgsl");
pub(super) const RESOLVE: &str = shader!("common.wgsl", "resolve.wgsl");

/// Threads of one compute workgroup: `WORKGROUP` in `common.wgsl`.
pub(super) const WORKGROUP: u32 = 64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shader_is_valid_wgsl_with_the_workgroup_size_that_is_dispatched() {
        for source in [
            SKIN_LINEAR,
            SKIN_DUAL_QUATERNION,
            SHADE,
            COAT,
            LINES,
            SOLIDS,
            RESOLVE,
        ] {
            let module = naga::front::wgsl::parse_str(source).expect("the shader parses");
            let flags = naga::valid::ValidationFlags::all();
            let mut validator =
                naga::valid::Validator::new(flags, naga::valid::Capabilities::empty());
            validator.validate(&module).expect("the shader is valid");
            for entry in &module.entry_points {
                if entry.stage == naga::ShaderStage::Compute {
                    assert_eq!(entry.workgroup_size, [WORKGROUP, 1, 1]);
                }
            }
        }
    }
}
