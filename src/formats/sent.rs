//! The files of a request, gathered and told apart.
//! Never lives here: what is in them.

use super::error::{FileFault, LoadError};
use super::lexer::Lexer;
use super::recognise::{self, Kind, base_name};
use super::source::{Budget, Denied, Source};
use super::{FileRef, text};
use std::collections::HashSet;
use std::sync::Arc;

/// A file of the request, in memory.
#[derive(Debug)]
pub(super) struct Sent {
    /// As the request gives it.
    pub name: String,
    pub bytes: Arc<[u8]>,
    pub kind: Kind,
    /// Whether it was opened by its name, so that there is a folder to look beside it.
    pub by_path: bool,
}

impl Sent {
    pub(super) fn lexer(&self) -> Result<Lexer<'_>, FileFault> {
        Ok(Lexer::new(
            &self.name,
            text::decode(&self.name, &self.bytes)?,
        ))
    }
}

/// Checks the names, then reads and recognises the files in the order given.
pub(super) fn gather(
    files: &[FileRef],
    source: &Source,
    budget: &mut Budget,
) -> Result<Vec<Sent>, LoadError> {
    if files.is_empty() {
        return Err(LoadError::NoFiles);
    }
    let mut names = HashSet::new();
    for file in files {
        let name = name_of(file);
        check_name(name)?;
        if !names.insert(base_name(name)) {
            let name = base_name(name).to_owned();
            return Err(LoadError::SameName { name });
        }
    }
    files
        .iter()
        .map(|file| {
            let name = name_of(file).to_owned();
            let (bytes, by_path) = match file {
                FileRef::Path(path) => {
                    let bytes = source
                        .read(path, budget)
                        .map_err(|denied| of_request(denied, path));
                    (bytes?, true)
                }
                FileRef::Inline(file) => {
                    budget.spend(file.bytes.len() as u64)?;
                    (file.bytes.clone(), false)
                }
            };
            let kind = recognise::recognise(&name, &bytes)?;
            Ok(Sent {
                name,
                bytes,
                kind,
                by_path,
            })
        })
        .collect()
}

pub(super) fn of_kind(sent: &[Sent], kind: Kind) -> impl Iterator<Item = &Sent> {
    sent.iter().filter(move |file| file.kind == kind)
}

/// The skeleton, if there is one.
///
/// # Errors
/// Where there are two, or where no file is one that a rig can be made of.
pub(super) fn only_skeleton(sent: &[Sent]) -> Result<Option<&Sent>, LoadError> {
    let mut skeletons = of_kind(sent, Kind::Cse169Skel);
    let first = skeletons.next();
    if let (Some(first), Some(second)) = (first, skeletons.next()) {
        let (first, second) = (first.name.clone(), second.name.clone());
        return Err(LoadError::TwoSkeletons { first, second });
    }
    match sent.first() {
        Some(file) if sent.iter().all(|file| file.kind == Kind::Other) => {
            let found = recognise::describe(&file.bytes);
            Err(FileFault::whole(&file.name, recognise::EXPECTED, found).into())
        }
        _ => Ok(first),
    }
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
