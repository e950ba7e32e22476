//! The solids of all instances of a submission on the device.

use super::buffers::Growing;
use super::device::Device;
use crate::render::{SolidVertex, Solids};
use std::ops::Range;
use wgpu::BufferUsages;

pub(super) struct SolidBuffers {
    vertices: Growing,
    indices: Growing,
    /// Reused from submission to submission.
    gathered: Solids,
}

/// Where the solids of one instance lie: bytes of vertices and of indices.
pub(super) struct SolidPlace {
    vertices: Range<u64>,
    indices: Range<u64>,
}

impl SolidPlace {
    pub(super) fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }
}

impl SolidBuffers {
    pub(super) fn new(device: &Device) -> Self {
        Self {
            vertices: Growing::new(device, "solids.vertices", BufferUsages::VERTEX),
            indices: Growing::new(device, "solids.indices", BufferUsages::INDEX),
            gathered: Solids::default(),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        self.vertices.buffer().size() + self.indices.buffer().size()
    }

    /// In step with `instances`.
    pub(super) fn write<'a>(
        &mut self,
        device: &Device,
        instances: impl Iterator<Item = &'a Solids>,
    ) -> Vec<SolidPlace> {
        let Solids {
            vertices,
            triangles,
        } = &mut self.gathered;
        vertices.clear();
        triangles.clear();
        let place = |solids: &Solids| {
            let first_vertex = size_of_val(vertices.as_slice()) as u64;
            let first_index = size_of_val(triangles.as_slice()) as u64;
            vertices.extend_from_slice(&solids.vertices);
            triangles.extend_from_slice(&solids.triangles);
            SolidPlace {
                vertices: first_vertex..size_of_val(vertices.as_slice()) as u64,
                indices: first_index..size_of_val(triangles.as_slice()) as u64,
            }
        };
        let places = instances.map(place).collect();
        self.vertices
            .write::<SolidVertex>(device, &self.gathered.vertices);
        self.indices.write(device, &self.gathered.triangles);
        places
    }

    /// Draws what was [written](Self::write), with the pipeline that is set.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, place: &SolidPlace) {
        let SolidPlace { vertices, indices } = place;
        let count = (indices.end - indices.start) / size_of::<u32>() as u64;
        pass.set_vertex_buffer(0, self.vertices.buffer().slice(vertices.clone()));
        let indices = self.indices.buffer().slice(indices.clone());
        pass.set_index_buffer(indices, wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..count as u32, 0, 0..1);
    }
}
