//! Does the source keep to the map in `src/lib.rs`? Never lives here: how the source is read.

mod files;
mod source;

use files::{circles, reexports};
use source::{Source, sources};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;

type Table = BTreeMap<String, BTreeSet<String>>;

/// The words between backticks of one cell.
fn names(cell: &str) -> Vec<String> {
    cell.split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

/// The rows of the table under a heading of the crate's documentation, cell by cell.
fn rows(map: &str, heading: &str) -> Vec<Vec<String>> {
    let lines = map
        .lines()
        .map(|line| line.trim_start_matches("//!").trim());
    let under = lines.skip_while(|line| *line != heading).skip(1);
    let table = under
        .take_while(|line| !line.starts_with("# "))
        .filter(|line| line.starts_with('|'));
    // The first two are the header and its rule.
    table
        .skip(2)
        .map(|line| {
            line.trim_matches('|')
                .split(" | ")
                .map(|cell| cell.trim().to_owned())
                .collect()
        })
        .collect()
}

/// The paths that a file names, imported or not. A single word may be anything.
fn named(source: &Source) -> Vec<Vec<String>> {
    let names = source.names();
    let imported = names.imports.into_iter().map(|import| import.path);
    let paths = names.paths.into_iter().filter(|path| path.len() > 1);
    imported.chain(paths).collect()
}

/// `crate::render::gpu::X` names `render` and `render::gpu`.
fn rooms(named: &[Vec<String>]) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for path in named.iter().filter(|path| path[0] == "crate") {
        found.extend(path.get(1).cloned());
        let sides = ["render::gpu", "render::cpu"].into_iter();
        found.extend(
            sides
                .filter(|side| is_below(&path[1..], side))
                .map(str::to_owned),
        );
    }
    found
}

fn is_below(path: &[String], outer: &str) -> bool {
    let mut parts = path.iter();
    outer
        .split("::")
        .all(|part| parts.next().is_some_and(|found| found == part))
}

fn violations(map: &str, sources: &[Source]) -> Vec<String> {
    let arrows: Table = rows(map, "# Rooms and arrows")
        .iter()
        .map(|row| {
            (
                names(&row[0])[0].clone(),
                names(&row[1]).into_iter().collect(),
            )
        })
        .collect();
    let mut homes = Table::new();
    for row in rows(map, "# Homes of what comes from outside") {
        for outside in names(&row[0]) {
            homes.insert(outside, names(&row[1]).into_iter().collect());
        }
    }
    let mut found = Vec::new();
    for source in sources {
        let Source { file, room, .. } = source;
        if matches!(room.as_str(), "lib" | "main") {
            continue;
        }
        let outer = room.split("::").next().unwrap_or(room);
        let Some(allowed) = arrows.get(outer) else {
            found.push(format!("{file}: room `{outer}` is not on the map"));
            continue;
        };
        let named = named(source);
        for named in rooms(&named) {
            let named_outer = named.split("::").next().unwrap_or(&named);
            let is_other_renderer =
                named != *room && named.starts_with("render::") && room.starts_with("render::");
            if is_other_renderer || (named_outer != outer && !allowed.contains(named_outer)) {
                found.push(format!("{file}: `{room}` names `{named}`"));
            }
        }
        for (outside, rooms) in &homes {
            if named.iter().any(|path| is_below(path, outside))
                && !rooms.contains(room)
                && !rooms.contains(outer)
            {
                found.push(format!("{file}: `{outside}` is not at home in `{room}`"));
            }
        }
    }
    found
}

fn map() -> String {
    fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/src/lib.rs"))
        .expect("src/lib.rs can be read")
}

