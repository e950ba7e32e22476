//! Pictures that files refer to, each decoded once. Never lives here: what is inside a picture's file, and where it is found.

use super::error::quoted;
use super::files::{Files, Gathered};
use super::names::base_name;
use super::pictures::{Alpha, BadPicture, Decoder};
use crate::limits::Limits;
use crate::rig::{Encoding, Texture, Warnings};
use std::sync::Arc;

pub(super) struct Textures<'a> {
    decoder: Decoder<'a>,
    /// With the file that each is from, so that skins that share a picture share its texels.
    decoded: Vec<(Arc<Gathered>, Arc<Texture>)>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(limits: &'a Limits) -> Self {
        Self {
            decoder: Decoder::new(limits),
            decoded: Vec::new(),
        }
    }

    /// What `from` calls `name` at `place`. A texture that cannot be had is a warning: the rig is drawn without it.
    pub(super) fn look_up(
        &mut self,
        files: &mut Files,
        from: &Gathered,
        (name, place): (&str, &str),
        warnings: &mut Warnings,
    ) -> Option<Arc<Texture>> {
        let reason = match files.look_up(from, name) {
            Ok(file) if file.is_rig_file() => "it is no picture".to_owned(),
            Ok(file) => match self.decode(file) {
                Ok(texture) => return Some(texture),
                Err(bad) => bad.to_string(),
            },
            Err(denied) => denied.reason(),
        };
        warnings.push(|| {
            let texture = quoted(name);
            format!("{place}: the texture {texture} is left out: {reason}")
        });
        None
    }

    fn decode(&mut self, file: Arc<Gathered>) -> Result<Arc<Texture>, BadPicture> {
        let mut decoded = self.decoded.iter();
        if let Some((_, texture)) = decoded.find(|(of, _)| Arc::ptr_eq(of, &file)) {
            return Ok(texture.clone());
        }
        let level = self.decoder.decode(&file.bytes, Alpha::Drop)?;
        let name = base_name(&file.name).to_owned();
        let texture = Arc::new(Texture::new(name, Encoding::Srgb, level));
        self.decoded.push((file, texture.clone()));
        Ok(texture)
    }
}
