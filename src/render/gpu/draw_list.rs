//! Which bindings the triangles of a rig are drawn with, and in which order. Never lives here: what a picture makes of it.

use super::device::Device;
use super::textures::{TextureBinding, TextureUploads};
use crate::render::material_params::MaterialParams;
use crate::rig::{Material, Opacity, Rig, Texture, TexturePlace, Wrap};
use crate::scene::Surface;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use wgpu::BindGroup;

/// What is bound to draw triangles of a material.
pub(super) enum MaterialBinding {
    /// The surface of the instance alone.
    Plain,
    /// The surface of the instance, and a texture.
    Textured(BindGroup),
    /// A material with parameters of its own.
    Full {
        textures: BindGroup,
        /// A part that has it.
        part: PartMaterial,
    },
}

/// A part of a mesh in one of the materials that variants give it.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartMaterial {
    mesh: usize,
    part: usize,
    material: Option<usize>,
}

/// Draw triangles of one part of a mesh that stand in a row in the index buffer and are culled alike.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct DrawRange {
    /// Index into [`DrawList::bindings`].
    pub binding: usize,
    pub mesh: usize,
    pub part: usize,
    /// Among the mesh's draw triangles.
    pub triangles: Range<usize>,
    /// Whether its material does in this variant.
    pub blends: bool,
}

/// All bindings of a rig, and its triangles in the order in which they are drawn.
///
/// Those with the same binding stand side by side, so that few draws show them, in the order in which the file first names their materials;
/// what blends comes last, there all of a part in a row: each picture has an order of its own for these parts. Of surfaces at just the same
/// depth the first is seen. Between parts with different bindings that may be another than the file's first, and so between meshes with the
/// same one, some of whose triangles are wound the other way. Within a part the order is that of its draw triangles.
pub(super) struct DrawList {
    pub bindings: Vec<MaterialBinding>,
    /// Of the file's own materials first, then those of each variant. All have the same ranges of triangles, in orders of their own.
    pub ranges: Vec<Vec<DrawRange>>,
}

/// What tells one binding from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum BindingKey {
    Plain,
    Textured(*const Texture),
    /// By what it is made of: files name one material many times over. What is the same under the surface that asks for nothing is the same
    /// under every other.
    Full {
        params: [u8; size_of::<MaterialParams>()],
        textures: [Option<(*const Texture, [Wrap; 2])>; 3],
    },
}

impl DrawList {
    pub(super) fn new(
        device: &Device,
        texture_binding: &TextureBinding,
        uploads: &mut TextureUploads,
        rig: &Rig,
    ) -> Self {
        let mut keys = BindingKeys::default();
        let variants = (0..rig.variants().len()).map(Some);
        let variants = std::iter::once(None).chain(variants);
        let ranges = variants.map(|variant| keys.ranges(rig, variant)).collect();
        let binding = |&(key, part): &(BindingKey, PartMaterial)| {
            let material = part.material(rig);
            match key {
                BindingKey::Plain => MaterialBinding::Plain,
                BindingKey::Textured(_) => match texture(material) {
                    Some(texture) => MaterialBinding::Textured(
                        texture_binding.bind(device, &uploads.upload(device, texture)),
                    ),
                    None => MaterialBinding::Plain,
                },
                BindingKey::Full { .. } => MaterialBinding::Full {
                    textures: texture_binding.bind_material(device, uploads, material),
                    part,
                },
            }
        };
        Self {
            bindings: keys.met.iter().map(binding).collect(),
            ranges,
        }
    }

    /// Whether anything looks at texture coordinates.
    pub(super) fn is_textured(&self) -> bool {
        let is_plain = |binding: &MaterialBinding| matches!(binding, MaterialBinding::Plain);
        !self.bindings.iter().all(is_plain)
    }
}

impl MaterialBinding {
    /// As a picture with this surface shows it on `rig`.
    pub(super) fn params(&self, rig: &Rig, surface: &Surface) -> Option<MaterialParams> {
        match *self {
            Self::Plain | Self::Textured(_) => None,
            Self::Full { part, .. } => part.params(rig, surface),
        }
    }
}

