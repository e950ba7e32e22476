//! The files of one load: those of the request, and those that these refer to, looked up among the others or beside them.
//! Never lives here: what is in them, and what becomes of a file that cannot be had.

use super::error::{FileFault, LoadError, quoted};
use super::format::Evidence;
use super::names::base_name;
use super::recognise::{Formats, Recognised};
use super::source::{Budget, Denied, Source};
use super::text::{self, comments};
use crate::limits::Limits;
use crate::rig::Warnings;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file as a request names it.
#[derive(Debug, Clone)]
pub enum FileRef {
    /// Opened by the [`Source`]; relative to its root where it has one.
    Path(String),
    /// Sent with the request; no file is opened.
    Inline(File),
}

/// A file that came with the request.
#[derive(Debug, Clone)]
pub struct File {
    /// As given, e.g. `wasp/wasp.skel`; other files know it by what follows the last slash.
    pub name: String,
    /// All of its content, not decoded.
    pub bytes: Arc<[u8]>,
}

/// A file in memory.
#[derive(Debug)]
pub(super) struct Gathered {
    /// As the request gives it. That of a file that another one refers to is made of the other's folder and what it is called there.
    pub name: String,
    pub bytes: Arc<[u8]>,
    pub recognised: Recognised,
    /// Whether it was opened by its name, so that there is a folder to look beside it.
    pub by_path: bool,
}

impl Gathered {
    /// Whether it is of a format of its own, and not what one of those may refer to.
    pub(super) fn is_rig_file(&self) -> bool {
        self.recognised != Recognised::Other
    }

    /// Whether it would be read alike under any name.
    pub(super) fn is_known_by_content(&self) -> bool {
        matches!(self.recognised, Recognised::As(_, Evidence::Content))
    }

    /// What it is: `a CSE 169 skin`.
    pub(super) fn described(&self) -> String {
        self.recognised.described(&self.bytes)
    }

    pub(super) fn text(&self, warnings: &mut Warnings) -> Result<Cow<'_, str>, FileFault> {
        text::decode(&self.name, &self.bytes, warnings)
    }

    /// The text of a file of the courses.
    pub(super) fn uncommented(&self, warnings: &mut Warnings) -> Result<Cow<'_, str>, FileFault> {
        comments::blanked(&self.name, self.text(warnings)?, warnings)
    }
}

/// Every file that was read so far.
pub(super) struct Files<'a> {
    /// In the order of the request; never empty.
    sent: Vec<Arc<Gathered>>,
    by_base_name: HashMap<String, usize>,
    by_any_case: Spellings,
    /// Of each file sent, whether another refers to it.
    used: Vec<bool>,
    /// Files that were not sent, by their paths.
    found: BTreeMap<PathBuf, Arc<Gathered>>,
    /// What is in folders that a file was looked for in, by their paths.
    listed: HashMap<PathBuf, Spellings>,
    other_spellings: Warnings,
    formats: Formats,
    source: &'a Source,
    budget: Budget<'a>,
}

/// Names by what they are in lower case.
#[derive(Debug, Default)]
struct Spellings(HashMap<String, Vec<String>>);

impl Spellings {
    fn of(names: impl IntoIterator<Item = String>) -> Self {
        let mut spellings = Self::default();
        for name in names {
            let alike = spellings.0.entry(name.to_lowercase()).or_default();
            alike.push(name);
        }
        spellings
    }

    /// The name that `name` is in whatever case. Of several, only one that is spelled alike is meant.
    fn find(&self, name: &str) -> Option<&str> {
        let alike = self.0.get(&name.to_lowercase())?;
        let exact = alike.iter().find(|known| *known == name);
        exact
            .or(alike.first().filter(|_| alike.len() == 1))
            .map(String::as_str)
    }
}

