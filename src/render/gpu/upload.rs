//! From a [`Rig`] to what the device keeps of it.

use super::buffers::filled;
use super::device::Device;
use crate::rig::{Mesh, Rig, RigId};
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
    pub index_count: u32,
    pub indices: Buffer,
    /// What the skin stage reads: bind vertices, where influences start, influences.
    pub bind_group: BindGroup,
}

/// Rigs on the device, uploaded when first drawn, dropped when nobody holds them any more.
#[derive(Default)]
pub(super) struct Uploads {
    rigs: HashMap<RigId, GpuRig>,
}

impl Uploads {
    pub fn upload(&mut self, device: &Device, layout: &wgpu::BindGroupLayout, rig: &Arc<Rig>) {
        self.rigs
            .entry(rig.id())
            .or_insert_with(|| GpuRig::upload(device, layout, rig));
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
    fn upload(device: &Device, layout: &wgpu::BindGroupLayout, rig: &Arc<Rig>) -> Self {
        let meshes = rig
            .meshes()
            .iter()
            .enumerate()
            .filter(|(_, mesh)| mesh.vertex_count() > 0);
        let meshes: Vec<_> = meshes
            .map(|(index, mesh)| GpuMesh::upload(device, layout, index, mesh))
            .collect();
        let bytes = rig.meshes().iter().map(mesh_bytes).sum();
        Self {
            meshes,
            rig: Arc::downgrade(rig),
            bytes,
        }
    }
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let words =
        6 * mesh.vertex_count() + mesh.influence_starts().len() + 2 * mesh.influences().len();
    4 * (words + 3 * mesh.triangles().len()) as u64
}

impl GpuMesh {
    fn upload(device: &Device, layout: &wgpu::BindGroupLayout, index: usize, mesh: &Mesh) -> Self {
        let storage = BufferUsages::STORAGE;
        let bind_vertices = [mesh.positions(), mesh.normals()].concat();
        let bind_vertices = filled(device, "upload.bind_vertices", storage, &bind_vertices);
        let starts = filled(
            device,
            "upload.influence_starts",
            storage,
            mesh.influence_starts(),
        );
        let influences = filled(device, "upload.influences", storage, mesh.influences());
        let indices = filled(
            device,
            "upload.indices",
            BufferUsages::INDEX,
            mesh.draw_triangles(),
        );
        let entries = [&bind_vertices, &starts, &influences];
        let entries: Vec<_> = (0u32..)
            .zip(entries)
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
            index_count: 3 * mesh.draw_triangles().len() as u32,
            indices,
            bind_group: device.device.create_bind_group(&descriptor),
        }
    }
}
