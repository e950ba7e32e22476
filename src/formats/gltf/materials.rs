//! Materials brought to what Blinn-Phong knows. Never lives here: meshes, and decoding a picture.
//!
//! # Formula
//! Of a metallic and rough material with base color `c`, metalness `m` and roughness `r` (each times the mean of its texture, where it has one):
//! - `diffuse = c · (1 − m / 2)`: half of a metal's color stands in for the surroundings that it would mirror, of which there are none.
//! - `shininess = 2 / α² − 2` with `α = max(r, 0.05)²`, at most 1000: the exponent whose lobe is as wide as that of a GGX of that `α`.
//! - `specular = min(F · shininess / 8, 1)`, where `F = mix(0.04, c, m)` is what is mirrored straight on, and the factor keeps what a lobe scatters
//!   in all about the same however narrow it is; a surface rough throughout has none, for its lobe would be another diffuse light.
//!
//! What is given off is the emissive factor times its texture times the emissive strength, held to 1e9 before the texture and to 1 after shading.
//!
//! Of one with specular and glossiness: `diffuse` is its own, `F` its specular color, and `r = 1 − glossiness`.

use super::accessors::Accessors;
use super::extensions::EMISSIVE_STRENGTH;
use super::textures::{TextureRef, Textures};
use crate::formats::error::{FileFault, LoadError};
use crate::formats::files::{Files, Gathered};
use crate::formats::pictures::Alpha;
use crate::limits::Limits;
use crate::rig::{
    Draft, Encoding, Highlight, Material, NormalMap, Opacity, TexturePlace, Warnings,
};
use glam::{Vec3, Vec4};
use gltf_json::Index;
use gltf_json::extensions::material::PbrSpecularGlossiness;
use gltf_json::material::AlphaMode;
use gltf_json::validation::Checked;
use serde_json::Value;
use std::collections::BTreeMap;

/// `F` of what is no metal.
const DIELECTRIC: f32 = 0.04;
const LEAST_ROUGHNESS: f32 = 0.05;
const MOST_SHININESS: f32 = 1000.0;
/// Of colors, scales and cutoffs: far more than any has, and finite after all arithmetic.
const MOST_FACTOR: f32 = 1e9;
/// Far more than is needed to be white, and small enough to be multiplied.
const MOST_EMISSIVE: f32 = 1e9;

/// Where materials are read from.
pub(super) struct Materials<'a> {
    textures: Textures<'a>,
    /// By material of the draft: the set of texture coordinates that its textures lie on, where it has any.
    sets: Vec<Option<u32>>,
    /// What a primitive without a material is made of.
    unnamed: Option<usize>,
    /// Of materials that cannot be had, why. Only one that a primitive is made of has to be there.
    left_out: BTreeMap<usize, FileFault>,
}

impl<'a> Materials<'a> {
    /// Adds all materials of the file to the draft, in its order.
    pub(super) fn read(
        accessors: Accessors<'a>,
        from: &'a Gathered,
        files: &mut Files<'_>,
        limits: &'a Limits,
        draft: &mut Draft,
    ) -> Result<Self, LoadError> {
        let mut materials = Self {
            textures: Textures::new(accessors, from, limits),
            sets: Vec::new(),
            unnamed: None,
            left_out: BTreeMap::new(),
        };
        for (index, material) in accessors.root.materials.iter().enumerate() {
            let path = format!("materials[{index}]");
            match materials.add(material, &path, files, draft) {
                Ok(()) => {}
                Err(LoadError::Invalid(fault)) => materials.leave_out(index, fault, draft),
                Err(other) => return Err(other),
            }
        }
        Ok(materials)
    }

    /// Something stands in its place, for primitives know materials by their number.
    fn leave_out(&mut self, index: usize, fault: FileFault, draft: &mut Draft) {
        let FileFault {
            expected, found, ..
        } = &fault;
        let sentence = format!("a material is left out: expected {expected}, but found {found}");
        let faults = self.textures.accessors.faults;
        draft.warnings.push(|| faults.warning(&sentence));
        draft.materials.push(Material::named(String::new()));
        self.sets.push(None);
        self.left_out.insert(index, fault);
    }

    pub(super) fn is_left_out(&self, material: usize) -> bool {
        self.left_out.contains_key(&material)
    }

    /// Where in the draft a primitive's material is.
    pub(super) fn index(
        &mut self,
        material: Option<Index<gltf_json::Material>>,
        path: &str,
        draft: &mut Draft,
    ) -> Result<usize, LoadError> {
        let Some(material) = material else {
            return Ok(*self.unnamed.get_or_insert_with(|| {
                draft.materials.push(Material {
                    is_single_sided: true,
                    ..surface(String::new(), Vec4::ONE, 1.0, 1.0)
                });
                self.sets.push(None);
                draft.materials.len() - 1
            }));
        };
        let Accessors { faults, root, .. } = self.textures.accessors;
        let path = format!("{path}.material");
        faults.get(&root.materials, "materials", material, &path)?;
        match self.left_out.get(&material.value()) {
            Some(fault) => Err(fault.clone().into()),
            None => Ok(material.value()),
        }
    }

