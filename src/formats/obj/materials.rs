//! The materials that an OBJ names, looked up in its libraries. Never lives here: the grammar of either.

use super::mesh::Obj;
use super::mtl::{self, Map, Mtl};
use crate::formats::context::Context;
use crate::formats::contribution::MeshPart;
use crate::formats::error::quoted;
use crate::formats::files::Gathered;
use crate::formats::source::Denied;
use crate::formats::text::mention::Mention;
use crate::rig::{Highlight, Material, MeshDraft, Opacity, PartDraft, TexturePlace};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// A library that was found.
struct Library {
    file: Arc<Gathered>,
    materials: Vec<Mtl>,
}

/// The mesh that was read from `file`, with the materials that its faces have. One that no library has is a warning, and so is a library or
/// a texture that cannot be had.
pub(super) fn resolve(file: &Gathered, obj: Obj, context: &mut Context) -> MeshPart {
    let mut lookup = Lookup {
        context,
        materials: Vec::new(),
    };
    let mesh = lookup.resolve(file, obj);
    MeshPart {
        mesh,
        materials: lookup.materials,
        bindings: Vec::new(),
    }
}

/// Looks up materials, and collects those that were found.
struct Lookup<'a, 'c> {
    context: &'a mut Context<'c>,
    materials: Vec<Material>,
}

impl Lookup<'_, '_> {
    /// The mesh, its parts with indices into `materials`.
    fn resolve(&mut self, file: &Gathered, obj: Obj) -> MeshDraft {
        let Obj {
            mut mesh,
            libraries,
            materials,
        } = obj;
        let libraries = self.open(file, &libraries);
        let mut by_name = HashMap::new();
        for library in &libraries {
            for material in &library.materials {
                by_name
                    .entry(material.name.as_str())
                    .or_insert((&*library.file, material));
            }
        }
        let mut unknown = Vec::new();
        let mut indices = HashMap::new();
        for named in mesh.parts.iter().filter_map(|part| part.material) {
            if indices.contains_key(&named) {
                continue;
            }
            let index = match by_name.get(materials[named].name.as_str()) {
                Some((library, material)) => Some(self.add(library, material)),
                None => {
                    unknown.push(&materials[named]);
                    None
                }
            };
            indices.insert(named, index);
        }
        if let [first, others @ ..] = unknown.as_slice() {
            self.context.warnings.push(|| {
                let (place, name) = (&first.place, quoted(&first.name));
                let others = match others.len() {
                    0 => String::new(),
                    others => format!(", nor {others} others"),
                };
                format!("{place}: no material library has {name}{others}: drawn without a material")
            });
        }
        let resolved = mesh.parts.iter().map(|part| PartDraft {
            material: part.material.and_then(|named| indices[&named]),
            ..*part
        });
        mesh.parts = joined(resolved);
        self.warn_of_missing_texcoords(&file.name, &mesh);
        mesh
    }

    /// Those of `mentions` that can be had, each once.
    fn open(&mut self, obj: &Gathered, mentions: &[Mention]) -> Vec<Library> {
        /// Far more than any program writes: each may be looked for on disk.
        const MOST: usize = 64;
        let mut libraries = Vec::new();
        for mention in mentions.iter().take(MOST) {
            let names = || mention.name.split_ascii_whitespace();
            match self.context.files.look_up(obj, unquoted(&mention.name)) {
                // Several names, or one with spaces in it: nothing but the files tells.
                Err(Denied::NotFound) if names().nth(1).is_some() => {
                    for name in names().take(MOST) {
                        let found = self.context.files.look_up(obj, unquoted(name));
                        self.read(found, name, &mention.place, &mut libraries);
                    }
                }
                found => self.read(found, &mention.name, &mention.place, &mut libraries),
            }
        }
        if let Some(past) = mentions.get(MOST) {
            self.context.warnings.push(|| {
                let place = &past.place;
                format!("{place}: of material libraries the first {MOST} are read, and no more")
            });
        }
        libraries
    }

