//! Stage 5 on the device, `shaders/resolve.wgsl`: averaged layers to the bytes of a picture.

use super::device::Device;
use super::shaders;
use super::targets::Targets;
use wgpu::{BindingType, BufferBindingType, TextureSampleType, TextureViewDimension};

pub(super) struct ResolveStage {
    pub layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl ResolveStage {
    pub(super) fn new(device: &Device) -> Self {
        let module = device
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("resolve.shader"),
                source: wgpu::ShaderSource::Wgsl(shaders::RESOLVE.into()),
            });
        let buffer = |ty| BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: false },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        };
        let types = [
            buffer(BufferBindingType::Uniform),
            texture,
            texture,
            buffer(BufferBindingType::Storage { read_only: false }),
        ];
        let entries: Vec<_> = (0u32..)
            .zip(types)
            .map(|(binding, ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty,
                count: None,
            })
            .collect();
        let layout = device
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("resolve.layout"),
                entries: &entries,
            });
        let pipeline_layout =
            device
                .device
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some("resolve.pipeline_layout"),
                    bind_group_layouts: &[Some(&layout)],
                    immediate_size: 0,
                });
        let pipeline = device
            .device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("resolve.pipeline"),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some("resolve"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
        Self { layout, pipeline }
    }

    /// Records the pass that fills `targets.pixels`.
    pub(super) fn encode(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets) {
        let descriptor = wgpu::ComputePassDescriptor {
            label: Some("resolve.pass"),
            timestamp_writes: None,
        };
        let shape = targets.shape;
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &targets.resolve_group, &[]);
        let groups = shape.size.width.div_ceil(shaders::WORKGROUP);
        pass.dispatch_workgroups(groups, shape.size.height, 1);
    }
}