    pub(super) fn is_textured(&self, material: usize) -> bool {
        self.sets[material].is_some()
    }

    /// Which texture coordinates its textures lie on.
    pub(super) fn texcoord_set(&self, material: usize) -> u32 {
        self.sets[material].unwrap_or_default()
    }

    fn add(
        &mut self,
        material: &gltf_json::Material,
        path: &str,
        files: &mut Files<'_>,
        draft: &mut Draft,
    ) -> Result<(), LoadError> {
        let faults = self.textures.accessors.faults;
        let name = faults.name(material.name.as_deref(), path, &mut draft.warnings);
        let reflection = self.reflection(material, name, path, files, draft)?;
        let opacity = opacity_of(material);
        let set = texcoord_set(material);
        let textures = self.texture_slots(material, opacity, set, path, files, draft)?;
        let [texture, emissive_texture, normals] = textures;
        let normal_scale = normal_scale(material);
        let mut made = Material {
            texture,
            emissive: Vec3::from_array(material.emissive_factor.0),
            emissive_texture,
            normal_map: normals.map(|place| NormalMap {
                place,
                scale: normal_scale,
            }),
            opacity,
            is_single_sided: !material.double_sided,
            is_unlit: is_unlit(material),
            ..reflection
        };
        let color = made.color.unwrap_or_default().to_array();
        let emissive = made.emissive.to_array();
        let others = [cutoff(material), normal_scale];
        let mut factors = color.iter().chain(&emissive).chain(&others);
        if !factors.all(|factor| factor.abs() <= MOST_FACTOR) {
            return Err(faults.load(path, "factors that are finite", "others"));
        }
        let strength = self.emissive_strength(material, path, &mut draft.warnings);
        made.emissive = (made.emissive * strength).min(Vec3::splat(MOST_EMISSIVE));
        draft.materials.push(made);
        self.sets.push(set);
        Ok(())
    }

    /// A material with the color and the highlight of this one.
    fn reflection(
        &mut self,
        material: &gltf_json::Material,
        name: String,
        path: &str,
        files: &mut Files<'_>,
        draft: &mut Draft,
    ) -> Result<Material, LoadError> {
        if let Some(glossy) = glossy_of(material) {
            let mirrored = Vec3::from_array(glossy.specular_factor.0);
            let roughness = 1.0 - glossy.glossiness_factor.0;
            return Ok(Material {
                color: Some(Vec4::from_array(glossy.diffuse_factor.0)),
                highlight: Some(highlight(mirrored, roughness)),
                ..Material::named(name)
            });
        }
        let rough = &material.pbr_metallic_roughness;
        let color = Vec4::from_array(rough.base_color_factor.0);
        let [metalness, roughness] = self.mean_of(rough, path, files, draft)?;
        let metalness = metalness * rough.metallic_factor.0;
        let roughness = roughness * rough.roughness_factor.0;
        let mut made = surface(name, color, metalness, roughness);
        if is_unlit(material) {
            // Nothing is mirrored, so nothing has to stand in for it.
            made.color = Some(color);
        }
        Ok(made)
    }

    /// The textures of color, emission and normals, of those that lie on a set of texture coordinates.
    fn texture_slots(
        &mut self,
        material: &gltf_json::Material,
        opacity: Opacity,
        set: Option<u32>,
        path: &str,
        files: &mut Files<'_>,
        draft: &mut Draft,
    ) -> Result<[Option<TexturePlace>; 3], LoadError> {
        let alpha = match opacity {
            Opacity::Opaque => Alpha::Drop,
            Opacity::Mask(_) | Opacity::Blend => Alpha::Keep,
        };
        let decodings = [
            ("baseColorTexture", (Encoding::Srgb, alpha)),
            ("emissiveTexture", (Encoding::Srgb, Alpha::Drop)),
            ("normalTexture", (Encoding::Linear, Alpha::Drop)),
        ];
        let mut slots = [None, None, None];
        let textures = texture_refs(material).into_iter().zip(decodings);
        for ((texture, (role, decoding)), slot) in textures.zip(&mut slots) {
            let Some(texture) = texture else { continue };
            let path = format!("{path}.{role}");
            if Some(texture.set) != set {
                let faults = self.textures.accessors.faults;
                let sentence = format!(
                    "{path} lies on TEXCOORD_{} and is left out: the material's first texture lies on another",
                    texture.set
                );
                draft.warnings.push(|| faults.warning(&sentence));
                continue;
            }
            let warnings = &mut draft.warnings;
            *slot = (self.textures).slot(&texture, decoding, &path, files, warnings)?;
        }
        Ok(slots)
    }

