//! The unit shapes of `render/solids.rs` on the device, and the instances of one picture.

use super::buffers::{Growing, filled};
use super::device::Device;
use crate::render::{Solid, SolidShape, Solids};
use std::ops::Range;
use wgpu::{Buffer, BufferUsages};

/// Every shape in one vertex and one index buffer.
pub(super) struct SolidMeshes {
    vertices: Buffer,
    indices: Buffer,
    ranges: [ShapeRange; SolidShape::ALL.len()],
    instances: Growing,
}

#[derive(Clone, Default)]
struct ShapeRange {
    indices: Range<u32>,
    first_vertex: i32,
}

impl SolidMeshes {
    pub fn new(device: &Device) -> Self {
        let (mut vertices, mut indices) = (Vec::new(), Vec::new());
        let ranges = SolidShape::ALL.map(|shape| {
            let mesh = shape.mesh();
            let (first_vertex, first_index) = (vertices.len() as i32, indices.len() as u32);
            vertices.extend(mesh.vertices);
            indices.extend(mesh.triangles.into_flattened());
            ShapeRange {
                indices: first_index..indices.len() as u32,
                first_vertex,
            }
        });
        Self {
            vertices: filled(device, "solids.vertices", BufferUsages::VERTEX, &vertices),
            indices: filled(device, "solids.indices", BufferUsages::INDEX, &indices),
            ranges,
            instances: Growing::new(device, "solids.instances", BufferUsages::VERTEX),
        }
    }

    pub fn bytes(&self) -> u64 {
        self.vertices.size() + self.indices.size() + self.instances.buffer().size()
    }

    /// Writes the instances of all groups, one group after another.
    pub fn write(&mut self, device: &Device, groups: &[Solids]) {
        let count: usize = groups.iter().map(|group| group.instances.len()).sum();
        self.instances
            .reserve(device, (count * size_of::<Solid>()) as u64);
        let mut start = 0;
        for Solids { instances, .. } in groups {
            let bytes: &[u8] = bytemuck::cast_slice(instances);
            device
                .queue
                .write_buffer(self.instances.buffer(), start, bytes);
            start += bytes.len() as u64;
        }
    }

    /// Draws what was [written](Self::write), with the pipeline that is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, groups: &[Solids]) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.buffer().slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        let mut first = 0;
        for Solids { shape, instances } in groups {
            let ShapeRange {
                indices,
                first_vertex,
            } = self.ranges[*shape as usize].clone();
            let end = first + instances.len() as u32;
            pass.draw_indexed(indices, first_vertex, first..end);
            first = end;
        }
    }
}
