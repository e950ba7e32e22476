//! From a [`Rig`] to what the device keeps of it: all meshes in one buffer of each kind, so that a rig of many is skinned at once and drawn
//! with few draws.

use super::buffers::filled;
use super::device::Device;
use super::draw_list::{DrawList, DrawRange, MaterialBinding};
use super::textures::{TextureBinding, TextureUploads};
use crate::rig::{Influence, Mesh, MorphDisplacement, Rig, RigId};
use bytemuck::Zeroable;
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Weak};
use wgpu::{BindGroup, Buffer, BufferUsages};

/// The parts of a rig that never change.
pub(super) struct GpuRig {
    /// Which of its draw vertices are those of each mesh.
    pub vertices: Vec<Range<u32>>,
    pub vertex_count: u32,
    /// What the skin stage reads: bind vertices, influences, morph displacements.
    pub bind_group: BindGroup,
    /// Of vertices among all of the rig's; empty where there are none.
    pub indices: Buffer,
    /// Zero for a mesh that has none; `None` where no mesh has any, or nobody looks at them.
    pub texcoords: Option<Buffer>,
    /// White for a mesh that has none; `None` where no mesh has any.
    pub colors: Option<Buffer>,
    pub bindings: Vec<MaterialBinding>,
    /// Of the file's own materials first, then those of each variant.
    variants: Vec<VariantDraws>,
    rig: Weak<Rig>,
    bytes: u64,
}

/// All triangles of a rig as they are drawn in one of its variants.
pub(super) struct VariantDraws {
    /// In the order in which they are drawn, with their indices.
    pub ranges: Vec<(DrawRange, Range<u32>)>,
    /// Which of the ranges are those of each part that blends, by mesh and part: their order is another from picture to picture.
    blending: HashMap<(usize, usize), Range<usize>>,
}

/// How what is uploaded will be bound.
#[derive(Clone, Copy)]
pub(super) struct Layouts<'a> {
    pub rig: &'a wgpu::BindGroupLayout,
    pub textures: &'a TextureBinding,
}

/// Rigs on the device, uploaded when first drawn, dropped when nobody holds them any more.
#[derive(Default)]
pub(super) struct Uploads {
    rigs: HashMap<RigId, GpuRig>,
}

impl Uploads {
    pub(super) fn upload(&mut self, device: &Device, layouts: Layouts<'_>, rig: &Arc<Rig>) {
        self.rigs
            .entry(rig.id())
            .or_insert_with(|| GpuRig::upload(device, layouts, rig));
    }

    /// A rig that was [uploaded](Self::upload).
    pub(super) fn get(&self, rig: &Rig) -> Option<&GpuRig> {
        self.rigs.get(&rig.id())
    }

    /// Uploads these again when they are next drawn.
    pub(super) fn forget(&mut self, rigs: impl Iterator<Item = RigId>) {
        rigs.for_each(|rig| drop(self.rigs.remove(&rig)));
    }

    /// Frees the device memory of rigs that were unloaded.
    pub(super) fn sweep(&mut self) {
        self.rigs
            .retain(|_, gpu_rig| gpu_rig.rig.strong_count() > 0);
    }

    pub(super) fn bytes(&self) -> u64 {
        self.rigs.values().map(|rig| rig.bytes).sum()
    }
}

impl GpuRig {
    fn upload(device: &Device, layouts: Layouts<'_>, rig: &Arc<Rig>) -> Self {
        let meshes = rig.meshes();
        let mut uploads = TextureUploads::default();
        let draw_list = DrawList::new(device, layouts.textures, &mut uploads, rig);
        let mut vertex_count = 0;
        let vertices = meshes.iter().map(|mesh| {
            let first = vertex_count;
            vertex_count += mesh.draw_vertex_count() as u32;
            first..vertex_count
        });
        let vertices: Vec<_> = vertices.collect();

        let skinned = skinned(device, meshes);
        let entries: Vec<_> = (0u32..)
            .zip(&skinned)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let bind_group = device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("upload.rig"),
            layout: layouts.rig,
            entries: &entries,
        });

        let is_textured = draw_list.is_textured();
        let (variants, indices) = variants(meshes, &vertices, draw_list.ranges);
        let indices = filled(device, "upload.indices", BufferUsages::INDEX, &indices);
        let has_texcoords = meshes.iter().any(|mesh| mesh.texcoords().is_some());
        let texcoords = (has_texcoords && is_textured).then(|| {
            let texcoords = of_vertices(meshes, Mesh::texcoords, Vec2::ZERO);
            filled(device, "upload.texcoords", BufferUsages::VERTEX, &texcoords)
        });
        let has_colors = meshes.iter().any(|mesh| mesh.colors().is_some());
        let colors = has_colors.then(|| {
            let colors = of_vertices(meshes, Mesh::colors, Vec4::ONE);
            filled(device, "upload.colors", BufferUsages::VERTEX, &colors)
        });

        let drawn = [Some(&indices), texcoords.as_ref(), colors.as_ref()];
        let buffers = skinned.iter().chain(drawn.into_iter().flatten());
        let bytes = buffers.map(Buffer::size).sum::<u64>() + uploads.bytes();
        Self {
            vertices,
            vertex_count,
            bind_group,
            indices,
            texcoords,
            colors,
            bindings: draw_list.bindings,
            variants,
            rig: Arc::downgrade(rig),
            bytes,
        }
    }

    /// As the rig looks in a variant; `None` is the file's own choice.
    pub(super) fn variant(&self, variant: Option<usize>) -> &VariantDraws {
        let in_variant = variant.and_then(|variant| self.variants.get(1 + variant));
        in_variant.unwrap_or(&self.variants[0])
    }
}

