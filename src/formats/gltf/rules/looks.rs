//! Rules of textures and materials. Never lives here: what a material looks like.

use super::checker::Checker;
use crate::formats::error::quoted;
use crate::formats::gltf::buffers::media_type;

pub(super) fn check(checker: &mut Checker) {
    check_textures(checker);
    check_samplers(checker);
    check_images(checker);
    check_materials(checker);
}

fn check_textures(checker: &mut Checker) {
    let root = checker.root;
    for (index, texture) in root.textures.iter().enumerate() {
        let path = || format!("textures[{index}]");
        checker.check_index(&root.samplers, texture.sampler, || path() + ".sampler");
        // The library has this for none.
        let source = Some(texture.source).filter(|it| it.value() != u32::MAX as usize);
        checker.check_index(&root.images, source, || path() + ".source");
    }
}

fn check_samplers(checker: &mut Checker) {
    let root = checker.root;
    for (index, sampler) in root.samplers.iter().enumerate() {
        let path = |member: &str| format!("samplers[{index}].{member}");
        for (member, mode) in [("wrapS", &sampler.wrap_s), ("wrapT", &sampler.wrap_t)] {
            checker.check_known(mode, || path(member), "it repeats");
        }
        let unread = "filters are not read";
        if let Some(filter) = &sampler.mag_filter {
            checker.check_known(filter, || path("magFilter"), unread);
        }
        if let Some(filter) = &sampler.min_filter {
            checker.check_known(filter, || path("minFilter"), unread);
        }
    }
}

fn check_images(checker: &mut Checker) {
    let root = checker.root;
    for (index, image) in root.images.iter().enumerate() {
        let path = || format!("images[{index}]");
        checker.check_index(&root.buffer_views, image.buffer_view, || {
            path() + ".bufferView"
        });
        if image.uri.is_some() == image.buffer_view.is_some() {
            checker.warn(|| format!("{} has not one of `uri` and `bufferView`", path()));
        }
        let media = image.mime_type.as_ref().map(|it| it.0.as_str());
        let media = media.or(image.uri.as_deref().and_then(media_type));
        if let Some(media) = media.filter(|it| !matches!(*it, "image/png" | "image/jpeg")) {
            checker.warn(|| {
                format!(
                    "{} has the media type {}, neither PNG nor JPEG",
                    path(),
                    quoted(media)
                )
            });
        }
        if image.buffer_view.is_some() && image.mime_type.is_none() {
            checker.warn(|| format!("{} lies in a buffer and has no mimeType", path()));
        }
    }
}

fn check_materials(checker: &mut Checker) {
    for (index, material) in checker.root.materials.iter().enumerate() {
        let path = || format!("materials[{index}].alphaMode");
        checker.check_known(&material.alpha_mode, path, "OPAQUE is taken");
        let rough = &material.pbr_metallic_roughness;
        let factors = [
            (
                "pbrMetallicRoughness.baseColorFactor",
                &rough.base_color_factor.0[..],
            ),
            (
                "pbrMetallicRoughness.metallicFactor",
                &[rough.metallic_factor.0],
            ),
            (
                "pbrMetallicRoughness.roughnessFactor",
                &[rough.roughness_factor.0],
            ),
            ("emissiveFactor", &material.emissive_factor.0),
        ];
        for (member, numbers) in factors {
            for number in numbers.iter().filter(|it| !(0.0..=1.0).contains(*it)) {
                checker.warn(|| {
                    format!("materials[{index}].{member} is {number}, not a number from 0 to 1")
                });
            }
        }
        if let Some(cutoff) = material.alpha_cutoff.filter(|cutoff| cutoff.0 < 0.0) {
            let cutoff = cutoff.0;
            checker.warn(|| {
                format!("materials[{index}].alphaCutoff is {cutoff}, not a number from 0 up")
            });
        }
    }
}
