//! Faults of a glTF file, which name the path of the member at fault. Never lives here: what is a fault.

use crate::formats::error::{FileFault, LoadError, quoted};
use crate::rig::Warnings;
use gltf_json::Index;
use gltf_json::validation::Checked;
use serde_json::Value;

/// As of the other formats.
const NAME_BYTES: usize = 256;

/// Makes faults of one file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Faults<'a> {
    pub file: &'a str,
    /// What the file says, once it is known.
    pub json: Option<&'a Value>,
}

impl Faults<'_> {
    pub(super) fn whole(self, expected: impl Into<String>, found: impl Into<String>) -> FileFault {
        FileFault::whole(self.file, expected, found)
    }

    /// `path` leads to the member: `accessors[3].count`.
    pub(super) fn at(
        self,
        path: &str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> FileFault {
        self.whole(format!("{path}: {}", expected.into()), found)
    }

    pub(super) fn load(
        self,
        path: &str,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> LoadError {
        self.at(path, expected, found).into()
    }

    /// What an index leads to in a list of that name.
    pub(super) fn get<'r, T>(
        self,
        list: &'r [T],
        name: &str,
        index: Index<T>,
        path: &str,
    ) -> Result<&'r T, FileFault> {
        list.get(index.value()).ok_or_else(|| {
            let expected = match list.len() {
                0 => format!("no index, for the file has no {name}"),
                1 => format!("0, the only one of the {name}"),
                count => format!("one of the {count} {name}"),
            };
            self.at(path, expected, index.value().to_string())
        })
    }

    /// A word or number that is one of a few.
    pub(super) fn valid<T: Copy>(
        self,
        value: Checked<T>,
        path: &str,
        expected: &str,
    ) -> Result<T, FileFault> {
        match value {
            Checked::Valid(value) => Ok(value),
            Checked::Invalid => Err(self.at(path, expected, self.found(path))),
        }
    }

    /// What stands at a path.
    pub(super) fn found(self, path: &str) -> String {
        let found = self.json.and_then(|json| member(json, path));
        found.map_or_else(|| "another".to_owned(), |it| quoted(&it.to_string()))
    }

    /// What a file calls something; one that is too long is cut. Names come again in every description of a rig, and in messages.
    pub(super) fn name(self, name: Option<&str>, path: &str, warnings: &mut Warnings) -> String {
        let name = name.unwrap_or_default();
        if name.len() <= NAME_BYTES {
            return name.to_owned();
        }
        warnings.push(|| self.warning(&format!("{path}.name has {} bytes and is cut", name.len())));
        let ends = name.char_indices().map(|(start, _)| start);
        let end = ends.take_while(|&end| end <= NAME_BYTES).last();
        name[..end.unwrap_or_default()].to_owned()
    }

    pub(super) fn warning(self, sentence: &str) -> String {
        format!("{}: {sentence}", self.file)
    }
}

/// What a path as [`Faults::at`] takes it leads to.
fn member<'v>(json: &'v Value, path: &str) -> Option<&'v Value> {
    let mut words = path.split(['.', '[', ']']).filter(|word| !word.is_empty());
    words.try_fold(json, |at, word| match word.parse::<usize>() {
        Ok(index) => at.get(index),
        Err(_) => at.get(word),
    })
}