impl VariantDraws {
    /// Those of a part that blends, in the order of its draw triangles.
    pub(super) fn blending(&self, mesh: usize, part: usize) -> &[(DrawRange, Range<u32>)] {
        let ranges = self.blending.get(&(mesh, part));
        ranges.map_or(&[], |ranges| &self.ranges[ranges.clone()])
    }
}

/// Where the ranges of each part that blends stand, which is in a row.
fn blending(ranges: &[DrawRange]) -> HashMap<(usize, usize), Range<usize>> {
    let mut places = HashMap::new();
    let those = ranges.iter().enumerate().filter(|(_, it)| it.blends);
    for (index, range) in those {
        let place = places.entry((range.mesh, range.part));
        place.or_insert(index..index).end = index + 1;
    }
    places
}

/// What the skin stage reads, by binding.
fn skinned(device: &Device, meshes: &[Mesh]) -> [Buffer; 5] {
    let stored = BufferUsages::STORAGE;
    let positions = meshes.iter().flat_map(Mesh::positions);
    let normals = meshes.iter().flat_map(Mesh::normals);
    let bind_vertices: Vec<Vec3> = positions.chain(normals).copied().collect();
    let influences: Vec<Influence> = meshes.iter().flat_map(Mesh::influences).copied().collect();
    let influence_starts = starts(meshes, |mesh| {
        (mesh.influence_starts(), mesh.influences().len())
    });
    let mut displacements: Vec<MorphDisplacement> = Vec::new();
    for mesh in meshes {
        displacements.extend_from_slice(mesh.morph_displacements());
    }
    let morph_starts = starts(meshes, |mesh| {
        (mesh.morph_starts(), mesh.morph_displacements().len())
    });
    if displacements.is_empty() {
        // A shader has no way to be given nothing.
        displacements.push(MorphDisplacement::zeroed());
    }
    [
        filled(device, "upload.bind_vertices", stored, &bind_vertices),
        filled(device, "upload.influence_starts", stored, &influence_starts),
        filled(device, "upload.influences", stored, &influences),
        filled(device, "upload.morph_starts", stored, &morph_starts),
        filled(device, "upload.morph_displacements", stored, &displacements),
    ]
}

/// Where what each vertex of the rig has starts among that of all meshes, and where the last one's ends. `of` gives a mesh's own starts, none
/// where its vertices have nothing, and how much there is in all.
fn starts<'a>(meshes: &'a [Mesh], of: impl Fn(&'a Mesh) -> (&'a [u32], usize)) -> Vec<u32> {
    let mut joined = Vec::new();
    let mut before = 0;
    for mesh in meshes {
        let (starts, count) = of(mesh);
        let own = (0..mesh.draw_vertex_count()).map(|vertex| starts.get(vertex).copied());
        joined.extend(own.map(|start| before + start.unwrap_or(0)));
        before += count as u32;
    }
    joined.push(before);
    joined
}

/// One for each vertex of the rig.
fn of_vertices<'a, T: Copy + 'a>(
    meshes: &'a [Mesh],
    of: impl Fn(&'a Mesh) -> Option<&'a [T]>,
    otherwise: T,
) -> Vec<T> {
    let mut joined = Vec::new();
    for mesh in meshes {
        match of(mesh) {
            Some(own) => joined.extend_from_slice(own),
            None => joined.resize(joined.len() + mesh.draw_vertex_count(), otherwise),
        }
    }
    joined
}

/// All ranges with where their indices stand, and all indices: in the order of the first of them, which others share.
fn variants(
    meshes: &[Mesh],
    vertices: &[Range<u32>],
    ranges: Vec<Vec<DrawRange>>,
) -> (Vec<VariantDraws>, Vec<u32>) {
    let mut indices = Vec::new();
    let mut places = HashMap::new();
    let variants = ranges.into_iter().map(|ranges| {
        let blending = blending(&ranges);
        let placed = ranges.into_iter().map(|range| {
            let triangles = range.triangles.clone();
            let place = places.entry((range.mesh, triangles.start));
            let place = place.or_insert_with(|| {
                let start = indices.len() as u32;
                let triangles = &meshes[range.mesh].draw_triangles()[triangles];
                let first = vertices[range.mesh].start;
                indices.extend(triangles.as_flattened().iter().map(|corner| first + corner));
                start..indices.len() as u32
            });
            (range, place.clone())
        });
        VariantDraws {
            ranges: placed.collect(),
            blending,
        }
    });
    let variants = variants.collect();
    (variants, indices)
}
