//! OBJ: one mesh, and the materials of the libraries that it names. Each module doc has the grammar of its file.
//! Never lives here: how a mesh is bound to a skeleton.

mod corner;
mod draw_vertices;
mod materials;
mod mesh;
mod mtl;
mod oddities;
mod polygon;
mod statements;

use super::context::Context;
use super::contribution::MeshPart;
use super::error::LoadError;
use super::files::Gathered;
use super::format::Format;
use super::reader::{Contribution, MeshReader, Reader};

pub(super) static OBJ: Reader = Reader {
    format: &Format {
        name: "obj",
        family: "",
        extensions: &["obj"],
        what: "an OBJ mesh",
        noun: "OBJ mesh",
        sniff: |_| None,
    },
    contribution: Contribution::Mesh(MeshReader::Unbound(read)),
};

fn read(file: &Gathered, context: &mut Context) -> Result<MeshPart, LoadError> {
    let warnings = &mut context.warnings;
    let text = file.text(warnings)?;
    let obj = mesh::read(&file.name, &text, context.limits, warnings)?;
    Ok(materials::resolve(file, obj, context))
}
