//! `rigd inspect`: what is in the files of a rig. Needs no graphics.

mod tree;

use super::angle::Unit;
use super::builtin;
use super::exit::{self, Outcome};
use super::numbers::decimal;
use super::terminal::{Warnings, print, printable};
use crate::formats::Source;
use crate::limits::Limits;
use crate::protocol::rig::{
    BoundsOf, DofDescription, DofKind, LightDescription, LightKind, MeshDescription,
    MorphDescription, RigBounds, RigDescription,
};
use crate::service::describe_files;
use clap::Args;
use std::collections::HashMap;
use std::fmt::Write;
use tree::Tree;

#[derive(Args)]
#[command(after_long_help = exit::CODES)]
pub(super) struct InspectArgs {
    /// Files of the rig, in any order; without any, as for `rigd serve`
    files: Vec<String>,
    /// Print what `rig.describe` would answer
    #[arg(long)]
    json: bool,
    /// End with exit code 3 where there are warnings
    #[arg(long)]
    strict: bool,
}

pub(super) fn run(args: &InspectArgs) -> anyhow::Result<Outcome> {
    let files = builtin::files_or_default(&args.files);
    let rig = describe_files(&files, &Source::local(), &Limits::default())?;
    if args.json {
        print(&serde_json::to_string_pretty(&rig)?)?;
    } else {
        print(printable(&text(&rig)?).trim_end())?;
    }
    let mut warnings = Warnings::default();
    warnings.count(rig.summary.warnings.len());
    Ok(Outcome::of(&warnings, args.strict))
}

fn text(rig: &RigDescription) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let summary = &rig.summary;
    writeln!(text, "{}  ({})", summary.name, summary.dialects.join(", "))?;
    writeln!(text, "{}", summary.digest)?;
    let counts = [
        counted(summary.joint_count, "joint"),
        counted(summary.dof_count, "DOF"),
        counted_vertices(summary.vertex_count),
        counted(summary.triangle_count, "triangle"),
    ];
    writeln!(text, "{}", counts.join(", "))?;
    let RigBounds { of, bounds } = rig.bounds;
    let of = match of {
        BoundsOf::Vertices => "vertices",
        BoundsOf::Joints => "joints",
    };
    let (min, max) = (bounds.min, bounds.max);
    writeln!(text, "bounds of {of} at rest {min:.4?} .. {max:.4?}")?;

    let materials = rig.materials.iter().map(|material| {
        let texture = material.texture.as_deref();
        format!("{}: {}", material.name, texture.unwrap_or("no texture"))
    });
    let clips = rig.clips.iter().map(|clip| {
        let [start, end] = clip.range;
        let channels = counted(clip.channel_count, "channel");
        format!("{}: {start} s to {end} s, {channels}", clip.name)
    });
    section(&mut text, "meshes", rig.meshes.iter().map(mesh_line))?;
    section(&mut text, "materials", materials)?;
    section(&mut text, "variants", rig.variants.iter().cloned())?;
    section(&mut text, "lights", rig.lights.iter().map(light_line))?;
    section(&mut text, "morphs", morph_lines(rig).into_iter())?;
    section(&mut text, "clips", clips)?;
    if !rig.joints.is_empty() {
        writeln!(text, "\njoints")?;
        joint_tree(rig).write(&mut text)?;
    }
    section(&mut text, "warnings", summary.warnings.iter().cloned())?;
    Ok(text)
}

/// A heading and its lines; nothing where there are none.
fn section(
    text: &mut String,
    heading: &str,
    lines: impl Iterator<Item = String>,
) -> std::fmt::Result {
    let mut tree = Tree::default();
    for line in lines {
        tree.push(None, line);
    }
    if tree.is_empty() {
        return Ok(());
    }
    writeln!(text, "\n{heading}")?;
    tree.write(text)
}

