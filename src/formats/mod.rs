//! From files to a [`Rig`]: finds out what each file is, reads it, and looks up what it refers to.
//! Never lives here: posing, drawing, and any file name that the request did not give.
//!
//! A load goes through these files in turn: `files` has the bytes, `recognise` finds the format of each file by the table in `readers`,
//! `parts` tells which files are the rig and whether they go together, `assemble` has each one read and puts what they contribute together
//! to a [`Draft`](crate::rig::Draft), which the rig is built from.

mod assemble;
mod context;
mod contribution;
mod cse169;
mod digest;
mod error;
mod files;
mod format;
mod gltf;
mod mit;
mod names;
mod obj;
mod parts;
mod pictures;
mod reader;
mod readers;
mod recognise;
mod source;
mod text;
mod textures;

pub use error::{FileFault, LoadError};
pub use files::{File, FileRef};
pub use source::Source;

use crate::limits::Limits;
use crate::rig::{Rig, RigError, RigProblem, Warnings};
use assemble::assemble;
use context::Context;
use files::Files;
use parts::Parts;
use textures::Textures;

/// What is read, in the words of [`Loaded::dialects`].
pub const FORMATS: &[&str] = &readers::NAMES;

/// A rig and what its files say about it as files.
#[derive(Debug)]
pub struct Loaded {
    /// What the files hold together, validated.
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
    let mut context = Context {
        limits,
        files: Files::gather(files, readers::TABLE, source, limits)?,
        textures: Textures::new(limits),
        warnings: Warnings::default(),
    };
    let parts = Parts::gather(&mut context)?;
    let mut draft = assemble(&parts, &mut context)?;
    let Context {
        mut files,
        mut warnings,
        ..
    } = context;
    files.warn(&mut warnings);
    draft.warnings = warnings;
    let rig = draft.build(limits).map_err(refused)?;

    let formats = || parts.all().filter_map(|file| file.recognised.format());
    let is_used = |name: &&str| formats().any(|format| format.name == *name);
    Ok(Loaded {
        rig,
        name: names::stem(&files.sent()[0].name).to_owned(),
        digest: match files.all().as_slice() {
            [(_, content)] if files.sent()[0].is_known_by_content() => digest::of_content(content),
            _ => digest::of(files.all()),
        },
        dialects: FORMATS.iter().copied().filter(is_used).collect(),
    })
}

/// What the readers let through and the rig refuses all the same.
fn refused(error: RigError) -> LoadError {
    let file = error.file.as_deref().unwrap_or_default();
    let fault = match error.problem {
        RigProblem::Limit(exceeded) => return exceeded.into(),
        RigProblem::Empty => FileFault::whole(file, "a joint or a mesh", "nothing to draw"),
        problem => FileFault::whole(file, "a consistent rig", problem.to_string()),
    };
    fault.into()
}

#[cfg(test)]
mod tests;
