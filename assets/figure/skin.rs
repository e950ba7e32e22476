//! `figure.skin`: the surface with its texture coordinates, weights and bindings as text.
//! Nothing is decided here.

use super::body::Body;
use super::skeleton::{CLAVICLE, Joint, clean, joints};
use super::surface::Surface;
use super::unwrap::Unwrap;
use super::vectors::V;
use super::weights::tidy;
use std::fmt::Write as _;

pub fn skin(body: &Body, surface: &Surface, unwrap: &Unwrap) -> String {
    let all = joints();
    let each = |line: &dyn Fn(usize) -> String| unwrap.sources.iter().map(|&v| line(v)).collect();
    let mut out = String::new();
    block(&mut out, "positions", each(&|v| triple(surface.points[v])));
    block(&mut out, "normals", each(&|v| triple(surface.normals[v])));
    let texcoords = unwrap.texcoords.iter();
    let texcoords = texcoords.map(|[u, v]| format!("{u:.5} {v:.5}")).collect();
    block(&mut out, "texcoords", texcoords);
    let weights = each(&|v| weight_line(&all, &surface.weights[v], surface.right[v]));
    block(&mut out, "skinweights", weights);
    out += "material skin {\n  texture figure.png\n}\n";
    let triangles = unwrap.faces.iter();
    let triangles = triangles.map(|[a, b, c]| format!("{a} {b} {c}")).collect();
    block(&mut out, "triangles", triangles);
    let bindings = all.iter().map(|j| binding(body, *j)).collect();
    block(&mut out, "bindings", bindings);
    out
}

fn block(out: &mut String, name: &str, lines: Vec<String>) {
    let _ = writeln!(
        out,
        "{name} {} {{\n  {}\n}}",
        lines.len(),
        lines.join("\n  ")
    );
}

pub fn triple(v: V) -> String {
    let [x, y, z] = v.map(clean);
    format!("{x:.5} {y:.5} {z:.5}")
}

fn weight_line(all: &[Joint], weights: &[f64; 15], right: bool) -> String {
    let joint = |bone: usize| {
        let found = |j: &Joint| j.bone == bone && (j.right == right || bone < CLAVICLE);
        all.iter().position(found).unwrap_or(0)
    };
    let weights = weights.iter().enumerate();
    let kept = tidy(weights.map(|(bone, &w)| (joint(bone), w)).collect());
    let pairs = kept
        .iter()
        .map(|&(j, w)| format!(" {j} {}.{:04}", w / 10_000, w % 10_000));
    format!("{}{}", kept.len(), pairs.collect::<String>())
}

fn binding(body: &Body, j: Joint) -> String {
    let f = body.frames[j.bone];
    // Mirror in x: conjugate the rotation, reflect the origin.
    let s = if j.right { -1.0 } else { 1.0 };
    let [a, b, c] = f.axes;
    let columns = [
        [a[0], s * a[1], s * a[2]],
        [s * b[0], b[1], b[2]],
        [s * c[0], c[1], c[2]],
        [s * f.at[0], f.at[1], f.at[2]],
    ];
    let rows = columns.map(triple).join("  ");
    format!("matrix {{ {rows} }}")
}
