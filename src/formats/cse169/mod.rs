//! The file family of the UCSD course CSE 169: one reader per extension, the grammar in its module doc.
//! Never lives here: other dialects that use the same extensions.

mod anim;
mod common;
mod formats;
mod keywords;
mod list;
mod morph;
mod sections;
mod skel;
mod skin;

use super::context::Context;
use super::contribution::{KnownMesh, KnownSkeleton, ListEntry, LooseClip, MeshPart};
use super::error::LoadError;
use super::files::Gathered;
use super::reader::{Contribution, MeshReader, MorphReader, Reader};
use super::text::lexer::Lexer;
use crate::rig::{JointDraft, MorphDraft};

pub(super) static SKEL: Reader = Reader {
    format: &formats::SKEL,
    contribution: Contribution::Skeleton(read_skel),
};

pub(super) static SKIN: Reader = Reader {
    format: &formats::SKIN,
    contribution: Contribution::Mesh(MeshReader::Bound(read_skin)),
};

pub(super) static MORPH: Reader = Reader {
    format: &formats::MORPH,
    contribution: Contribution::Morph(MorphReader {
        mesh: &formats::SKIN,
        read: read_morph,
    }),
};

pub(super) static ANIM: Reader = Reader {
    format: &formats::ANIM,
    contribution: Contribution::Clip(read_anim),
};

pub(super) static RIG: Reader = Reader {
    format: &formats::RIG,
    contribution: Contribution::List(read_list),
};

fn read_skel(file: &Gathered, context: &mut Context) -> Result<Vec<JointDraft>, LoadError> {
    let warnings = &mut context.warnings;
    let text = file.uncommented(warnings)?;
    skel::read(Lexer::new(&file.name, &text), context.limits, warnings)
}

fn read_skin(
    file: &Gathered,
    context: &mut Context,
    skeleton: Option<KnownSkeleton>,
) -> Result<MeshPart, LoadError> {
    let warnings = &mut context.warnings;
    let text = file.uncommented(warnings)?;
    let lexer = Lexer::new(&file.name, &text);
    let skin = skin::read(lexer, skeleton, context.limits, warnings)?;
    Ok(skin.into_part(skeleton.is_some(), |texture| {
        let mention = (&*texture.name, &*texture.place);
        let textures = &mut context.textures;
        textures.look_up(&mut context.files, file, mention, &mut context.warnings)
    }))
}

fn read_morph(
    file: &Gathered,
    context: &mut Context,
    mesh: KnownMesh,
) -> Result<MorphDraft, LoadError> {
    let warnings = &mut context.warnings;
    let text = file.uncommented(warnings)?;
    let lexer = Lexer::new(&file.name, &text);
    morph::read(lexer, mesh, context.limits, warnings)
}

fn read_anim(file: &Gathered, context: &mut Context) -> Result<LooseClip, LoadError> {
    let warnings = &mut context.warnings;
    let text = file.uncommented(warnings)?;
    anim::read(Lexer::new(&file.name, &text), context.limits, warnings)
}

fn read_list(file: &Gathered, context: &mut Context) -> Result<Vec<ListEntry>, LoadError> {
    let warnings = &mut context.warnings;
    let text = file.uncommented(warnings)?;
    list::read(Lexer::new(&file.name, &text), context.limits, warnings)
}