impl PartMaterial {
    fn material(self, rig: &Rig) -> Option<&Material> {
        self.material.map(|material| &rig.materials()[material])
    }

    fn params(self, rig: &Rig, surface: &Surface) -> Option<MaterialParams> {
        let mesh = &rig.meshes()[self.mesh];
        MaterialParams::of(mesh, &mesh.parts()[self.part], self.material(rig), surface)
    }

    fn key(self, rig: &Rig) -> BindingKey {
        let material = self.material(rig);
        // Whether there are parameters does not depend on the surface that is asked for.
        if let Some(params) = self.params(rig, &Surface::default()) {
            let texture = |place: Option<&TexturePlace>| {
                place.map(|place| (Arc::as_ptr(&place.texture), place.wrap))
            };
            let normal_map = material.and_then(|it| it.normal_map.as_ref());
            return BindingKey::Full {
                params: bytemuck::cast(params),
                textures: [
                    texture(material.and_then(|it| it.texture.as_ref())),
                    texture(material.and_then(|it| it.emissive_texture.as_ref())),
                    texture(normal_map.map(|map| &map.place)),
                ],
            };
        }
        match (texture(material), rig.meshes()[self.mesh].texcoords()) {
            (Some(texture), Some(_)) => BindingKey::Textured(Arc::as_ptr(texture)),
            _ => BindingKey::Plain,
        }
    }
}

/// Distinct ones, each with a part that has it, in the order in which they were met.
#[derive(Debug, Default)]
struct BindingKeys {
    met: Vec<(BindingKey, PartMaterial)>,
    indices: HashMap<BindingKey, usize>,
}

impl BindingKeys {
    /// All triangles of a rig as they are drawn in a variant.
    fn ranges(&mut self, rig: &Rig, variant: Option<usize>) -> Vec<DrawRange> {
        let mut found = Vec::new();
        for (index, mesh) in rig.meshes().iter().enumerate() {
            for (part_index, part) in mesh.parts().iter().enumerate() {
                let part_material = PartMaterial {
                    mesh: index,
                    part: part_index,
                    material: part.look(variant).material,
                };
                let binding = self.index(rig, part_material);
                let blends = part_material
                    .material(rig)
                    .is_some_and(|it| it.opacity == Opacity::Blend);
                for (half, triangles) in part.halves().into_iter().enumerate() {
                    let range = DrawRange {
                        binding,
                        mesh: index,
                        part: part_index,
                        triangles,
                        blends,
                    };
                    if !range.triangles.is_empty() {
                        // What is opaque is drawn with one side left out, then with the other. What blends is drawn part by part.
                        let half = if blends { 0 } else { half };
                        found.push(((blends, binding, half), range));
                    }
                }
            }
        }
        // Stable: the file's order where nothing else decides.
        found.sort_by_key(|(rank, _)| *rank);
        found.into_iter().map(|(_, range)| range).collect()
    }

    fn index(&mut self, rig: &Rig, part: PartMaterial) -> usize {
        let key = part.key(rig);
        *self.indices.entry(key).or_insert_with(|| {
            self.met.push((key, part));
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
    fn what_is_bound_alike_stands_side_by_side_and_what_blends_comes_last() {
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
        let mut keys = BindingKeys::default();
        let ranges = keys.ranges(&rig, None);
        let met = &keys.met;
        assert_eq!(met.len(), 3, "plain is plain, named or not: {met:?}");
        let order: Vec<_> = ranges.iter().map(|it| (it.mesh, it.part)).collect();
        // The paint's back, wound the other way, behind all of its front.
        let wanted = [(1, 1), (0, 1), (1, 0), (2, 0), (0, 0), (2, 1)];
        assert_eq!(order, wanted);
        let bindings: Vec<_> = ranges.iter().map(|it| it.binding).collect();
        assert_eq!(bindings, [1, 1, 2, 2, 0, 0]);
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
        let ranges = BindingKeys::default().ranges(&rig, None);
        let order = ranges.iter().map(|it| (it.mesh, it.triangles.clone()));
        let order: Vec<_> = order.collect();
        assert_eq!(order, [(0, 0..1), (0, 1..2), (1, 0..1), (1, 1..2)]);
    }
}
