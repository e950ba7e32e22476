//! The file family of the MIT course 6.837: one reader per extension, the grammar in its module doc. Rows are lines here. Its meshes are
//! OBJ files.
//! Never lives here: other dialects that use the same extensions.

mod attach;
mod skel;
#[cfg(test)]
mod tests;

use super::context::Context;
use super::contribution::{KnownMesh, KnownSkeleton, Weights};
use super::error::LoadError;
use super::files::Gathered;
use super::format::{Evidence, Format};
use super::obj;
use super::reader::{Contribution, Reader, WeightsReader};
use super::text::lexer::Lexer;
use crate::rig::JointDraft;

const FAMILY: &str = "MIT 6.837";

pub(super) static SKEL: Reader = Reader {
    format: &SKEL_FORMAT,
    contribution: Contribution::Skeleton(read_skel),
};

static SKEL_FORMAT: Format = Format {
    name: "mit6837 skel",
    family: FAMILY,
    extensions: &["skel"],
    what: "a MIT 6.837 skeleton",
    noun: "skeleton",
    sniff: |opening| {
        // Any file may start with a number.
        let is_own = opening.extension == "skel" && opening.starts_with_number();
        is_own.then_some(Evidence::ContentAndExtension)
    },
};

pub(super) static ATTACH: Reader = Reader {
    format: &ATTACH_FORMAT,
    contribution: Contribution::Weights(WeightsReader {
        mesh: obj::OBJ.format,
        skeleton: &SKEL_FORMAT,
        read: read_attach,
    }),
};

static ATTACH_FORMAT: Format = Format {
    name: "mit6837 attach",
    family: FAMILY,
    extensions: &["attach"],
    what: "a MIT 6.837 attachment list",
    noun: "`.attach`",
    sniff: |_| None,
};

fn read_skel(file: &Gathered, context: &mut Context) -> Result<Vec<JointDraft>, LoadError> {
    let warnings = &mut context.warnings;
    let text = file.uncommented(warnings)?;
    skel::read(Lexer::new(&file.name, &text), context.limits, warnings)
}

fn read_attach(
    file: &Gathered,
    context: &mut Context,
    mesh: KnownMesh,
    skeleton: KnownSkeleton,
) -> Result<Weights, LoadError> {
    let text = file.uncommented(&mut context.warnings)?;
    let lexer = Lexer::new(&file.name, &text);
    attach::read(lexer, mesh, skeleton, context.limits)
}
