//! glTF 2.0, as text or binary: the scene graph becomes the skeleton, every mesh of a node a mesh, every animation a clip. What a document
//! refers to is looked up among the files of the request or below the document's own folder, never anywhere else.
//! Never lives here: cameras, which a frame request brings.

mod accessors;
mod animations;
mod attributes;
mod buffers;
mod bytes;
mod container;
mod elements;
mod empty_members;
mod extensions;
mod fault;
mod influences;
mod joints;
mod json_fault;
mod lights;
mod materials;
mod meshes;
mod nodes;
mod normalize;
mod rules;
mod skins;
mod textures;
mod variants;

use super::context::Context;
use super::error::LoadError;
use super::files::Gathered;
use super::format::{Evidence, Format};
use super::reader::{Contribution, Reader};
use crate::rig::Draft;
use accessors::{Accessors, MOST_NUMBERS};
use animations::AnimationReader;
use buffers::Buffers;
use fault::Faults;
use materials::Materials;
use meshes::{MeshReader, Totals};
use nodes::Nodes;
use skins::Skins;
use std::cell::Cell;
use std::collections::HashMap;
use variants::Variants;

pub(super) static GLTF: Reader = Reader {
    format: &Format {
        name: "gltf",
        family: "glTF 2.0",
        extensions: &["gltf", "glb"],
        what: "a glTF document",
        noun: "glTF document",
        sniff: |opening| {
            // Text is known by its extension, but as no other format is like it, a name makes no difference to how it is read.
            let is_own =
                opening.bytes.starts_with(b"glTF") || matches!(opening.extension, "gltf" | "glb");
            is_own.then_some(Evidence::Content)
        },
    },
    contribution: Contribution::Whole(read),
};

/// # Errors
/// [`LoadError::Invalid`] names the member at fault by its path, [`LoadError::Limit`] the ceiling that the document exceeds.
fn read(file: &Gathered, context: &mut Context) -> Result<Draft, LoadError> {
    let mut draft = Draft::default();
    let Context { limits, files, .. } = context;
    let limits = *limits;
    let faults = Faults {
        file: &file.name,
        json: None,
    };
    let container = container::read(faults, &file.bytes, limits, &mut draft.warnings)?;
    let root = &container.root;
    let faults = Faults {
        json: Some(&container.json),
        ..faults
    };
    let buffers = Buffers::gather(faults, &container, file, files, &mut draft.warnings)?;
    let left = Cell::new(MOST_NUMBERS);
    let accessors = Accessors {
        faults,
        root,
        buffers: &buffers,
        left: &left,
    };
    let nodes = Nodes::gather(faults, root, limits, &mut draft.warnings)?;
    draft.lights = lights::read(faults, root, &nodes, limits, &mut draft.warnings);
    let variants = Variants::read(faults, root, &mut draft);
    let mut materials = Materials::read(accessors, file, files, limits, &mut draft)?;
    let mut meshes = MeshReader {
        accessors,
        nodes: &nodes,
        limits,
        skins: Skins::new(accessors),
        materials: &mut materials,
        variants: &variants,
        draft: &mut draft,
        totals: Totals::default(),
        target_names: HashMap::new(),
        morphs_of: vec![None; root.nodes.len()],
    };
    meshes.read()?;
    let MeshReader {
        morphs_of, skins, ..
    } = meshes;
    limits.clips(root.animations.len())?;
    let mut reader = AnimationReader {
        accessors,
        nodes: &nodes,
        limits,
        morphs_of: &morphs_of,
        keys: 0,
    };
    for (index, animation) in root.animations.iter().enumerate() {
        let clip = reader.read(index, animation, &mut draft.warnings)?;
        draft.clips.push(clip);
    }
    skins.check_unused(&mut draft.warnings)?;
    rules::warn(faults, root, &nodes, &mut draft.warnings);
    draft.joints = nodes.joints;
    if draft.joints.is_empty() && draft.meshes.is_empty() {
        let expected = "a scene with a node that is neither a camera nor a light";
        return Err(faults.whole(expected, "nothing to draw").into());
    }
    context.warnings.append(std::mem::take(&mut draft.warnings));
    Ok(draft)
}
