//! From a [`Rig`] to what the device keeps of it.

use super::buffers::filled;
use super::device::Device;
use super::textures::TextureBinding;
use crate::rig::{Mesh, MorphDisplacement, Rig, RigId};
use bytemuck::Zeroable;
use std::collections::HashMap;
use std::sync::{Arc, Weak};
use wgpu::{BindGroup, Buffer, BufferUsages};

/// The parts of a rig that never change.
pub(super) struct GpuRig {
    pub meshes: Vec<GpuMesh>,
    rig: Weak<Rig>,
    bytes: u64,
}

/// A mesh with at least one vertex.
pub(super) struct GpuMesh {
    /// In [`Rig::meshes`].
    pub index: usize,
    pub vertex_count: u32,
    pub indices: Buffer,
    /// What the skin stage reads: bind vertices, influences, morph displacements.
    pub bind_group: BindGroup,
    pub texturing: Option<Texturing>,
}

/// A mesh's texture and where on it each vertex lies.
pub(super) struct Texturing {
    pub texcoords: Buffer,
    pub bind_group: BindGroup,
}

/// How what is uploaded will be bound.
#[derive(Clone, Copy)]
pub(super) struct Layouts<'a> {
    pub mesh: &'a wgpu::BindGroupLayout,
    pub textures: &'a TextureBinding,
}

/// Rigs on the device, uploaded when first drawn, dropped when nobody holds them any more.
#[derive(Default)]
pub(super) struct Uploads {
    rigs: HashMap<RigId, GpuRig>,
}

impl Uploads {
    pub fn upload(&mut self, device: &Device, layouts: Layouts<'_>, rig: &Arc<Rig>) {
        self.rigs
            .entry(rig.id())
            .or_insert_with(|| GpuRig::upload(device, layouts, rig));
    }

    /// A rig that was [uploaded](Self::upload).
    pub fn get(&self, rig: &Rig) -> Option<&GpuRig> {
        self.rigs.get(&rig.id())
    }

    /// Uploads these again when they are next drawn.
    pub fn forget(&mut self, rigs: impl Iterator<Item = RigId>) {
        rigs.for_each(|rig| drop(self.rigs.remove(&rig)));
    }

    /// Frees the device memory of rigs that were unloaded.
    pub fn sweep(&mut self) {
        self.rigs
            .retain(|_, gpu_rig| gpu_rig.rig.strong_count() > 0);
    }

    pub fn bytes(&self) -> u64 {
        self.rigs.values().map(|rig| rig.bytes).sum()
    }
}

impl GpuRig {
    fn upload(device: &Device, layouts: Layouts<'_>, rig: &Arc<Rig>) -> Self {
        let meshes = rig
            .meshes()
            .iter()
            .enumerate()
            .filter(|(_, mesh)| mesh.vertex_count() > 0);
        let textures: Vec<_> = rig
            .materials()
            .iter()
            .map(|material| {
                let texture = material.texture.as_ref()?;
                Some(layouts.textures.upload(device, texture))
            })
            .collect();
        let meshes: Vec<_> = meshes
            .map(|(index, mesh)| {
                let texture = mesh
                    .material()
                    .and_then(|material| textures[material].clone());
                let texturing = mesh
                    .texcoords()
                    .zip(texture)
                    .map(|(texcoords, bind_group)| {
                        let usage = BufferUsages::VERTEX;
                        Texturing {
                            texcoords: filled(device, "upload.texcoords", usage, texcoords),
                            bind_group,
                        }
                    });
                GpuMesh {
                    texturing,
                    ..GpuMesh::upload(device, layouts.mesh, index, mesh)
                }
            })
            .collect();
        let of_meshes: u64 = rig.meshes().iter().map(mesh_bytes).sum();
        let textures = rig.materials().iter().flat_map(|m| &m.texture);
        let of_textures: u64 = textures.map(|texture| texture.memory_bytes() as u64).sum();
        Self {
            meshes,
            rig: Arc::downgrade(rig),
            bytes: of_meshes + of_textures,
        }
    }
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let words = 6 * mesh.vertex_count()
        + mesh.influence_starts().len()
        + 2 * mesh.influences().len()
        + mesh.vertex_count()
        + 7 * mesh.morph_displacements().len()
        + mesh.texcoords().map_or(0, |texcoords| 2 * texcoords.len());
    4 * (words + 3 * mesh.triangles().len()) as u64
}

impl GpuMesh {
    /// Without its texture.
    fn upload(device: &Device, layout: &wgpu::BindGroupLayout, index: usize, mesh: &Mesh) -> Self {
        let stored = BufferUsages::STORAGE;
        let bind_vertices = [mesh.positions(), mesh.normals()].concat();
        // A shader has no way to be given nothing.
        let no_starts;
        let nothing = [MorphDisplacement::zeroed()];
        let (morph_starts, displacements) = match mesh.morph_starts() {
            [] => {
                no_starts = vec![0u32; mesh.vertex_count() + 1];
                (no_starts.as_slice(), nothing.as_slice())
            }
            starts => (starts, mesh.morph_displacements()),
        };
        let entries = [
            filled(device, "upload.bind_vertices", stored, &bind_vertices),
            filled(
                device,
                "upload.influence_starts",
                stored,
                mesh.influence_starts(),
            ),
            filled(device, "upload.influences", stored, mesh.influences()),
            filled(device, "upload.morph_starts", stored, morph_starts),
            filled(device, "upload.morph_displacements", stored, displacements),
        ];
        let entries: Vec<_> = (0u32..)
            .zip(&entries)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor {
            label: Some("upload.mesh"),
            layout,
            entries: &entries,
        };
        Self {
            index,
            vertex_count: mesh.vertex_count() as u32,
            indices: filled(
                device,
                "upload.indices",
                BufferUsages::INDEX,
                mesh.draw_triangles(),
            ),
            bind_group: device.device.create_bind_group(&descriptor),
            texturing: None,
        }
    }
}
