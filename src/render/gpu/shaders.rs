//! The WGSL sources, joined as the pipelines compile them.

macro_rules! shader {
    ($($file:literal),*) => {
        concat!($(include_str!(concat!("../../../shaders/", $file)), "\n",)*)
    };
}

pub(super) const SKIN_LINEAR: &str = shader!("common.wgsl", "skin.wgsl", "skin_linear.wgsl");
pub(super) const SKIN_DUAL_QUATERNION: &str =
    shader!("common.wgsl", "skin.wgsl", "skin_dual_quaternion.wgsl");
pub(super) const LINES: &str = shader!("common.wgsl", "lines.wgsl");
pub(super) const RESOLVE: &str = shader!("common.wgsl", "resolve.wgsl");

/// Those that shade surfaces, which they do at a place in a pixel.
pub(super) struct Shading {
    pub skin: &'static str,
    pub material: &'static str,
    pub solids: &'static str,
    /// Whether they are specialised by how many [`SAMPLES`] there are.
    pub counts_samples: bool,
}

macro_rules! shading {
    ($centroid:literal, $counts_samples:literal) => {
        Shading {
            skin: shader!(
                "common.wgsl",
                "light.wgsl",
                "centroid.wgsl",
                $centroid,
                "shade.wgsl"
            ),
            material: shader!(
                "common.wgsl",
                "light.wgsl",
                "centroid.wgsl",
                $centroid,
                "material.wgsl"
            ),
            solids: shader!(
                "common.wgsl",
                "light.wgsl",
                "centroid.wgsl",
                $centroid,
                "solids.wgsl"
            ),
            counts_samples: $counts_samples,
        }
    };
}

/// The place is a rule of our own.
pub(super) const BY_MASK: Shading = shading!("centroid_by_mask.wgsl", true);
/// For devices whose shaders cannot know which samples are covered.
pub(super) const BY_DRIVER: Shading = shading!("centroid_by_driver.wgsl", false);

/// The override that tells how many samples a pixel has.
pub(super) const SAMPLES: &str = "SAMPLES";

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
            BY_MASK.skin,
            BY_MASK.material,
            BY_MASK.solids,
            BY_DRIVER.skin,
            BY_DRIVER.material,
            BY_DRIVER.solids,
            LINES,
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