    /// What multiplies the emissive factor.
    fn emissive_strength(
        &self,
        material: &gltf_json::Material,
        path: &str,
        warnings: &mut Warnings,
    ) -> f32 {
        let extensions = material.extensions.as_ref();
        let Some(extension) = extensions.and_then(|it| it.others.get(EMISSIVE_STRENGTH)) else {
            return 1.0;
        };
        let members = extension.as_object();
        let strength = members.and_then(|it| {
            let strength = it.get("emissiveStrength");
            strength.map_or(Some(1.0), Value::as_f64)
        });
        match strength.filter(|strength| *strength >= 0.0) {
            // More would be infinite where the factor is a small number.
            Some(strength) => strength.min(f64::from(MOST_EMISSIVE)) as f32,
            None => {
                let faults = self.textures.accessors.faults;
                let path = format!("{path}.extensions.{EMISSIVE_STRENGTH}");
                let sentence = format!("{path}.emissiveStrength is no number from 0 and left out");
                warnings.push(|| faults.warning(&sentence));
                1.0
            }
        }
    }

    /// Of metalness and roughness, the means over their texture.
    fn mean_of(
        &mut self,
        rough: &gltf_json::material::PbrMetallicRoughness,
        path: &str,
        files: &mut Files<'_>,
        draft: &mut Draft,
    ) -> Result<[f32; 2], LoadError> {
        let Some(info) = &rough.metallic_roughness_texture else {
            return Ok([1.0, 1.0]);
        };
        let path = format!("{path}.metallicRoughnessTexture");
        let decoding = (Encoding::Linear, Alpha::Drop);
        let place = self.textures.slot(
            &TextureRef::color(info),
            decoding,
            &path,
            files,
            &mut draft.warnings,
        )?;
        let Some(TexturePlace { texture, .. }) = place else {
            return Ok([1.0, 1.0]);
        };
        // The smallest level is the mean of all.
        let mean = texture.levels().last().map(|level| level.texels[0]);
        let [_, roughness, metalness, _] = mean.unwrap_or([255; 4]);
        Ok([metalness, roughness].map(|it| f32::from(it) / 255.0))
    }
}

/// The textures that a material names for color, emission and normals.
fn texture_refs(material: &gltf_json::Material) -> [Option<TextureRef>; 3] {
    let color = match glossy_of(material) {
        Some(glossy) => glossy.diffuse_texture.as_ref(),
        None => (material.pbr_metallic_roughness)
            .base_color_texture
            .as_ref(),
    };
    [
        color.map(TextureRef::color),
        material.emissive_texture.as_ref().map(TextureRef::color),
        material.normal_texture.as_ref().map(TextureRef::normals),
    ]
}

/// The texture coordinates that the first texture of a material lies on.
fn texcoord_set(material: &gltf_json::Material) -> Option<u32> {
    let mut textures = texture_refs(material).into_iter().flatten();
    textures.next().map(|texture| texture.set)
}

fn glossy_of(material: &gltf_json::Material) -> Option<&PbrSpecularGlossiness> {
    let extensions = material.extensions.as_ref()?;
    extensions.pbr_specular_glossiness.as_ref()
}

fn is_unlit(material: &gltf_json::Material) -> bool {
    let extensions = material.extensions.as_ref();
    extensions.is_some_and(|it| it.unlit.is_some())
}

fn opacity_of(material: &gltf_json::Material) -> Opacity {
    match material.alpha_mode {
        Checked::Valid(AlphaMode::Opaque) | Checked::Invalid => Opacity::Opaque,
        Checked::Valid(AlphaMode::Mask) => Opacity::Mask(cutoff(material)),
        Checked::Valid(AlphaMode::Blend) => Opacity::Blend,
    }
}

fn cutoff(material: &gltf_json::Material) -> f32 {
    material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0)
}

fn normal_scale(material: &gltf_json::Material) -> f32 {
    material
        .normal_texture
        .as_ref()
        .map_or(1.0, |normals| normals.scale)
}

fn surface(name: String, color: Vec4, metalness: f32, roughness: f32) -> Material {
    let metalness = metalness.clamp(0.0, 1.0);
    let rgb = color.truncate();
    let mirrored = Vec3::splat(DIELECTRIC).lerp(rgb, metalness);
    Material {
        color: Some((rgb * (1.0 - metalness / 2.0)).extend(color.w)),
        highlight: Some(highlight(mirrored, roughness)),
        ..Material::named(name)
    }
}

fn highlight(mirrored: Vec3, roughness: f32) -> Highlight {
    let roughness = roughness.clamp(LEAST_ROUGHNESS, 1.0);
    let alpha = roughness * roughness;
    let shininess = (2.0 / (alpha * alpha) - 2.0).min(MOST_SHININESS);
    let specular = mirrored * (shininess / 8.0);
    Highlight {
        specular: specular.clamp(Vec3::ZERO, Vec3::ONE),
        shininess,
    }
}