impl<'a> Files<'a> {
    /// Checks the names, then reads and recognises the files in the order given.
    pub(super) fn gather(
        files: &[FileRef],
        formats: Formats,
        source: &'a Source,
        limits: &'a Limits,
    ) -> Result<Self, LoadError> {
        if files.is_empty() {
            return Err(LoadError::NoFiles);
        }
        let mut by_base_name = HashMap::new();
        for (index, file) in files.iter().enumerate() {
            let name = name_of(file);
            check_name(name)?;
            let base_name = base_name(name).to_owned();
            if by_base_name.insert(base_name.clone(), index).is_some() {
                return Err(LoadError::SameName { name: base_name });
            }
        }
        let mut budget = Budget::new(limits);
        let sent = files
            .iter()
            .map(|file| read(file, formats, source, &mut budget).map(Arc::new))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            sent,
            by_any_case: Spellings::of(by_base_name.keys().cloned()),
            by_base_name,
            used: vec![false; files.len()],
            found: BTreeMap::new(),
            listed: HashMap::new(),
            other_spellings: Warnings::default(),
            formats,
            source,
            budget,
        })
    }

    pub(super) fn formats(&self) -> Formats {
        self.formats
    }

    pub(super) fn sent(&self) -> &[Arc<Gathered>] {
        &self.sent
    }

    /// What `from` calls `name`: a file of the request with that base name, else one beside `from` where that was opened by path.
    /// Where there is neither, one whose name differs in case alone, or has `/` for `\`, is taken with a warning.
    pub(super) fn look_up(&mut self, from: &Gathered, name: &str) -> Result<Arc<Gathered>, Denied> {
        match self.look_up_exactly(from, name) {
            Err(Denied::NotFound) => {}
            found => return found,
        }
        let spelled = self.spelled_otherwise(from, name).ok_or(Denied::NotFound)?;
        let found = self.look_up_exactly(from, &spelled)?;
        self.other_spellings.push(|| {
            let (asked, spelled) = (quoted(name), quoted(&spelled));
            format!("{}: the file {asked} is taken for {spelled}", from.name)
        });
        Ok(found)
    }

    /// A file that another one refers to, but that nobody needs, is used all the same.
    pub(super) fn pass_over(&mut self, name: &str) {
        let known = self.by_any_case.find(base_name(name));
        if let Some(&index) = known.and_then(|known| self.by_base_name.get(known)) {
            self.used[index] = true;
        }
    }

    fn spelled_otherwise(&mut self, from: &Gathered, name: &str) -> Option<String> {
        if let Some(sent) = self.by_any_case.find(base_name(name)) {
            return Some(sent.to_owned());
        }
        if !from.by_path {
            return None;
        }
        let mut spelled = String::new();
        for part in name.split(['/', '\\']) {
            let folder = Path::new(&from.name).with_file_name(&spelled);
            let listed = self.listed.entry(folder).or_insert_with(|| {
                let names = self.source.names_beside(&from.name, &spelled);
                Spellings::of(names.unwrap_or_default())
            });
            let found = listed.find(part)?;
            if !spelled.is_empty() {
                spelled.push('/');
            }
            spelled.push_str(found);
        }
        Some(spelled)
    }

    fn look_up_exactly(&mut self, from: &Gathered, name: &str) -> Result<Arc<Gathered>, Denied> {
        if let Some(&index) = self.by_base_name.get(base_name(name)) {
            self.used[index] = true;
            return Ok(self.sent[index].clone());
        }
        if !from.by_path {
            return Err(Denied::NotFound);
        }
        let path = Path::new(&from.name).with_file_name(name);
        if let Some(found) = self.found.get(&path) {
            return Ok(found.clone());
        }
        let bytes = self
            .source
            .read_beside(&from.name, name, &mut self.budget)?;
        // Digest and messages know a file by its base name, so that no two may differ in a rig.
        let mut others = self.sent.iter().chain(self.found.values());
        let is_other =
            |file: &Arc<Gathered>| base_name(&file.name) == base_name(name) && file.bytes != bytes;
        if others.any(is_other) {
            return Err(Denied::NotAllowed(
                "another file of that name is part of the rig",
            ));
        }
        let found = Arc::new(Gathered {
            name: path.display().to_string(),
            recognised: self.formats.recognise(name, &bytes),
            bytes,
            by_path: true,
        });
        self.found.insert(path, found.clone());
        Ok(found)
    }

    /// Once all are read: of files that were found under another spelling, and of those that nothing needed.
    pub(super) fn warn(&mut self, warnings: &mut Warnings) {
        warnings.append(std::mem::take(&mut self.other_spellings));
        for (file, used) in self.sent.iter().zip(&self.used) {
            if !file.is_rig_file() && !used {
                warnings.push(|| format!("`{}` is not used: no file refers to it", file.name));
            }
        }
    }

    /// Base name and content of every file sent or found.
    pub(super) fn all(&self) -> Vec<(&str, &[u8])> {
        let files = self.sent.iter().chain(self.found.values());
        files
            .map(|file| (base_name(&file.name), &*file.bytes))
            .collect()
    }
}

fn read(
    file: &FileRef,
    formats: Formats,
    source: &Source,
    budget: &mut Budget,
) -> Result<Gathered, LoadError> {
    let name = name_of(file);
    let (bytes, by_path) = match file {
        FileRef::Path(path) => {
            let bytes = source.read(path, budget);
            (bytes.map_err(|denied| of_request(denied, path))?, true)
        }
        FileRef::Inline(file) => {
            budget.spend(file.bytes.len() as u64)?;
            (file.bytes.clone(), false)
        }
    };
    let recognised = formats.recognise(name, &bytes);
    if let Recognised::NotRead(_) = recognised {
        let found = recognised.described(&bytes);
        return Err(FileFault::whole(name, formats.expected(), found).into());
    }
    Ok(Gathered {
        name: name.to_owned(),
        bytes,
        recognised,
        by_path,
    })
}

fn name_of(file: &FileRef) -> &str {
    match file {
        FileRef::Path(path) => path,
        FileRef::Inline(file) => &file.name,
    }
}

fn check_name(name: &str) -> Result<(), LoadError> {
    /// The longest path that Linux opens. Names come again in every warning.
    const NAME_BYTES: usize = 4096;
    let refuse = |file: &str, reason| {
        let file = file.to_owned();
        Err(LoadError::PathNotAllowed { file, reason })
    };
    if base_name(name).is_empty() {
        return refuse(name, "it does not end in a file name");
    }
    if name.len() > NAME_BYTES {
        let shown = name
            .char_indices()
            .nth(40)
            .map_or(name, |(end, _)| &name[..end]);
        return refuse(&format!("{shown}…"), "its name is longer than 4096 bytes");
    }
    Ok(())
}

fn of_request(denied: Denied, path: &str) -> LoadError {
    let file = path.to_owned();
    match denied {
        Denied::NotFound => LoadError::FileNotFound { file },
        Denied::NotAllowed(reason) => LoadError::PathNotAllowed { file, reason },
        Denied::Limit(exceeded) => exceeded.into(),
        Denied::Io(source) => LoadError::Io { file, source },
    }
}
