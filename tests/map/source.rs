//! The source as the map's tests read it: its files, and what each defines and names. Never lives here: what is allowed.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A file of `src`.
pub struct Source {
    /// Below `src`, e.g. `render/cpu/mod.rs`.
    pub file: String,
    pub room: String,
    /// Where its items stand in the crate: `["render", "cpu"]`.
    pub module: Vec<String>,
    /// Without comments, strings and tests.
    pub tokens: Vec<String>,
}

/// What one `use` brings into a module.
#[derive(Debug, PartialEq)]
pub struct Import {
    pub path: Vec<String>,
    /// What it is called from here on; `*` for everything.
    pub name: String,
    pub is_reexport: bool,
}

/// What a file says of other files.
pub struct Names {
    /// Items, also those inside of others.
    pub items: BTreeSet<String>,
    pub modules: BTreeSet<String>,
    pub imports: Vec<Import>,
    /// Outside of imports: every path, a single word too.
    pub paths: BTreeSet<Vec<String>>,
}

impl Source {
    pub fn new(file: &str, text: &str) -> Self {
        let parts = file.trim_end_matches(".rs").split('/');
        let mut module: Vec<String> = parts.map(str::to_owned).collect();
        module.pop_if(|last| last == "mod" || last == "lib");
        let room = match module.as_slice() {
            [render, side, ..] if render == "render" && (side == "gpu" || side == "cpu") => {
                format!("render::{side}")
            }
            [room, ..] => room.clone(),
            [] => "lib".to_owned(),
        };
        let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
        Self {
            file: file.to_owned(),
            room,
            module,
            tokens: tokens(code),
        }
    }

    pub fn names(&self) -> Names {
        let mut names = Names {
            items: BTreeSet::new(),
            modules: BTreeSet::new(),
            imports: Vec::new(),
            paths: BTreeSet::new(),
        };
        let mut rest = self.tokens.as_slice();
        let mut is_public = false;
        while let Some((token, after)) = rest.split_first() {
            let next = after.first().map_or("", String::as_str);
            rest = after;
            match token.as_str() {
                // `pub(in crate::formats)` names no file.
                "pub" if next == "(" => rest = past(after, ")"),
                // Not what a returned type captures: `use<'a>`.
                "use" if next != "<" => {
                    rest = past(after, ";");
                    let tree = &after[..after.len() - rest.len()];
                    import(
                        &mut tree.iter().peekable(),
                        &[],
                        is_public,
                        &mut names.imports,
                    );
                }
                "mod" if after.get(1).is_some_and(|it| it == ";") => {
                    names.modules.insert(next.to_owned());
                }
                "fn" | "struct" | "enum" | "union" | "trait" | "type" | "const" | "static" => {
                    names.items.insert(next.to_owned());
                }
                word if is_word(word) => {
                    let mut path = vec![word.to_owned()];
                    while let [joint, word, ..] = rest
                        && joint == "::"
                        && is_word(word)
                    {
                        path.push(word.clone());
                        rest = &rest[2..];
                    }
                    names.paths.insert(path);
                }
                _ => {}
            }
            is_public = token == "pub";
        }
        names
    }
}

/// What follows the first of these tokens.
fn past<'a>(tokens: &'a [String], end: &str) -> &'a [String] {
    let at = tokens.iter().position(|token| token == end);
    &tokens[at.map_or(tokens.len(), |at| at + 1)..]
}

/// One branch of a `use`, up to the comma, brace or semicolon that ends it.
fn import(
    tokens: &mut std::iter::Peekable<std::slice::Iter<'_, String>>,
    trunk: &[String],
    is_reexport: bool,
    found: &mut Vec<Import>,
) {
    const ENDS: [&str; 2] = ["}", ";"];
    let mut path = trunk.to_vec();
    let mut name = None;
    while let Some(token) = tokens.next_if(|it| *it != "," && !ENDS.contains(&it.as_str())) {
        match token.as_str() {
            "::" => {}
            "{" => {
                while tokens
                    .peek()
                    .is_some_and(|token| !ENDS.contains(&token.as_str()))
                {
                    import(tokens, &path, is_reexport, found);
                    tokens.next_if(|token| *token == ",");
                }
                tokens.next();
                return;
            }
            "as" => name = tokens.next().cloned(),
            // As in `{self, Name}`.
            "self" if !path.is_empty() => {}
            word => path.push(word.to_owned()),
        }
    }
    if let Some(last) = path.last() {
        let name = name.unwrap_or_else(|| last.clone());
        found.push(Import {
            path,
            name,
            is_reexport,
        });
    }
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Words, numbers, `::`, and all else one character at a time. Comments and what stands between quotes are left out.
fn tokens(code: &str) -> Vec<String> {
    let continues = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = literal(rest) {
            length
        } else {
            let length = match rest.find(|c| !continues(c)).unwrap_or(rest.len()) {
                0 if rest.starts_with("::") => 2,
                0 => first.len_utf8(),
                word => word,
            };
            if !first.is_whitespace() {
                found.push(rest[..length].to_owned());
            }
            length
        };
        rest = &rest[length..];
    }
    found
}

/// The length of the string or character that the code starts with; a lifetime is neither.
fn literal(code: &str) -> Option<usize> {
    let unprefixed = code.trim_start_matches(['b', 'c', 'r']);
    let prefix = code.len() - unprefixed.len();
    let hashes = unprefixed.len() - unprefixed.trim_start_matches('#').len();
    if code[..prefix].contains('r') && unprefixed[hashes..].starts_with('"') {
        let end = format!("\"{}", "#".repeat(hashes));
        let start = prefix + hashes + 1;
        return Some(
            code[start..]
                .find(&end)
                .map_or(code.len(), |at| start + at + end.len()),
        );
    }
    let mut characters = unprefixed.char_indices();
    let (_, quote) = characters.next().filter(|it| ['"', '\''].contains(&it.1))?;
    let [second, third] = [1, 2].map(|at| unprefixed.chars().nth(at));
    if quote == '\'' && second != Some('\\') && third != Some('\'') {
        return None;
    }
    while let Some((at, character)) = characters.next() {
        if character == '\\' {
            characters.next();
        } else if character == quote {
            return Some(prefix + at + 1);
        }
    }
    None
}

/// Every file of `src` but those of tests.
pub fn sources() -> Vec<Source> {
    fn collect(folder: &Path, prefix: &str, found: &mut Vec<Source>) {
        for entry in fs::read_dir(folder).expect("src can be listed") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy();
            let file = format!("{prefix}{name}");
            if path.is_dir() && name != "tests" {
                collect(&path, &format!("{file}/"), found);
            } else if name.ends_with(".rs") && name != "tests.rs" {
                let text = fs::read_to_string(&path).expect("a source file can be read");
                found.push(Source::new(&file, &text));
            }
        }
    }
    let mut found = Vec::new();
    collect(
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src")),
        "",
        &mut found,
    );
    found.sort_by(|a, b| a.file.cmp(&b.file));
    found
}