fn mesh_line(mesh: &MeshDescription) -> String {
    let mut parts = vec![
        counted_vertices(mesh.vertex_count),
        counted(mesh.triangle_count, "triangle"),
    ];
    parts.extend(
        mesh.material
            .as_ref()
            .map(|name| format!("material {name}")),
    );
    if mesh.has_texcoords {
        parts.push("texture coordinates".to_owned());
    }
    format!("{}: {}", mesh.name, parts.join(", "))
}

fn light_line(light: &LightDescription) -> String {
    let LightDescription {
        name, intensity, ..
    } = light;
    let (kind, unit) = match light.kind {
        LightKind::Directional => ("directional", "lx"),
        LightKind::Point => ("point", "cd"),
        LightKind::Spot => ("spot", "cd"),
    };
    let joint = light.joint.as_ref();
    let on = joint.map_or(String::new(), |joint| format!(", on {joint}"));
    format!("{name}: {kind}, {intensity} {unit}{on}")
}

fn morph_lines(rig: &RigDescription) -> Vec<String> {
    let dofs: HashMap<&str, &DofDescription> = rig
        .dofs
        .iter()
        .map(|dof| (dof.name.as_str(), dof))
        .collect();
    let line = |morph: &MorphDescription| {
        let moved = counted_vertices(morph.vertex_count);
        let name = format!("morph.{}", morph.name);
        let weight = dofs
            .get(name.as_str())
            .map_or(String::new(), |dof| format!(", weight{}", value_of(dof)));
        format!("{name}: {moved} of mesh {}{weight}", morph.mesh)
    };
    rig.morphs.iter().map(line).collect()
}

/// The joints, each with its degrees of freedom before its children.
fn joint_tree(rig: &RigDescription) -> Tree {
    let mut dofs = HashMap::<&str, Vec<&DofDescription>>::new();
    for dof in &rig.dofs {
        if let Some(joint) = &dof.joint {
            dofs.entry(joint).or_default().push(dof);
        }
    }
    let mut nodes = HashMap::new();
    let mut tree = Tree::default();
    for joint in &rig.joints {
        let parent = joint.parent.as_ref().and_then(|parent| nodes.get(parent));
        let node = tree.push(parent.copied(), joint.name.clone());
        let own = dofs.remove(joint.name.as_str()).unwrap_or_default();
        for alike in own.chunk_by(|a, b| a.kind == b.kind && is_free(a) && is_free(b)) {
            let suffix = |dof: &&DofDescription| {
                let name = dof.name.strip_prefix(&joint.name);
                name.unwrap_or(&dof.name).to_owned()
            };
            let names: Vec<_> = alike.iter().map(suffix).collect();
            tree.note(node, format!("{}{}", names.join(" "), values_of(alike)));
        }
        nodes.insert(&joint.name, node);
    }
    tree
}

fn is_free(dof: &DofDescription) -> bool {
    (dof.min, dof.max) == (None, None)
}

/// What degrees of freedom of one kind are at rest, and where a single one may go.
fn values_of(alike: &[&DofDescription]) -> String {
    match alike {
        [dof] => value_of(dof),
        several => {
            let numbers: Vec<_> = several
                .iter()
                .map(|dof| number(dof.kind, dof.rest))
                .collect();
            format!(" = {}", numbers.join(" "))
        }
    }
}

fn number(kind: DofKind, value: f64) -> String {
    match kind {
        DofKind::Rotation => Unit::Degrees.show(value),
        DofKind::Translation | DofKind::Scale | DofKind::Morph => decimal(value),
    }
}

/// What a degree of freedom is at rest, and where it may go.
fn value_of(dof: &DofDescription) -> String {
    let number = |value: f64| number(dof.kind, value);
    let limits = match (dof.min, dof.max) {
        (None, None) => String::new(),
        (min, max) => {
            let end = |end: Option<f64>| end.map_or("any".to_owned(), number);
            format!("  in {} .. {}", end(min), end(max))
        }
    };
    format!(" = {}{limits}", number(dof.rest))
}

fn counted(count: u64, noun: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{ending}")
}

fn counted_vertices(count: u64) -> String {
    let noun = if count == 1 { "vertex" } else { "vertices" };
    format!("{count} {noun}")
}
