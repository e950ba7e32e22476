//! What the triangles of a rig wear, and the order in which they are drawn. Never lives here: what a picture makes of it.

use super::device::Device;
use super::textures::{TextureBinding, TextureUploads};
use crate::render::coat::Coat;
use crate::rig::{Material, Opacity, Rig, Texture, TexturePlace, Wrap};
use crate::scene::Surface;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use wgpu::BindGroup;

/// What is bound to draw triangles.
pub(super) enum Wear {
    /// The picture's surface alone.
    Plain,
    /// The picture's surface, and a texture.
    Textured(BindGroup),
    Coated {
        textures: BindGroup,
        /// A part that wears it, and the material that it wears then.
        worn: Worn,
    },
}

/// A part of a mesh in one of the materials that variants give it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Worn {
    mesh: usize,
    part: usize,
    material: Option<usize>,
}

/// Draw triangles of one part of a mesh that stand in a row in the index buffer and are culled alike.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Stretch {
    /// Index into [`Wardrobe::wears`].
    pub wear: usize,
    pub mesh: usize,
    pub part: usize,
    /// Among the mesh's draw triangles.
    pub triangles: Range<usize>,
    /// Whether its material does in this variant.
    pub blends: bool,
}

/// All that a rig wears, and its triangles in the order in which they are drawn.
///
/// Those that wear the same stand side by side, so that few draws show them, in the order in which the file first names what they wear;
/// what blends comes last, there all of a part in a row: each picture has an order of its own for these parts. Of surfaces at just the same
/// depth the first is seen: between parts that wear different things that may be another than the file's first, and between meshes that wear
/// the same, one of whose triangles are wound the other way. Within a part the order is that of its draw triangles.
pub(super) struct Wardrobe {
    pub wears: Vec<Wear>,
    /// Of the file's own materials first, then those of each variant. All have the same stretches of triangles, in orders of their own.
    pub stretches: Vec<Vec<Stretch>>,
}

/// What tells one wear from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Name {
    Plain,
    Textured(*const Texture),
    /// By what it is made of: files name one material many times over. What is the same under the surface that asks for nothing is the same
    /// under every other.
    Coated {
        coat: [u8; size_of::<Coat>()],
        textures: [Option<(*const Texture, [Wrap; 2])>; 3],
    },
}

impl Wardrobe {
    pub fn new(
        device: &Device,
        binding: &TextureBinding,
        uploads: &mut TextureUploads,
        rig: &Rig,
    ) -> Self {
        let mut names = Names::default();
        let variants = (0..rig.variants().len()).map(Some);
        let variants = std::iter::once(None).chain(variants);
        let stretches = variants
            .map(|variant| names.stretches(rig, variant))
            .collect();
        let wear = |&(name, worn): &(Name, Worn)| {
            let material = worn.material(rig);
            match name {
                Name::Plain => Wear::Plain,
                Name::Textured(_) => match texture(material) {
                    Some(texture) => {
                        Wear::Textured(binding.bind(device, &uploads.upload(device, texture)))
                    }
                    None => Wear::Plain,
                },
                Name::Coated { .. } => Wear::Coated {
                    textures: binding.bind_coat(device, uploads, material),
                    worn,
                },
            }
        };
        Self {
            wears: names.met.iter().map(wear).collect(),
            stretches,
        }
    }

    /// Whether anything looks at texture coordinates.
    pub fn is_textured(&self) -> bool {
        let is_plain = |wear: &Wear| matches!(wear, Wear::Plain);
        !self.wears.iter().all(is_plain)
    }
}

impl Wear {
    /// As a picture with this surface shows it on `rig`.
    pub fn coat(&self, rig: &Rig, surface: &Surface) -> Option<Coat> {
        match *self {
            Self::Plain | Self::Textured(_) => None,
            Self::Coated { worn, .. } => worn.coat(rig, surface),
        }
    }
}

impl Worn {
    fn material(self, rig: &Rig) -> Option<&Material> {
        self.material.map(|material| &rig.materials()[material])
    }

    fn coat(self, rig: &Rig, surface: &Surface) -> Option<Coat> {
        let mesh = &rig.meshes()[self.mesh];
        Coat::of(mesh, &mesh.parts()[self.part], self.material(rig), surface)
    }

    fn name(self, rig: &Rig) -> Name {
        let material = self.material(rig);
        // Whether there is a coat does not depend on the picture's surface.
        if let Some(coat) = self.coat(rig, &Surface::default()) {
            let worn = |place: Option<&TexturePlace>| {
                place.map(|place| (Arc::as_ptr(&place.texture), place.wrap))
            };
            let normal_map = material.and_then(|it| it.normal_map.as_ref());
            return Name::Coated {
                coat: bytemuck::cast(coat),
                textures: [
                    worn(material.and_then(|it| it.texture.as_ref())),
                    worn(material.and_then(|it| it.emissive_texture.as_ref())),
                    worn(normal_map.map(|map| &map.place)),
                ],
            };
        }
        match (texture(material), rig.meshes()[self.mesh].texcoords()) {
            (Some(texture), Some(_)) => Name::Textured(Arc::as_ptr(texture)),
            _ => Name::Plain,
        }
    }
}

