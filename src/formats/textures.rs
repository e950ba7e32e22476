//! Pictures that files refer to: among the files sent, else beside the file that refers to them.
//! Never lives here: what is inside a picture's file.

use super::cse169::skin::TextureName;
use super::error::{LoadError, quoted};
use super::pictures::{self, BadPicture};
use super::recognise::{Kind, base_name};
use super::sent::Sent;
use super::source::{Budget, Denied, Source};
use crate::limits::Limits;
use crate::rig::{Texture, Warnings};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) struct Textures<'a> {
    sent: &'a [Sent],
    by_base_name: HashMap<&'a str, usize>,
    /// Of each file sent, whether another refers to it.
    used: Vec<bool>,
    found: Vec<Found>,
    source: &'a Source,
    budget: Budget<'a>,
    limits: &'a Limits,
}

/// A picture that was not sent.
struct Found {
    path: PathBuf,
    base_name: String,
    encoded: Arc<[u8]>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(
        sent: &'a [Sent],
        source: &'a Source,
        budget: Budget<'a>,
        limits: &'a Limits,
    ) -> Self {
        let names = sent.iter().map(|file| base_name(&file.name));
        Self {
            sent,
            by_base_name: names.zip(0..).collect(),
            used: vec![false; sent.len()],
            found: Vec::new(),
            source,
            budget,
            limits,
        }
    }

    /// A texture that cannot be had is a warning: the rig is drawn without it.
    ///
    /// # Errors
    /// Only where its file is larger than the request's files may be, or has more pixels than a picture may.
    pub(super) fn look_up(
        &mut self,
        skin: &Sent,
        name: &TextureName,
        warnings: &mut Warnings,
    ) -> Result<Option<Arc<Texture>>, LoadError> {
        let reason = match self.find(skin, &name.file) {
            Ok(encoded) => match pictures::decode(&encoded, self.limits) {
                Ok(level) => return Ok(Some(Arc::new(Texture::new(name.file.clone(), level)))),
                Err(BadPicture::Limit(exceeded)) => return Err(exceeded.into()),
                Err(BadPicture::Undecodable(reason)) => reason,
            },
            Err(Denied::Limit(exceeded)) => return Err(exceeded.into()),
            Err(Denied::NotFound) => "it was not found".to_owned(),
            Err(Denied::NotAllowed(reason)) => reason.to_owned(),
            Err(Denied::Io(error)) => error.to_string(),
        };
        warnings.push(|| {
            let texture = quoted(&name.file);
            format!(
                "{}: the texture {texture} is left out: {reason}",
                name.place
            )
        });
        Ok(None)
    }

    fn find(&mut self, skin: &Sent, name: &str) -> Result<Arc<[u8]>, Denied> {
        if let Some(&index) = self.by_base_name.get(base_name(name)) {
            self.used[index] = true;
            return match self.sent[index].kind {
                Kind::Other => Ok(self.sent[index].bytes.clone()),
                Kind::Cse169Skel | Kind::Cse169Skin => Err(Denied::NotAllowed("it is no picture")),
            };
        }
        if !skin.by_path {
            return Err(Denied::NotFound);
        }
        let path = Path::new(&skin.name).with_file_name(name);
        if let Some(found) = self.found.iter().find(|found| found.path == path) {
            return Ok(found.encoded.clone());
        }
        let encoded = self
            .source
            .read_beside(&skin.name, name, &mut self.budget)?;
        let base_name = base_name(name).to_owned();
        self.found.push(Found {
            path,
            base_name,
            encoded: encoded.clone(),
        });
        Ok(encoded)
    }

    pub(super) fn warn_of_unused(&self, warnings: &mut Warnings) {
        for (file, used) in self.sent.iter().zip(&self.used) {
            if file.kind == Kind::Other && !used {
                warnings.push(|| format!("`{}` is not used: no file refers to it", file.name));
            }
        }
    }

    /// Base name and content of every file sent or found.
    pub(super) fn all_files(&self) -> Vec<(&str, &[u8])> {
        let sent = self
            .sent
            .iter()
            .map(|file| (base_name(&file.name), &*file.bytes));
        let found = self
            .found
            .iter()
            .map(|found| (found.base_name.as_str(), &*found.encoded));
        sent.chain(found).collect()
    }
}
