//! Which file needs which, and which room re-exports what is another's. Never lives here: how files are read.
//!
//! A path leads to the file that defines what it names: through `super`, `mod`, `use` and `pub use`. What a `mod.rs` declares, the files
//! below it may name: that is no arrow. All other arrows between files must not form a circle.

use crate::source::{Names, Source};
use std::collections::{BTreeMap, BTreeSet};

/// The files of a crate by their modules.
struct Files<'a> {
    modules: BTreeMap<&'a [String], (&'a Source, Names)>,
}

/// A path leads through no more `use`s than this.
const STEPS: usize = 12;

impl<'a> Files<'a> {
    fn new(sources: &'a [Source]) -> Self {
        let modules = sources
            .iter()
            .filter(|source| source.file != "main.rs")
            .map(|source| (source.module.as_slice(), (source, source.names())));
        Self {
            modules: modules.collect(),
        }
    }

    /// The file that defines what the path means in a module. `None` for what is not of this crate.
    fn home(&self, module: &[String], path: &[String]) -> Option<&'a Source> {
        self.find(module, path, STEPS)
    }

    fn find(&self, module: &[String], path: &[String], steps: usize) -> Option<&'a Source> {
        let (source, names) = self.modules.get(module)?;
        let Some((first, rest)) = path.split_first() else {
            return Some(source);
        };
        let steps = steps.checked_sub(1)?;
        match first.as_str() {
            "crate" => return self.find_below(&[], rest, steps),
            "self" => return self.find_below(module, rest, steps),
            "super" => return self.find_below(module.split_last()?.1, rest, steps),
            _ => {}
        }
        if names.modules.contains(first) {
            return self.find_below(&[module, std::slice::from_ref(first)].concat(), rest, steps);
        }
        let mut imports = names.imports.iter();
        if let Some(import) = imports.find(|import| import.name == *first) {
            return self.find(module, &[&import.path, rest].concat(), steps);
        }
        if names.items.contains(first) {
            return Some(source);
        }
        let globs = names.imports.iter().filter(|import| import.name == "*");
        globs
            .filter(|glob| ["crate", "self", "super"].contains(&glob.path[0].as_str()))
            .find_map(|glob| {
                let folder = &glob.path[..glob.path.len() - 1];
                let other = self.find(module, folder, steps)?;
                self.find(&other.module, path, steps)
            })
    }

    /// What a path names in a module that it led to: what is not found there, a macro may have made.
    fn find_below(&self, module: &[String], path: &[String], steps: usize) -> Option<&'a Source> {
        let found = self.find(module, path, steps);
        found.or_else(|| self.modules.get(module).map(|(source, _)| *source))
    }

    /// The files that each file needs.
    fn arrows(&self) -> BTreeMap<&'a str, BTreeSet<&'a str>> {
        let mut arrows: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
        for (module, (source, names)) in &self.modules {
            let imports = names
                .imports
                .iter()
                // What is only re-exported is not needed here.
                .filter(|it| !it.is_reexport || names.paths.iter().any(|path| path[0] == it.name))
                .map(|import| &import.path);
            let needed = imports
                .chain(names.paths.iter().filter(|path| path.len() > 1))
                .filter_map(|path| self.home(module, path))
                .filter(|other| !module.starts_with(&other.module))
                .map(|other| other.file.as_str());
            arrows.insert(source.file.as_str(), needed.collect());
        }
        arrows
    }
}

/// Each circle as its files in order, and the arrows that make it.
pub fn circles(sources: &[Source]) -> BTreeMap<String, Vec<String>> {
    let files = Files::new(sources);
    let arrows = files.arrows();
    let reached: BTreeMap<&str, BTreeSet<&str>> = arrows
        .keys()
        .map(|&file| {
            let mut reached = BTreeSet::new();
            let mut open = vec![file];
            while let Some(next) = open.pop() {
                open.extend(arrows[next].iter().filter(|&&other| reached.insert(other)));
            }
            (file, reached)
        })
        .collect();
    let mut circles = BTreeMap::new();
    for (&file, others) in reached
        .iter()
        .filter(|(file, others)| others.contains(*file))
    {
        let members: BTreeSet<&str> = others
            .iter()
            .copied()
            .filter(|other| reached[other].contains(file))
            .collect();
        let inside = members.iter().flat_map(|from| {
            let to = arrows[from].intersection(&members);
            to.map(move |to| format!("{from} -> {to}"))
        });
        let name = members.iter().copied().collect::<Vec<_>>().join(" ");
        circles.insert(name, inside.collect());
    }
    circles
}

/// What rooms re-export of other rooms: through them a third would name what it may not.
pub fn reexports(sources: &[Source]) -> BTreeSet<String> {
    let files = Files::new(sources);
    let mut found = BTreeSet::new();
    for (module, (source, names)) in files.modules.iter().filter(|it| !it.0.is_empty()) {
        for import in names.imports.iter().filter(|import| import.is_reexport) {
            let home = files.home(module, &import.path);
            if let Some(home) = home.filter(|home| home.module.first() != module.first()) {
                found.insert(format!("{}: {} of {}", source.file, import.name, home.file));
            }
        }
    }
    found
}
