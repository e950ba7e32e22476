//! The parameters of the materials of all pictures of a submission, on the device.

use super::buffers::Growing;
use super::device::Device;
use crate::render::material_params::MaterialParams;
use wgpu::BufferUsages;

pub(super) struct MaterialBuffer {
    pub layout: wgpu::BindGroupLayout,
    buffer: Growing,
    group: wgpu::BindGroup,
    /// Bytes from one material to the next, as the device aligns them.
    stride: usize,
    /// Reused from submission to submission.
    gathered: Vec<u8>,
}

impl MaterialBuffer {
    /// At the most, from one material to the next: what devices align to at the worst.
    pub(super) const MOST_STRIDE: usize = size_of::<MaterialParams>().next_multiple_of(256);

    pub(super) fn new(device: &Device) -> Self {
        let wgpu_device = &device.device;
        let layout = wgpu_device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("material_buffer"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let buffer = Growing::new(device, "material_buffer.materials", BufferUsages::UNIFORM);
        let alignment = wgpu_device.limits().min_uniform_buffer_offset_alignment as usize;
        Self {
            group: bind(device, &layout, &buffer),
            layout,
            buffer,
            stride: size_of::<MaterialParams>().next_multiple_of(alignment),
            gathered: Vec::new(),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        self.buffer.buffer().size()
    }

    pub(super) fn clear(&mut self) {
        self.gathered.clear();
    }

    /// Where it will be bound once it is [written](Self::write).
    pub(super) fn add(&mut self, material: &MaterialParams) -> u32 {
        let offset = self.gathered.len();
        self.gathered
            .extend_from_slice(bytemuck::bytes_of(material));
        self.gathered.resize(offset + self.stride, 0);
        offset as u32
    }

    /// Writes what was added since they were [cleared](Self::clear).
    pub(super) fn write(&mut self, device: &Device) {
        if self.buffer.write(device, &self.gathered) {
            self.group = bind(device, &self.layout, &self.buffer);
        }
    }

    pub(super) fn set(&self, pass: &mut wgpu::RenderPass<'_>, index: u32, offset: u32) {
        pass.set_bind_group(index, &self.group, &[offset]);
    }
}

/// One at a time.
fn bind(device: &Device, layout: &wgpu::BindGroupLayout, buffer: &Growing) -> wgpu::BindGroup {
    let material = wgpu::BufferBinding {
        buffer: buffer.buffer(),
        offset: 0,
        size: wgpu::BufferSize::new(size_of::<MaterialParams>() as u64),
    };
    device.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("material_buffer"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(material),
        }],
    })
}