#[test]
fn the_source_keeps_to_the_map() {
    let found = violations(&map(), &sources());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn every_room_is_on_the_map_once_and_every_dependency_has_a_home() {
    let map = map();
    let mut listed: Vec<String> = rows(&map, "# Rooms and arrows")
        .iter()
        .map(|row| names(&row[0])[0].clone())
        .collect();
    let rooms: BTreeSet<String> = sources()
        .into_iter()
        .map(|source| {
            source
                .room
                .split("::")
                .next()
                .unwrap_or_default()
                .to_owned()
        })
        .filter(|room| !matches!(room.as_str(), "lib" | "main"))
        .collect();
    listed.sort();
    assert_eq!(listed, Vec::from_iter(rooms));

    let manifest =
        fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")).expect("Cargo.toml");
    let section = manifest
        .split("[dependencies]")
        .nth(1)
        .and_then(|rest| rest.split("\n[").next())
        .expect("dependencies");
    for dependency in section
        .lines()
        .filter_map(|line| line.split_once(" ="))
        .map(|(name, _)| name.replace('-', "_"))
    {
        assert!(
            map.contains(&format!("`{dependency}`")),
            "`{dependency}` has no home on the map"
        );
    }
}

#[test]
fn a_wrong_arrow_is_seen() {
    for (file, code, wanted) in [
        (
            "pose/x.rs",
            "use crate::engine::Engine;",
            "`pose` names `engine`",
        ),
        (
            "pose/x.rs",
            "use crate::{rig::Rig, engine};",
            "`pose` names `engine`",
        ),
        (
            "render/cpu/x.rs",
            "use crate::render::gpu::Gpu;",
            "`render::cpu` names `render::gpu`",
        ),
        (
            "server/x.rs",
            "fn f() { wgpu::f() }",
            "`wgpu` is not at home in `server`",
        ),
        (
            "pose/x.rs",
            "use std::{fs, io};",
            "`std::fs` is not at home in `pose`",
        ),
        ("attic/x.rs", "", "room `attic` is not on the map"),
    ] {
        let source = Source::new(file, code);
        let found = violations(&map(), &[source]);
        assert!(
            found.len() == 1 && found[0].contains(wanted),
            "{code}: {found:?}"
        );
    }
}

#[test]
fn no_files_name_each_other_in_a_circle() {
    let found = circles(&sources());
    let arrows: Vec<String> = found.values().map(|arrows| arrows.join("\n")).collect();
    assert!(found.is_empty(), "{}", arrows.join("\n\n"));
}

#[test]
fn no_room_reexports_what_is_of_another() {
    let found = Vec::from_iter(reexports(&sources()));
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn circles_of_files_are_seen() {
    const B: &str = "pose/b.rs";
    let circle = |names: &str| vec![names.to_owned()];
    for (files, wanted) in [
        (
            [
                (B, "use super::c::C;"),
                ("pose/c.rs", "use crate::pose::b;"),
            ],
            circle("pose/b.rs pose/c.rs"),
        ),
        (
            [
                (B, "use super::{d, c::{C, D}};"),
                ("pose/c.rs", "fn f() { super::b::f() }"),
            ],
            circle("pose/b.rs pose/c.rs"),
        ),
        // Through the module above, which re-exports it under another name.
        (
            [
                (B, "use super::E;"),
                ("pose/c.rs", "pub struct C; use super::b::B;"),
            ],
            circle("pose/b.rs pose/c.rs"),
        ),
        (
            [
                (B, "use super::*; fn f() -> E { E::new() }"),
                ("pose/c.rs", "pub struct C(super::B);"),
            ],
            circle("pose/b.rs pose/c.rs"),
        ),
        (
            [
                (B, "use crate::rig::Rig;"),
                (
                    "rig/mod.rs",
                    "pub struct Rig; fn f() { crate::pose::b::f() }",
                ),
            ],
            circle("pose/b.rs rig/mod.rs"),
        ),
        // A file and the head of its folder are no circle.
        ([(B, "use super::f;"), ("pose/c.rs", "")], vec![]),
        (
            [
                (B, "use super::c::C;"),
                (
                    "pose/c.rs",
                    "// super::b::B\nconst C: &str = \"super::b\"; #[cfg(test)]\nmod tests { use super::super::b; }",
                ),
            ],
            vec![],
        ),
    ] {
        let head = "mod b;\nmod c;\npub use {b::B, c::C as E};\nfn f() { b::f() }";
        let mut sources = vec![
            Source::new("lib.rs", "pub mod pose;\npub mod rig;"),
            Source::new("pose/mod.rs", head),
        ];
        sources.extend(files.map(|(file, code)| Source::new(file, code)));
        assert_eq!(
            Vec::from_iter(circles(&sources).into_keys()),
            wanted,
            "{files:?}"
        );
    }
}

#[test]
fn reexports_of_other_rooms_are_seen() {
    for (code, wanted) in [
        (
            "pub use crate::rig::Rig;",
            vec!["pose/mod.rs: Rig of rig/mod.rs"],
        ),
        (
            "pub(crate) use crate::{rig::{Rig as Character}};",
            vec!["pose/mod.rs: Character of rig/mod.rs"],
        ),
        (
            "use crate::rig; pub use rig::*;",
            vec!["pose/mod.rs: * of rig/mod.rs"],
        ),
        (
            "use crate::rig::Rig; pub use self::x::X; mod x; pub use std::f32;",
            vec![],
        ),
    ] {
        let files = [
            ("lib.rs", "pub mod pose; pub mod rig;"),
            ("pose/mod.rs", code),
            ("pose/x.rs", "pub struct X;"),
            ("rig/mod.rs", "pub struct Rig;"),
        ];
        let found = reexports(&files.map(|(file, code)| Source::new(file, code)));
        assert_eq!(Vec::from_iter(found), wanted, "{code}");
    }
}

/// Functions of the standard library that are the system's own, or fuse what others round twice.
const INEXACT: [&str; 17] = [
    "sin",
    "cos",
    "tan",
    "sin_cos",
    "asin",
    "acos",
    "atan",
    "atan2",
    "exp",
    "exp2",
    "ln",
    "log2",
    "powf",
    "powi",
    "hypot",
    "mul_add",
    "approximate_recip",
];

/// Where such a function is called in what pixels and vertices are made of.
fn inexact(sources: &[Source]) -> Vec<String> {
    let rooms = ["rig", "pose", "scene", "render", "render::cpu"];
    let mut found = Vec::new();
    for Source {
        file, room, tokens, ..
    } in sources
    {
        for call in tokens.windows(3) {
            if let [dot, name, parenthesis] = call
                && dot == "."
                && parenthesis == "("
                && INEXACT.contains(&name.as_str())
                && rooms.contains(&room.as_str())
            {
                found.push(format!(
                    "{file}: `{name}` in `{room}` differs between machines"
                ));
            }
        }
    }
    found
}

#[test]
fn nothing_on_the_way_to_a_pixel_differs_between_machines() {
    let found = inexact(&sources());
    assert!(found.is_empty(), "{}", found.join("\n"));
    let wrong = Source::new("pose/x.rs", "angle.sin()");
    assert_eq!(inexact(&[wrong]).len(), 1);
    // Its vector types do both.
    let manifest =
        fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")).expect("Cargo.toml");
    let glam = manifest
        .lines()
        .find(|line| line.starts_with("glam ="))
        .expect("glam");
    assert!(
        glam.contains("scalar-math") && glam.contains("libm"),
        "{glam}"
    );
}
