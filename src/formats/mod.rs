//! From files to a [`Rig`]: finds out what each file is, reads it, and looks up what it refers to.
//! Never lives here: posing, drawing, and any file name that the request did not give.

mod assemble;
mod comments;
mod cse169;
mod digest;
mod error;
mod files;
mod gltf;
mod lexer;
mod materials;
mod mit;
mod parts;
mod pictures;
mod recognise;
mod source;
mod text;
mod textures;

pub use error::{FileFault, LoadError};
pub use source::Source;

use crate::limits::Limits;
use crate::rig::{Rig, RigError, Warnings};
use assemble::assemble;
use files::{Files, Gathered};
use parts::Parts;
use recognise::Kind;
use std::sync::Arc;

/// What is read, in the words of [`Loaded::dialects`].
pub const FORMATS: &[&str] = &[
    "cse169 skel",
    "cse169 skin",
    "cse169 morph",
    "cse169 anim",
    "cse169 rig",
    "mit6837 skel",
    "obj",
    "mit6837 attach",
    "gltf",
];

/// A file as a request names it.
#[derive(Debug, Clone)]
pub enum FileRef {
    /// Opened by the [`Source`]; relative to its root where it has one.
    Path(String),
    Inline(File),
}

/// A file that came with the request.
#[derive(Debug, Clone)]
pub struct File {
    /// As given, e.g. `wasp/wasp.skel`; other files know it by what follows the last slash.
    pub name: String,
    pub bytes: Arc<[u8]>,
}

/// A rig and what its files say about it as files.
#[derive(Debug)]
pub struct Loaded {
    pub rig: Rig,
    /// The stem of the first file.
    pub name: String,
    /// `sha256:<hex>` over names and contents of all files, those referred to included; over the content alone where the rig is one file
    /// that its content alone tells the reader of.
    pub digest: String,
    /// The readers that were used, each once, in the order of [`FORMATS`].
    pub dialects: Vec<&'static str>,
}

/// Reads at most one skeleton, any number of meshes, each bound to it, and what moves them. Without a skeleton, meshes stay as they
/// were modelled. What the files contain that could be worked with, but should not be there, is in [`Rig::warnings`].
///
/// # Errors
/// [`LoadError`] names the file that is missing, forbidden or wrong, and what is wrong where.
pub fn load(files: &[FileRef], source: &Source, limits: &Limits) -> Result<Loaded, LoadError> {
    let mut files = Files::gather(files, source, limits)?;
    let mut warnings = Warnings::default();
    let parts = Parts::gather(&mut files, limits, &mut warnings)?;
    let mut draft = assemble(&parts, &mut files, limits, warnings)?;
    files.warn(&mut draft.warnings);
    let rig = draft.build(limits).map_err(|error| told(error, &parts))?;

    let is_used = |reader: &&str| parts.all().any(|file| file.kind.reader() == Some(reader));
    Ok(Loaded {
        rig,
        name: recognise::stem(&files.sent()[0].name).to_owned(),
        digest: match files.all().as_slice() {
            [(_, content)] if files.sent()[0].is_told_by_content() => digest::of_content(content),
            _ => digest::of(files.all()),
        },
        dialects: FORMATS.iter().copied().filter(is_used).collect(),
    })
}

/// What the readers let through and the rig refuses all the same: told of the file it most likely came from.
fn told(error: RigError, parts: &Parts) -> LoadError {
    let skeleton = parts.skeleton.as_ref().or(parts.document.as_ref());
    let of_mesh = |mesh: usize| parts.meshes.get(mesh);
    // Where an OBJ is bound is said by the skeleton.
    let says_bindings = of_mesh(0).filter(|mesh| mesh.kind != Kind::Obj);
    let file: Option<&Arc<Gathered>> = match error {
        RigError::Limit(exceeded) => return exceeded.into(),
        RigError::CountsDiffer { mesh, .. } | RigError::OutOfRange { mesh, .. } => of_mesh(mesh),
        RigError::SingularBinding { .. } => says_bindings,
        RigError::NotFinite { mesh, .. } => mesh.and_then(of_mesh),
        RigError::VertexTwice { morph, .. } => parts.morphs.get(morph),
        RigError::NoSuchDof { clip } | RigError::KeysOutOfOrder { clip } => parts.clips.get(clip),
        RigError::Empty | RigError::ParentNotBefore { .. } | RigError::LimitReversed { .. } => {
            skeleton
        }
    };
    let name = file
        .or(skeleton)
        .or(of_mesh(0))
        .map_or("", |file| &file.name);
    let fault = match error {
        RigError::Empty => FileFault::whole(name, "a joint or a mesh", "nothing to draw"),
        _ => FileFault::whole(name, "a rig without contradictions", error.to_string()),
    };
    fault.into()
}

#[cfg(test)]
mod tests;
