//! The solids of one picture on the device.

use super::buffers::Growing;
use super::device::Device;
use crate::render::Solids;
use wgpu::BufferUsages;

pub(super) struct SolidBuffers {
    vertices: Growing,
    indices: Growing,
}

impl SolidBuffers {
    pub fn new(device: &Device) -> Self {
        Self {
            vertices: Growing::new(device, "solids.vertices", BufferUsages::VERTEX),
            indices: Growing::new(device, "solids.indices", BufferUsages::INDEX),
        }
    }

    pub fn bytes(&self) -> u64 {
        self.vertices.buffer().size() + self.indices.buffer().size()
    }

    pub fn write(&mut self, device: &Device, solids: &Solids) {
        let vertices: &[u8] = bytemuck::cast_slice(&solids.vertices);
        let indices: &[u8] = bytemuck::cast_slice(&solids.triangles);
        for (buffer, bytes) in [(&mut self.vertices, vertices), (&mut self.indices, indices)] {
            buffer.reserve(device, bytes.len() as u64);
            device.queue.write_buffer(buffer.buffer(), 0, bytes);
        }
    }

    /// Draws what was [written](Self::write), with the pipeline that is set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, solids: &Solids) {
        pass.set_vertex_buffer(0, self.vertices.buffer().slice(..));
        pass.set_index_buffer(self.indices.buffer().slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..3 * solids.triangles.len() as u32, 0, 0..1);
    }
}
