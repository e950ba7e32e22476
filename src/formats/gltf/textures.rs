//! Textures of materials: which picture, how it is decoded, and how it lies. Never lives here: what a material does with one.

use super::accessors::Accessors;
use super::buffers;
use super::bytes::Bytes;
use crate::formats::error::{LoadError, quoted};
use crate::formats::files::{Files, Gathered};
use crate::formats::names::base_name;
use crate::formats::pictures::{Alpha, Decoder};
use crate::limits::Limits;
use crate::rig::{Encoding, Texture, TexturePlace, TextureTransform, Warnings, Wrap};
use glam::Vec2;
use gltf_json::Index;
use gltf_json::texture::WrappingMode;
use gltf_json::validation::Checked;
use serde_json::Value;
use std::collections::HashMap;
use std::sync::Arc;

/// What the library has where a texture names no image.
const NO_IMAGE: usize = u32::MAX as usize;

type Decoding = (Encoding, Alpha);
type Decoded<'a> = (Bytes<'a>, Result<Arc<Texture>, String>);

/// The textures of one document, each decoded once for each way of decoding it.
pub(super) struct Textures<'a> {
    pub accessors: Accessors<'a>,
    from: &'a Gathered,
    decoder: Decoder<'a>,
    /// By image. `None` of those that cannot be had.
    of_images: HashMap<(usize, Decoding), Option<Arc<Texture>>>,
    /// By where the bytes of a picture are, which are kept so that no others come to lie there: or why there is none.
    of_bytes: HashMap<(usize, usize, Decoding), Decoded<'a>>,
}

/// A texture that a material names, in the words of the file.
pub(super) struct TextureRef {
    texture: Index<gltf_json::Texture>,
    /// Of texture coordinates.
    pub set: u32,
    transform: TextureTransform,
}

impl<'a> Textures<'a> {
    pub(super) fn new(accessors: Accessors<'a>, from: &'a Gathered, limits: &'a Limits) -> Self {
        Self {
            accessors,
            from,
            decoder: Decoder::new(limits),
            of_images: HashMap::new(),
            of_bytes: HashMap::new(),
        }
    }

    /// A texture and how it is laid on a surface. `None` where its picture cannot be had.
    pub(super) fn slot(
        &mut self,
        named: &TextureRef,
        (encoding, alpha): Decoding,
        path: &str,
        files: &mut Files<'_>,
        warnings: &mut Warnings,
    ) -> Result<Option<TexturePlace>, LoadError> {
        let Accessors { faults, root, .. } = self.accessors;
        let texture_path = format!("textures[{}]", named.texture.value());
        let of_file = faults.get(&root.textures, "textures", named.texture, path)?;
        let wrap = match of_file.sampler {
            None => [Wrap::Repeat; 2],
            Some(sampler) => {
                let path = format!("{texture_path}.sampler");
                let sampler = faults.get(&root.samplers, "samplers", sampler, &path)?;
                [sampler.wrap_s, sampler.wrap_t].map(wrap_of)
            }
        };
        let decoding = (encoding, alpha);
        let texture = self.texture(of_file.source, decoding, &texture_path, files, warnings)?;
        Ok(texture.map(|texture| TexturePlace {
            texture,
            wrap,
            picture_from_texcoord: named.transform,
        }))
    }

    /// A picture that cannot be had is a warning: the rig is drawn without it.
    fn texture(
        &mut self,
        image: Index<gltf_json::Image>,
        decoding: Decoding,
        path: &str,
        files: &mut Files<'_>,
        warnings: &mut Warnings,
    ) -> Result<Option<Arc<Texture>>, LoadError> {
        let index = image.value();
        if index == NO_IMAGE {
            let sentence = format!("{path} is left out: it has no picture but in extensions");
            let faults = self.accessors.faults;
            warnings.push(|| faults.warning(&sentence));
            return Ok(None);
        }
        if let Some(texture) = self.of_images.get(&(index, decoding)) {
            return Ok(texture.clone());
        }
        let texture = match self.encoded(index, path, files)? {
            Ok((bytes, name)) => {
                self.check_media(index, &bytes, warnings);
                self.decoded(bytes, name, decoding)
            }
            Err(reason) => Err(reason),
        };
        if let Err(reason) = &texture {
            let faults = self.accessors.faults;
            let images = &self.accessors.root.images;
            let name = images.get(index).and_then(picture_name);
            warnings.push(|| {
                let name = name.map_or_else(String::new, |name| format!(", {},", quoted(name)));
                faults.warning(&format!("images[{index}]{name} is left out: {reason}"))
            });
        }
        let texture = texture.ok();
        self.of_images.insert((index, decoding), texture.clone());
        Ok(texture)
    }