/// What is worn, each with a part that wears it, in the order in which it was met.
#[derive(Debug, Default)]
struct Names {
    met: Vec<(Name, Worn)>,
    places: HashMap<Name, usize>,
}

impl Names {
    /// Who wears what in a variant.
    fn stretches(&mut self, rig: &Rig, variant: Option<usize>) -> Vec<Stretch> {
        let mut found = Vec::new();
        for (index, mesh) in rig.meshes().iter().enumerate() {
            for (part_index, part) in mesh.parts().iter().enumerate() {
                let worn = Worn {
                    mesh: index,
                    part: part_index,
                    material: part.look(variant).material,
                };
                let wear = self.place(rig, worn);
                let blends = worn
                    .material(rig)
                    .is_some_and(|it| it.opacity == Opacity::Blend);
                for (half, triangles) in part.halves().into_iter().enumerate() {
                    let stretch = Stretch {
                        wear,
                        mesh: index,
                        part: part_index,
                        triangles,
                        blends,
                    };
                    if !stretch.triangles.is_empty() {
                        // What is opaque is drawn with one side left out, then with the other. What blends is drawn part by part.
                        let half = if blends { 0 } else { half };
                        found.push(((blends, wear, half), stretch));
                    }
                }
            }
        }
        // Stable: the file's order where nothing else decides.
        found.sort_by_key(|(rank, _)| *rank);
        found.into_iter().map(|(_, stretch)| stretch).collect()
    }

    fn place(&mut self, rig: &Rig, worn: Worn) -> usize {
        let name = worn.name(rig);
        *self.places.entry(name).or_insert_with(|| {
            self.met.push((name, worn));
            self.met.len() - 1
        })
    }
}

fn texture(material: Option<&Material>) -> Option<&Arc<Texture>> {
    let place = material?.texture.as_ref()?;
    Some(&place.texture)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::rig::{Draft, MeshDraft, PartDraft};
    use glam::{Vec3, Vec4};

    /// A mesh of two triangles, each a part of one of these materials; the second is wound the other way where `is_torn`.
    fn mesh(materials: [Option<usize>; 2], is_torn: bool) -> MeshDraft {
        let part = |material| PartDraft {
            triangle_count: 1,
            material,
            is_flat: false,
        };
        MeshDraft {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y],
            normals: Some(vec![Vec3::Z; 4]),
            triangles: vec![[0, 1, 2], if is_torn { [1, 2, 3] } else { [1, 3, 2] }],
            parts: materials.map(part).to_vec(),
            ..MeshDraft::default()
        }
    }

    #[test]
    fn what_wears_the_same_stands_side_by_side_and_what_blends_comes_last() {
        let glass = Material {
            opacity: Opacity::Blend,
            ..Material::named("glass".to_owned())
        };
        let painted = Material {
            color: Some(Vec4::ONE),
            is_single_sided: true,
            ..Material::named("paint".to_owned())
        };
        let plain = Material::named("plain".to_owned());
        let same_paint = Material {
            name: "paint again".to_owned(),
            ..painted.clone()
        };
        let (of_glass, of_paint, of_nothing, again) = (Some(0), Some(1), Some(2), Some(3));
        let draft = Draft {
            meshes: vec![
                mesh([of_glass, of_paint], true),
                mesh([None, again], false),
                mesh([of_nothing, of_glass], false),
            ],
            materials: vec![glass, painted, plain, same_paint],
            ..Draft::default()
        };
        let rig = draft.build(&Limits::default()).expect("a rig");
        let mut names = Names::default();
        let stretches = names.stretches(&rig, None);
        let met = &names.met;
        assert_eq!(met.len(), 3, "plain is plain, named or not: {met:?}");
        let order: Vec<_> = stretches.iter().map(|it| (it.mesh, it.part)).collect();
        // The paint's back, wound the other way, behind all of its front.
        let wanted = [(1, 1), (0, 1), (1, 0), (2, 0), (0, 0), (2, 1)];
        assert_eq!(order, wanted);
        let wears: Vec<_> = stretches.iter().map(|it| it.wear).collect();
        assert_eq!(wears, [1, 1, 2, 2, 0, 0]);
    }

    #[test]
    fn all_of_a_part_that_blends_stands_in_a_row() {
        let glass = Material {
            opacity: Opacity::Blend,
            is_single_sided: true,
            ..Material::named("glass".to_owned())
        };
        // Both triangles of a mesh are one part; the second is wound the other way, so that the part has two halves.
        let whole = || {
            let mesh = mesh([None, None], true);
            let part = PartDraft {
                triangle_count: 2,
                material: Some(0),
                is_flat: false,
            };
            MeshDraft {
                parts: vec![part],
                ..mesh
            }
        };
        let draft = Draft {
            meshes: vec![whole(), whole()],
            materials: vec![glass],
            ..Draft::default()
        };
        let rig = draft.build(&Limits::default()).expect("a rig");
        let stretches = Names::default().stretches(&rig, None);
        let order = stretches.iter().map(|it| (it.mesh, it.triangles.clone()));
        let order: Vec<_> = order.collect();
        assert_eq!(order, [(0, 0..1), (0, 1..2), (1, 0..1), (1, 1..2)]);
    }
}
