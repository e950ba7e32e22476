//! Which extensions a document may require, and what is said of those that are passed over. Never lives here: what the others mean.

use super::fault::Faults;
use crate::formats::error::{FileFault, quoted};
use crate::rig::Warnings;
use gltf_json::Node;
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// Extensions that are read where they say something that can be shown.
const READ: &[&str] = &[
    LIGHTS,
    EMISSIVE_STRENGTH,
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    VARIANTS,
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Names of those that other files look for.
pub(super) const EMISSIVE_STRENGTH: &str = "KHR_materials_emissive_strength";
pub(super) const LIGHTS: &str = "KHR_lights_punctual";
pub(super) const VARIANTS: &str = "KHR_materials_variants";

/// What a node says of the light that it carries.
pub(super) fn light_of(node: &Node) -> Option<&Value> {
    node.extensions.as_ref()?.others.get(LIGHTS)
}

const ABOUT: &str = "what it says about the file is not shown";
const OUTLINES: &str = "outlines are not drawn";
const PHYSICS: &str = "nothing is simulated";
const EXPRESSIONS: &str = "its names of bones and expressions are not known";
const POINTER: &str = "nothing answers to a pointer";

/// Extensions without which every vertex, joint and key is the same, and what is missing without them. Those of a [family](FAMILIES) are
/// here where more can be said of them.
const LOOKS_ALONE: &[(&str, &str)] = &[
    ("AGI_stk_metadata", ABOUT),
    ("CESIUM_primitive_outline", OUTLINES),
    ("EXT_feature_metadata", ABOUT),
    ("EXT_instance_features", ABOUT),
    ("EXT_mesh_features", ABOUT),
    ("EXT_mesh_manifold", ABOUT),
    ("EXT_mesh_primitive_edge_visibility", OUTLINES),
    ("EXT_structural_metadata", ABOUT),
    ("FB_geometry_metadata", ABOUT),
    ("GODOT_single_root", ABOUT),
    ("GRIFFEL_bim_data", ABOUT),
    ("KHR_collision_shapes", PHYSICS),
    ("KHR_implicit_shapes", PHYSICS),
    ("KHR_interactivity", POINTER),
    ("KHR_materials_anisotropy", "highlights are drawn round"),
    ("KHR_materials_clearcoat", "clear coats are not drawn"),
    (
        "KHR_materials_diffuse_transmission",
        "light from behind a surface is not drawn",
    ),
    ("KHR_materials_dispersion", "dispersion is not drawn"),
    (
        "KHR_materials_ior",
        "highlights are those of an index of refraction of 1.5",
    ),
    ("KHR_materials_iridescence", "iridescence is not drawn"),
    ("KHR_materials_sheen", "sheen is not drawn"),
    (
        "KHR_materials_specular",
        "highlights are as strong as without it",
    ),
    (
        "KHR_materials_transmission",
        "what transmits light is drawn opaque",
    ),
    (
        "KHR_materials_volume",
        "nothing below a surface tints or bends light",
    ),
    ("KHR_node_hoverability", POINTER),
    ("KHR_node_selectability", POINTER),
    ("KHR_node_visibility", "hidden nodes are drawn"),
    ("KHR_physics_rigid_bodies", PHYSICS),
    ("KHR_techniques_webgl", "its shaders are not run"),
    ("MOZ_hubs_components", ABOUT),
    ("MOZ_lightmap", "light maps are not drawn"),
    ("MPEG_media", "its media are not played"),
    ("MPEG_viewport_recommended", ABOUT),
    ("MSFT_lod", "the finest level alone is drawn"),
    ("VRM", EXPRESSIONS),
    ("VRMC_springBone", PHYSICS),
    ("VRMC_vrm", EXPRESSIONS),
];

/// The same of whatever has one of these words after the first `_` of its name, whoever's it is.
const FAMILIES: &[(&str, &str)] = &[
    ("audio", "sounds are not played"),
    ("environment", "its light is not drawn"),
    ("lights", "its light is not drawn"),
    ("materials", "what it adds to materials is not drawn"),
    ("packing", "its textures are not drawn"),
    ("texture", "a texture without another picture is not drawn"),
    ("xmp", ABOUT),
];

/// What is missing without an extension that is not read; `None` where it may be more than looks.
fn missing_looks(name: &str) -> Option<&'static str> {
    let known = LOOKS_ALONE.iter().find(|(known, _)| *known == name);
    let family = || {
        let word = name.split('_').nth(1)?;
        FAMILIES.iter().find(|(family, _)| *family == word)
    };
    known.or_else(family).map(|(_, missing)| *missing)
}

/// Among the extensions of an object, one that is not read and may be more than looks: what the object lacks it may bring.
pub(super) fn bringing(extensions: &Map<String, Value>) -> Option<&str> {
    let names = extensions.keys().map(String::as_str);
    let mut names = names.filter(|name| is_missing(name));
    names.next()
}

/// What is found where only such an extension says more.
pub(super) fn instead(name: &str) -> String {
    format!("the extension {} instead, which is not read", quoted(name))
}

/// Whether it is neither read nor a matter of looks alone.
fn is_missing(name: &str) -> bool {
    !READ.contains(&name) && missing_looks(name).is_none()
}

/// # Errors
/// Where extensions are required that are neither read nor a matter of looks alone. The fault names them all.
pub(super) fn check(
    faults: Faults<'_>,
    json: &Value,
    warnings: &mut Warnings,
) -> Result<(), FileFault> {
    let names = |list: &str| {
        let names = json[list].as_array().into_iter().flatten();
        names.filter_map(Value::as_str)
    };
    let mut known: BTreeSet<&str> = READ.iter().copied().collect();
    let required = names("extensionsRequired");
    let missing: BTreeSet<&str> = required.filter(|name| is_missing(name)).collect();
    if !missing.is_empty() {
        let read = READ.join(", ");
        let expected = format!("extensions that are read ({read}) or change looks alone");
        return Err(faults.at("extensionsRequired", expected, listed(&missing)));
    }
    // One that is required should be among those that are used; not every file has it there.
    for name in names("extensionsUsed").chain(names("extensionsRequired")) {
        if known.insert(name) {
            warnings.push(|| {
                let missing = missing_looks(name).map_or(String::new(), |it| format!(": {it}"));
                let sentence = format!("the extension {} is passed over{missing}", quoted(name));
                faults.warning(&sentence)
            });
        }
    }
    Ok(())
}

/// As many as anybody's file requires, and how many more.
fn listed(names: &BTreeSet<&str>) -> String {
    const MOST: usize = 32;
    let first = names.iter().take(MOST).map(|name| quoted(name));
    let mut listed = first.collect::<Vec<_>>().join(", ");
    if let Some(more) = names.len().checked_sub(MOST).filter(|&more| more > 0) {
        listed += &format!(" and {more} more");
    }
    listed
}
