//! Does the source keep to the map in `src/lib.rs`?

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

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

/// Every file of `src`, with the room it belongs to and its code without comments and tests.
fn sources() -> Vec<(String, String, String)> {
    fn collect(folder: &Path, found: &mut Vec<(String, String, String)>) {
        for entry in fs::read_dir(folder).expect("src can be listed") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                collect(&path, found);
            } else if path.extension().is_some_and(|extension| extension == "rs")
                && !path.ends_with("tests.rs")
            {
                let inner = path
                    .strip_prefix(concat!(env!("CARGO_MANIFEST_DIR"), "/src"))
                    .expect("below src");
                let inner = inner.to_string_lossy().replace('\\', "/");
                let parts: Vec<&str> = inner.trim_end_matches(".rs").split('/').collect();
                let room = match parts.as_slice() {
                    ["render", side @ ("gpu" | "cpu"), ..] => format!("render::{side}"),
                    [room, ..] => (*room).to_owned(),
                    [] => unreachable!("a path has parts"),
                };
                let text = fs::read_to_string(&path).expect("a source file can be read");
                let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
                let code: Vec<&str> = code
                    .lines()
                    .filter(|line| !line.trim_start().starts_with("//"))
                    .collect();
                found.push((inner, room, code.join("\n")));
            }
        }
    }
    let mut found = Vec::new();
    collect(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src")),
        &mut found,
    );
    found
}

/// Rooms named after `crate::`, also inside braces: `crate::render::gpu::X` names `render` and `render::gpu`.
fn rooms_named(code: &str) -> BTreeSet<String> {
    let mut named = BTreeSet::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let path: String = rest
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_' || *c == ':')
            .collect();
        let parts: Vec<&str> = path.split("::").collect();
        named.insert(parts[0].to_owned());
        if let ["render", side @ ("gpu" | "cpu"), ..] = parts.as_slice() {
            named.insert(format!("render::{side}"));
        }
        assert!(
            !rest.starts_with('{'),
            "`crate::{{…}}` hides which rooms are named: write one `use` for each"
        );
    }
    named
}

fn violations(map: &str, sources: &[(String, String, String)]) -> Vec<String> {
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
    for (file, room, code) in sources {
        if matches!(room.as_str(), "lib" | "main") {
            continue;
        }
        let outer = room.split("::").next().unwrap_or(room);
        let Some(allowed) = arrows.get(outer) else {
            found.push(format!("{file}: room `{outer}` is not on the map"));
            continue;
        };
        for named in rooms_named(code) {
            let named_outer = named.split("::").next().unwrap_or(&named);
            let is_twin =
                named != *room && named.starts_with("render::") && room.starts_with("render::");
            if is_twin || (named_outer != outer && !allowed.contains(named_outer)) {
                found.push(format!("{file}: `{room}` names `{named}`"));
            }
        }
        for (outside, rooms) in &homes {
            let is_named = names_path(code, outside) || code.contains(&format!("use {outside};"));
            if is_named && !rooms.contains(room) && !rooms.contains(outer) {
                found.push(format!("{file}: `{outside}` is not at home in `{room}`"));
            }
        }
    }
    found
}

/// Whether a path in the code starts with this: `png::` is not in `apng::Decoder`.
fn names_path(code: &str, outside: &str) -> bool {
    let continues_a_name = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(&format!("{outside}::"))
        .any(|(at, _)| !code[..at].ends_with(continues_a_name))
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
    let listed: Vec<String> = rows(&map, "# Rooms and arrows")
        .iter()
        .map(|row| names(&row[0])[0].clone())
        .collect();
    let modules: Vec<String> = map
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod "))
        .map(|name| name.trim_end_matches(';').to_owned())
        .collect();
    assert_eq!(
        listed.iter().collect::<BTreeSet<_>>(),
        modules.iter().collect::<BTreeSet<_>>()
    );
    assert_eq!(listed.len(), modules.len());

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
    for (room, code, wanted) in [
        (
            "pose",
            "use crate::engine::Engine;",
            "`pose` names `engine`",
        ),
        (
            "render::cpu",
            "use crate::render::gpu::Gpu;",
            "`render::cpu` names `render::gpu`",
        ),
        (
            "server",
            "fn f() { wgpu::f() }",
            "`wgpu` is not at home in `server`",
        ),
        ("attic", "", "room `attic` is not on the map"),
    ] {
        let source = ("x.rs".to_owned(), room.to_owned(), code.to_owned());
        let found = violations(&map(), &[source]);
        assert!(
            found.len() == 1 && found[0].contains(wanted),
            "{room}: {found:?}"
        );
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
fn inexact(sources: &[(String, String, String)]) -> Vec<String> {
    let rooms = ["rig", "pose", "scene", "render", "render::cpu"];
    let mut found = Vec::new();
    for (file, room, code) in sources
        .iter()
        .filter(|source| rooms.contains(&source.1.as_str()))
    {
        for name in INEXACT
            .iter()
            .filter(|name| code.contains(&format!(".{name}(")))
        {
            found.push(format!(
                "{file}: `{name}` in `{room}` differs between machines"
            ));
        }
    }
    found
}

#[test]
fn nothing_on_the_way_to_a_pixel_differs_between_machines() {
    let found = inexact(&sources());
    assert!(found.is_empty(), "{}", found.join("\n"));
    let wrong = (
        "x.rs".to_owned(),
        "pose".to_owned(),
        "angle.sin()".to_owned(),
    );
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