    /// A picture is what its bytes say, whatever the document calls it.
    fn check_media(&self, index: usize, bytes: &[u8], warnings: &mut Warnings) {
        let Accessors { faults, root, .. } = self.accessors;
        let Some(of_file) = root.images.get(index) else {
            return;
        };
        let declared = of_file.mime_type.as_ref().map(|it| it.0.as_str());
        let declared = declared.or(of_file.uri.as_deref().and_then(buffers::media_type));
        let found = image::guess_format(bytes).ok();
        let found = found.map(|format| format.to_mime_type());
        if let (Some(declared), Some(found)) = (declared, found.filter(|it| declared != Some(*it)))
        {
            let declared = quoted(declared);
            warnings.push(|| {
                faults.warning(&format!(
                    "images[{index}] is called {declared}, but is `{found}`"
                ))
            });
        }
    }

    /// The file of an image and what it is called, or why it cannot be had.
    fn encoded(
        &self,
        index: usize,
        path: &str,
        files: &mut Files<'_>,
    ) -> Result<Result<(Bytes<'a>, String), String>, LoadError> {
        let Accessors {
            faults,
            root,
            buffers,
            ..
        } = self.accessors;
        let own = format!("images[{index}]");
        let Some(of_file) = root.images.get(index) else {
            return Ok(Err(format!("{path} names it, and there is none")));
        };
        match (&of_file.uri, of_file.buffer_view) {
            (_, Some(view)) => {
                let view = buffers.view(root, view, &format!("{own}.bufferView"))?;
                Ok(Ok((view.bytes, format!("image_{index}"))))
            }
            (Some(uri), None) => {
                match buffers::open(faults, &format!("{own}.uri"), uri, self.from, files) {
                    Ok(bytes) => Ok(Ok((Bytes::Shared(bytes), name_of(uri, index)))),
                    Err(LoadError::Invalid(fault)) => {
                        Ok(Err(format!("{}: {}", fault.expected, fault.found)))
                    }
                    Err(other) => Ok(Err(other.to_string())),
                }
            }
            (None, None) => Ok(Err("it has neither `uri` nor `bufferView`".to_owned())),
        }
    }

    /// The same bytes are decoded once, however many images they are.
    fn decoded(
        &mut self,
        bytes: Bytes<'a>,
        name: String,
        (encoding, alpha): Decoding,
    ) -> Result<Arc<Texture>, String> {
        let key = (bytes.as_ptr() as usize, bytes.len(), (encoding, alpha));
        if let Some((_, texture)) = self.of_bytes.get(&key) {
            return texture.clone();
        }
        let texture = match self.decoder.decode(&bytes, alpha) {
            Ok(level) => Ok(Arc::new(Texture::new(name, encoding, level))),
            Err(bad) => Err(bad.to_string()),
        };
        self.of_bytes.insert(key, (bytes, texture.clone()));
        texture
    }
}

impl TextureRef {
    pub(super) fn color(info: &gltf_json::texture::Info) -> Self {
        let transform = info
            .extensions
            .as_ref()
            .and_then(|it| it.texture_transform.as_ref());
        Self {
            texture: info.index,
            set: transform
                .and_then(|it| it.tex_coord)
                .unwrap_or(info.tex_coord),
            transform: transform.map_or(TextureTransform::IDENTITY, |it| {
                affine(it.offset.0, it.rotation.0, it.scale.0)
            }),
        }
    }

    /// The library leaves the extensions of this one as they are.
    pub(super) fn normals(info: &gltf_json::material::NormalTexture) -> Self {
        let extensions = info.extensions.as_ref();
        let transform = extensions.and_then(|it| it.others.get("KHR_texture_transform"));
        let number = |value: Option<&Value>, otherwise: f64| {
            value.and_then(Value::as_f64).unwrap_or(otherwise) as f32
        };
        let two = |name: &str, otherwise: f64| {
            let list = transform.and_then(|it| it.get(name));
            [0, 1].map(|place| number(list.and_then(|list| list.get(place)), otherwise))
        };
        let rotation = number(transform.and_then(|it| it.get("rotation")), 0.0);
        let set = transform.and_then(|it| it.get("texCoord")?.as_u64());
        Self {
            texture: info.index,
            set: set.map_or(info.tex_coord, |set| set as u32),
            transform: affine(two("offset", 0.0), rotation, two("scale", 1.0)),
        }
    }
}

/// What a person knows an image by.
fn picture_name(image: &gltf_json::Image) -> Option<&str> {
    let file = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    file.or(image.name.as_deref())
}

/// What the picture of a texture is called.
fn name_of(uri: &str, index: usize) -> String {
    match uri.starts_with("data:") {
        true => format!("image_{index}"),
        false => base_name(uri).to_owned(),
    }
}

/// `T(offset) · R · S(scale)` on texture coordinates from the top; counter-clockwise is as one sees it on the picture.
fn affine(offset: [f32; 2], rotation: f32, [x, y]: [f32; 2]) -> TextureTransform {
    let (sine, cosine) = (libm::sinf(rotation), libm::cosf(rotation));
    TextureTransform {
        columns: [
            Vec2::new(cosine * x, -sine * x),
            Vec2::new(sine * y, cosine * y),
        ],
        offset: Vec2::from_array(offset),
    }
}

fn wrap_of(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}
