//! Choices of materials (KHR_materials_variants), which a frame request may name. What is not as it should be is left out with a warning: no
//! file is refused for it. Never lives here: materials.

use super::extensions::VARIANTS;
use super::fault::Faults;
use super::json_fault::problem;
use crate::rig::{Draft, Warnings};
use gltf_json::Root;
use gltf_json::mesh::Primitive;
use serde::Deserialize;
use serde_json::Value;

/// Primitives times variants: each picture's order of them is kept on a graphics device. Files have a hundred times less.
const MOST: usize = 1 << 17;

/// The variants of one document.
pub(super) struct Variants<'a> {
    faults: Faults<'a>,
    listed: usize,
    /// Those of them that the draft has: the first.
    count: usize,
}

impl<'a> Variants<'a> {
    /// Adds their names to the draft.
    pub(super) fn read(faults: Faults<'a>, root: &Root, draft: &mut Draft) -> Self {
        let listed = root.extensions.as_ref();
        let listed = listed.and_then(|it| it.others.get(VARIANTS)?.get("variants")?.as_array());
        let listed = listed.map_or(&[][..], Vec::as_slice);
        let meshes = root.nodes.iter().filter_map(|node| node.mesh);
        let meshes = meshes.filter_map(|mesh| root.meshes.get(mesh.value()));
        let primitives: usize = meshes.map(|mesh| mesh.primitives.len()).sum();
        let most = MOST / primitives.max(1);
        if listed.len() > most {
            let count = listed.len();
            let sentence =
                format!("of {count} variants of {primitives} primitives the first {most} are kept");
            draft.warnings.push(|| faults.warning(&sentence));
        }
        for (index, variant) in listed.iter().enumerate().take(most) {
            let path = format!("extensions.{VARIANTS}.variants[{index}]");
            let name = variant.get("name").and_then(Value::as_str);
            draft
                .variants
                .push(faults.name(name, &path, &mut draft.warnings));
        }
        Self {
            faults,
            listed: listed.len(),
            count: draft.variants.len(),
        }
    }

    /// `(variant, material of the file)` as the primitive at `path` has them.
    pub(super) fn of_primitive(
        &self,
        primitive: &Primitive,
        path: &str,
        root: &Root,
        warnings: &mut Warnings,
    ) -> Vec<(usize, usize)> {
        let extension = primitive.extensions.as_ref();
        let Some(extension) = extension.and_then(|it| it.others.get(VARIANTS)) else {
            return Vec::new();
        };
        let path = format!("{path}.extensions.{VARIANTS}");
        let mut leave_out = |path: &str, problem: &str| {
            let sentence = format!("{path} is left out: {problem}");
            warnings.push(|| self.faults.warning(&sentence));
        };
        let mappings = match OfPrimitive::deserialize(extension) {
            Ok(OfPrimitive { mappings }) => mappings,
            Err(error) => {
                leave_out(&path, &problem(&error));
                return Vec::new();
            }
        };
        let mut chosen = Vec::new();
        for (place, Mapping { material, variants }) in mappings.into_iter().enumerate() {
            let path = format!("{path}.mappings[{place}]");
            if material >= root.materials.len() {
                let count = root.materials.len();
                leave_out(&path, &format!("it names material {material} of {count}"));
                continue;
            }
            for variant in variants {
                if variant < self.count {
                    chosen.push((variant, material));
                } else if variant >= self.listed {
                    let listed = self.listed;
                    leave_out(&path, &format!("it names variant {variant} of {listed}"));
                }
            }
        }
        chosen
    }
}

#[derive(Deserialize)]
struct OfPrimitive {
    mappings: Vec<Mapping>,
}

#[derive(Deserialize)]
struct Mapping {
    material: usize,
    variants: Vec<usize>,
}
