//! Pictures that files refer to, each decoded once. Never lives here: what is inside a picture's file, and where it is found.

use super::error::{LoadError, quoted};
use super::files::{Files, Gathered};
use super::pictures::{self, Alpha, BadPicture};
use super::recognise::{Kind, base_name};
use crate::limits::Limits;
use crate::rig::{Encoding, Texture, Warnings};
use std::sync::Arc;

pub(super) struct Textures<'a> {
    limits: &'a Limits,
    /// With the file that each is from, so that skins that share a picture share its texels.
    decoded: Vec<(Arc<Gathered>, Arc<Texture>)>,
    bytes: u64,
}

impl<'a> Textures<'a> {
    pub(super) fn new(limits: &'a Limits) -> Self {
        Self {
            limits,
            decoded: Vec::new(),
            bytes: 0,
        }
    }

    /// What `from` calls `name` at `place`. A texture that cannot be had is a warning: the rig is drawn without it.
    ///
    /// # Errors
    /// Only where its file is larger than the request's files may be, or has more pixels than a picture may.
    pub(super) fn look_up(
        &mut self,
        files: &mut Files,
        from: &Gathered,
        (name, place): (&str, &str),
        warnings: &mut Warnings,
    ) -> Result<Option<Arc<Texture>>, LoadError> {
        let reason = match files.look_up(from, name) {
            Ok(file) if file.kind != Kind::Other => "it is no picture".to_owned(),
            Ok(file) => match self.decode(file) {
                Ok(texture) => return Ok(Some(texture)),
                Err(BadPicture::Limit(exceeded)) => return Err(exceeded.into()),
                Err(BadPicture::Undecodable(reason)) => reason,
            },
            Err(denied) => denied.reason()?,
        };
        warnings.push(|| {
            let texture = quoted(name);
            format!("{place}: the texture {texture} is left out: {reason}")
        });
        Ok(None)
    }

    fn decode(&mut self, file: Arc<Gathered>) -> Result<Arc<Texture>, BadPicture> {
        let mut decoded = self.decoded.iter();
        if let Some((_, texture)) = decoded.find(|(of, _)| Arc::ptr_eq(of, &file)) {
            return Ok(texture.clone());
        }
        let level = pictures::decode(&file.bytes, Alpha::Drop, self.limits)?;
        let name = base_name(&file.name).to_owned();
        let texture = Arc::new(Texture::new(name, Encoding::Srgb, level));
        // A small file can hold many pixels, and a request many such files: memory must not be full before the rig is weighed.
        self.bytes += texture.memory_bytes() as u64;
        self.limits.rig_bytes(self.bytes)?;
        self.decoded.push((file, texture.clone()));
        Ok(texture)
    }
}