    fn read(
        &mut self,
        found: Result<Arc<Gathered>, Denied>,
        name: &str,
        place: &str,
        libraries: &mut Vec<Library>,
    ) {
        let reason = match found {
            Ok(file) if libraries.iter().any(|it| Arc::ptr_eq(&it.file, &file)) => return,
            Ok(file) if file.is_rig_file() => "it is no material library".to_owned(),
            Ok(file) => match file.text(&mut self.context.warnings) {
                Ok(text) => {
                    let mtl::Library {
                        materials,
                        passed_over,
                    } = mtl::read(&file.name, &text, &mut self.context.warnings);
                    for name in &passed_over {
                        self.context.files.pass_over(unquoted(name));
                    }
                    libraries.push(Library {
                        file: file.clone(),
                        materials,
                    });
                    return;
                }
                Err(fault) => format!("it is {}", fault.found),
            },
            Err(denied) => denied.reason(),
        };
        self.context.warnings.push(|| {
            let name = quoted(name);
            format!("{place}: the material library {name} is left out: {reason}")
        });
    }

    /// Returns its index.
    fn add(&mut self, library: &Gathered, mtl: &Mtl) -> usize {
        let opacity = mtl.opacity.unwrap_or(1.0);
        let material = Material {
            // Without a color of its own it has the request's, which has no opacity.
            color: match mtl.diffuse {
                Some(color) => Some(color.extend(opacity)),
                None => (opacity < 1.0).then(|| Vec3::ONE.extend(opacity)),
            },
            texture: self.texture(library, mtl.diffuse_map.as_ref()),
            highlight: mtl.specular.map(|specular| Highlight {
                specular,
                shininess: mtl.shininess.unwrap_or(SHININESS),
            }),
            emissive: match &mtl.emissive_map {
                Some(_) if mtl.emissive == Vec3::ZERO => Vec3::ONE,
                _ => mtl.emissive,
            },
            emissive_texture: self.texture(library, mtl.emissive_map.as_ref()),
            opacity: if opacity < 1.0 {
                Opacity::Blend
            } else {
                Opacity::Opaque
            },
            ..Material::named(mtl.name.clone())
        };
        self.materials.push(material);
        self.materials.len() - 1
    }

    fn texture(&mut self, library: &Gathered, map: Option<&Map>) -> Option<TexturePlace> {
        let map = map?;
        let mention = (unquoted(&map.file.name), map.file.place.as_str());
        let Context {
            files,
            textures,
            warnings,
            ..
        } = &mut *self.context;
        let texture = textures.look_up(files, library, mention, warnings)?;
        Some(TexturePlace {
            texture,
            wrap: [map.wrap; 2],
            picture_from_texcoord: map.picture_from_texcoord,
        })
    }

    fn warn_of_missing_texcoords(&mut self, file: &str, mesh: &MeshDraft) {
        let is_textured = |part: &PartDraft| {
            let material = part.material.map(|material| &self.materials[material]);
            material.is_some_and(|material| material.textures().next().is_some())
        };
        if mesh.texcoords.is_none() && mesh.parts.iter().any(is_textured) {
            self.context
                .warnings
                .push(|| format!("`{file}` has no texture coordinates for its textures"));
        }
    }
}

/// Of a library that says what is mirrored and not how sharply: that of a frame request that says neither.
const SHININESS: f32 = 32.0;

/// A file's name without the double quotes around it.
fn unquoted(name: &str) -> &str {
    let inside = name
        .strip_prefix('"')
        .and_then(|name| name.strip_suffix('"'));
    inside
        .filter(|inside| !inside.contains('"'))
        .unwrap_or(name)
}

/// Neighbours that are drawn alike become one.
fn joined(parts: impl Iterator<Item = PartDraft>) -> Vec<PartDraft> {
    let mut joined: Vec<PartDraft> = Vec::new();
    for part in parts {
        match joined.last_mut() {
            Some(last) if (last.material, last.is_flat) == (part.material, part.is_flat) => {
                last.triangle_count += part.triangle_count;
            }
            _ => joined.push(part),
        }
    }
    joined
}
