//! `rigd inspect`: what is in the files of a rig. Needs no graphics.

use super::{builtin, printable};
use crate::formats::Source;
use crate::limits::Limits;
use crate::protocol::rig::{DofDescription, DofKind, RigDescription};
use crate::service::describe_files;
use clap::Args;
use std::fmt::Write;

#[derive(Args)]
pub(super) struct InspectArgs {
    /// Files of the rig, in any order; without any, as for `rigd serve`
    files: Vec<String>,
    /// Print what `rig.describe` would answer
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &InspectArgs) -> anyhow::Result<()> {
    let files = builtin::files_or_default(&args.files);
    let rig = describe_files(&files, &Source::local(), &Limits::default())?;
    if args.json {
        super::print(&serde_json::to_string_pretty(&rig)?)
    } else {
        super::print(printable(&text(&rig)?).trim_end())
    }
}

fn text(rig: &RigDescription) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let summary = &rig.summary;
    writeln!(text, "{}  ({})", summary.name, summary.dialects.join(", "))?;
    writeln!(text, "{}", summary.digest)?;
    let counts = [
        (summary.joint_count, "joints"),
        (summary.dof_count, "DOFs"),
        (summary.vertex_count, "vertices"),
        (summary.triangle_count, "triangles"),
    ];
    let counts: Vec<_> = counts
        .iter()
        .map(|(count, noun)| format!("{count} {noun}"))
        .collect();
    writeln!(text, "{}", counts.join(", "))?;
    writeln!(
        text,
        "bounds at rest {:.4?} .. {:.4?}",
        rig.bounds.min, rig.bounds.max
    )?;
    for mesh in &rig.meshes {
        let material = mesh
            .material
            .as_deref()
            .map_or(String::new(), |material| format!(", material {material}"));
        let texcoords = if mesh.has_texcoords {
            ", texture coordinates"
        } else {
            ""
        };
        let (vertices, triangles) = (mesh.vertex_count, mesh.triangle_count);
        writeln!(
            text,
            "mesh {}: {vertices} vertices, {triangles} triangles{material}{texcoords}",
            mesh.name
        )?;
    }
    for material in &rig.materials {
        let texture = material.texture.as_deref().unwrap_or("no texture");
        writeln!(text, "material {}: {texture}", material.name)?;
    }
    let mut depths = std::collections::HashMap::new();
    for joint in &rig.joints {
        let depth = joint
            .parent
            .as_ref()
            .and_then(|parent| depths.get(parent))
            .map_or(0, |depth: &usize| depth + 1);
        depths.insert(joint.name.clone(), depth);
        writeln!(text, "{:indent$}{}", "", joint.name, indent = 2 * depth)?;
        for dof in rig
            .dofs
            .iter()
            .filter(|dof| dof.joint.as_deref() == Some(&joint.name))
        {
            writeln!(
                text,
                "{:indent$}{}",
                "",
                dof_line(dof, &joint.name),
                indent = 2 * depth + 4
            )?;
        }
    }
    for warning in &summary.warnings {
        writeln!(text, "warning: {warning}")?;
    }
    Ok(text)
}

fn dof_line(dof: &DofDescription, joint: &str) -> String {
    let suffix = dof.name.strip_prefix(joint).unwrap_or(&dof.name);
    let number = |value: f64| match dof.kind {
        DofKind::Rotation => format!("{:.1}°", value.to_degrees()),
        DofKind::Translation | DofKind::Morph => format!("{value:.4}"),
    };
    let limits = match (dof.min, dof.max) {
        (None, None) => String::new(),
        (min, max) => {
            let end = |end: Option<f64>| end.map_or("any".to_owned(), number);
            format!("  in {} .. {}", end(min), end(max))
        }
    };
    format!("{suffix} = {}{limits}", number(dof.rest))
}
