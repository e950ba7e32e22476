//! Where bytes come from: a folder that nothing leads out of, the whole file system for the command line, or nowhere.
//! Never lives here: what the bytes mean.

use crate::limits::{LimitExceeded, Limits};
use cap_std::ambient_authority;
use cap_std::fs::{Dir, File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

/// Where the paths of a request may be opened.
#[derive(Debug)]
pub struct Source(Reach);

#[derive(Debug)]
enum Reach {
    Nowhere,
    Below(Dir),
    Anywhere,
}

impl Source {
    /// Files come inside the request; no path is opened.
    pub fn inline_only() -> Self {
        Self(Reach::Nowhere)
    }

    /// Paths are below `folder`. Neither `..` nor an absolute path nor a symbolic link leads out of it.
    ///
    /// # Errors
    /// Where `folder` cannot be opened as a folder.
    pub fn rooted(folder: &Path) -> io::Result<Self> {
        Dir::open_ambient_dir(folder, ambient_authority()).map(|dir| Self(Reach::Below(dir)))
    }

    /// Any path that the user of a command line names; what such a file refers to is only looked up in that file's folder.
    pub fn local() -> Self {
        Self(Reach::Anywhere)
    }

    pub(super) fn read(&self, path: &str, budget: &mut Budget) -> Result<Arc<[u8]>, Denied> {
        match &self.0 {
            Reach::Nowhere => Err(Denied::NotAllowed(
                "the server was started without a root folder, so files have to come with the request",
            )),
            Reach::Below(_) if Path::new(path).has_root() => {
                Err(Denied::NotAllowed("it is not relative to the root"))
            }
            Reach::Below(dir) => read_below(dir, Path::new(path), budget),
            Reach::Anywhere => {
                // Looked at before it is opened: opening a device can do things.
                check_regular(&std::fs::metadata(path).map(Metadata::from_just_metadata)?)?;
                let authority = ambient_authority();
                read_regular(
                    File::open_ambient_with(path, &reading(), authority)?,
                    budget,
                )
            }
        }
    }

    /// Reads what `file`, itself read from here, calls `name`.
    pub(super) fn read_beside(
        &self,
        file: &str,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Arc<[u8]>, Denied> {
        self.beside(file, name, |dir, path| read_below(dir, path, budget))
    }

    /// The names in a folder that `file`, itself read from here, calls `folder`; empty is its own.
    pub(super) fn names_beside(&self, file: &str, folder: &str) -> Result<Vec<String>, Denied> {
        /// Folders of characters hold hundreds of files; what comes after so many is not looked at.
        const NAMES: usize = 65_536;
        self.beside(file, folder, |dir, path| {
            let entries = dir.read_dir(or_here(path))?.take(NAMES);
            let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
            Ok(names.collect())
        })
    }

    /// Hands over the folder that nothing may lead out of, and the path in it of what `file` calls `name`.
    fn beside<T>(
        &self,
        file: &str,
        name: &str,
        then: impl FnOnce(&Dir, &Path) -> Result<T, Denied>,
    ) -> Result<T, Denied> {
        let folder = Path::new(file).parent().unwrap_or(Path::new(""));
        match &self.0 {
            Reach::Nowhere => Err(Denied::NotFound),
            Reach::Below(dir) => then(dir, &folder.join(name)),
            Reach::Anywhere => {
                let dir = Dir::open_ambient_dir(or_here(folder), ambient_authority())?;
                then(&dir, Path::new(name))
            }
        }
    }
}

/// The empty path names no folder to the system.
fn or_here(folder: &Path) -> &Path {
    match folder.as_os_str().is_empty() {
        true => Path::new("."),
        false => folder,
    }
}

/// The bytes that one request's files may still take.
#[derive(Debug)]
pub(super) struct Budget<'a> {
    limits: &'a Limits,
    used: u64,
}

impl<'a> Budget<'a> {
    pub(super) fn new(limits: &'a Limits) -> Self {
        Self { limits, used: 0 }
    }

    fn left(&self) -> u64 {
        self.limits.rig_file_bytes.saturating_sub(self.used)
    }

    fn check(&self, bytes: u64) -> Result<(), LimitExceeded> {
        self.limits.rig_file_bytes(self.used.saturating_add(bytes))
    }

    pub(super) fn spend(&mut self, bytes: u64) -> Result<(), LimitExceeded> {
        self.check(bytes)?;
        self.used += bytes;
        Ok(())
    }
}

/// Why a file was not read. Names no path: the caller knows what the request called it.
#[derive(Debug)]
pub(super) enum Denied {
    NotFound,
    NotAllowed(&'static str),
    Limit(LimitExceeded),
    Io(io::Error),
}

impl Denied {
    /// In words, to follow a colon.
    pub(super) fn reason(&self) -> String {
        match self {
            Self::NotFound => "it was not found".to_owned(),
            Self::NotAllowed(reason) => (*reason).to_owned(),
            Self::Limit(exceeded) => exceeded.to_string(),
            Self::Io(error) => error.to_string(),
        }
    }
}

impl From<LimitExceeded> for Denied {
    fn from(exceeded: LimitExceeded) -> Self {
        Self::Limit(exceeded)
    }
}

impl From<io::Error> for Denied {
    fn from(error: io::Error) -> Self {
        use io::ErrorKind;
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::NotFound,
            // The sandbox raises this one itself, so no number of the system's comes with it.
            ErrorKind::PermissionDenied if error.raw_os_error().is_none() => {
                Self::NotAllowed("it leads out of the folder that files are read from")
            }
            ErrorKind::PermissionDenied => Self::NotAllowed("the system denies access to it"),
            ErrorKind::InvalidInput | ErrorKind::InvalidFilename => {
                Self::NotAllowed("it is not a path")
            }
            _ => Self::Io(error),
        }
    }
}

fn read_below(dir: &Dir, path: &Path, budget: &mut Budget) -> Result<Arc<[u8]>, Denied> {
    check_regular(&dir.metadata(path)?)?;
    read_regular(dir.open_with(path, &reading())?, budget)
}

fn read_regular(file: File, budget: &mut Budget) -> Result<Arc<[u8]>, Denied> {
    let metadata = file.metadata()?;
    check_regular(&metadata)?;
    budget.check(metadata.len())?;
    let mut bytes = Vec::with_capacity(usize::try_from(metadata.len()).unwrap_or(0));
    // The file may have grown since; one byte more than allowed is enough to notice.
    file.take(budget.left().saturating_add(1))
        .read_to_end(&mut bytes)?;
    budget.spend(bytes.len() as u64)?;
    Ok(bytes.into())
}

fn check_regular(metadata: &Metadata) -> Result<(), Denied> {
    if metadata.is_file() {
        Ok(())
    } else {
        Err(Denied::NotAllowed("it is not a regular file"))
    }
}

fn reading() -> OpenOptions {
    let mut options = OpenOptions::new();
    options.read(true);
    // A pipe put in the file's place after it was looked at must not keep us waiting for a writer.
    #[cfg(all(
        target_os = "linux",
        any(target_arch = "x86_64", target_arch = "aarch64")
    ))]
    {
        use cap_std::fs::OpenOptionsExt;
        const O_NONBLOCK: i32 = 0o4000;
        options.custom_flags(O_NONBLOCK);
    }
    options
}

#[cfg(test)]
mod tests;
