//! The pipelines of the shade stage: one for each kind of thing, sample count and side that is left out, made when first needed.

use super::device::Device;
use super::shaders;
use super::targets::{COLOR_FORMAT, DEPTH_FORMAT};
use super::textures::TextureBinding;
use crate::render::cull::Side;
use crate::render::{Segment, SolidVertex};
use crate::scene::Samples;
use std::collections::HashMap;
use wgpu::{CompareFunction, VertexStepMode};

/// What a pipeline draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Lines,
    Solids,
    Skin,
    TexturedSkin,
}

/// What tells one pipeline from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    pub kind: Kind,
    pub samples: Samples,
    pub culled: Option<Side>,
}

pub(super) struct Pipelines {
    layout: wgpu::PipelineLayout,
    textured_layout: wgpu::PipelineLayout,
    skin_module: wgpu::ShaderModule,
    line_module: wgpu::ShaderModule,
    solid_module: wgpu::ShaderModule,
    made: HashMap<Variant, wgpu::RenderPipeline>,
}

impl Pipelines {
    pub fn new(
        device: &Device,
        view_layout: &wgpu::BindGroupLayout,
        textures: &TextureBinding,
    ) -> Self {
        let module = |label, source: &'static str| {
            let source = wgpu::ShaderSource::Wgsl(source.into());
            device
                .device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(label),
                    source,
                })
        };
        let layout = |groups: &[Option<&wgpu::BindGroupLayout>]| {
            device
                .device
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some("shade.pipeline_layout"),
                    bind_group_layouts: groups,
                    immediate_size: 0,
                })
        };
        Self {
            layout: layout(&[Some(view_layout)]),
            textured_layout: layout(&[Some(view_layout), Some(&textures.layout)]),
            skin_module: module("shade.skin", shaders::SHADE),
            line_module: module("shade.lines", shaders::LINES),
            solid_module: module("shade.solids", shaders::SOLIDS),
            made: HashMap::new(),
        }
    }

    /// Makes the one of `variant` where it was not needed before.
    pub fn prepare(&mut self, device: &Device, variant: Variant) {
        if !self.made.contains_key(&variant) {
            let pipeline = self.pipeline(device, variant);
            self.made.insert(variant, pipeline);
        }
    }

    /// One that was [prepared](Self::prepare).
    pub fn get(&self, variant: Variant) -> &wgpu::RenderPipeline {
        &self.made[&variant]
    }

    fn pipeline(&self, device: &Device, variant: Variant) -> wgpu::RenderPipeline {
        let Variant {
            kind,
            samples,
            culled,
        } = variant;
        let positions = wgpu::vertex_attr_array![0 => Float32x3];
        let normals = wgpu::vertex_attr_array![1 => Float32x3];
        let texcoords = wgpu::vertex_attr_array![2 => Float32x2];
        let segment =
            wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Float32x3];
        let solid = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
        let per_vertex = |array_stride: usize, attributes| {
            Some(wgpu::VertexBufferLayout {
                array_stride: array_stride as u64,
                step_mode: VertexStepMode::Vertex,
                attributes,
            })
        };
        let (layout, module, stem, buffers) = match kind {
            Kind::Lines => (
                &self.layout,
                &self.line_module,
                "line",
                vec![per_vertex(size_of::<Segment>(), &segment[..])],
            ),
            Kind::Solids => (
                &self.layout,
                &self.solid_module,
                "solid",
                vec![per_vertex(size_of::<SolidVertex>(), &solid[..])],
            ),
            Kind::Skin => (
                &self.layout,
                &self.skin_module,
                "plain",
                vec![per_vertex(12, &positions[..]), per_vertex(12, &normals[..])],
            ),
            Kind::TexturedSkin => (
                &self.textured_layout,
                &self.skin_module,
                "textured",
                vec![
                    per_vertex(12, &positions[..]),
                    per_vertex(12, &normals[..]),
                    per_vertex(8, &texcoords[..]),
                ],
            ),
        };
        let (vertex, fragment) = (format!("{stem}_vertex"), format!("{stem}_fragment"));
        device
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("shade.pipeline"),
                layout: Some(layout),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(&vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: &buffers,
                },
                // Winding decides which side is seen, and only of closed surfaces whether it is: sample files disagree about it.
                primitive: wgpu::PrimitiveState {
                    cull_mode: culled.map(|side| match side {
                        Side::Front => wgpu::Face::Front,
                        Side::Back => wgpu::Face::Back,
                    }),
                    ..wgpu::PrimitiveState::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH_FORMAT,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState {
                    count: samples.count(),
                    ..wgpu::MultisampleState::default()
                },
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some(&fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(COLOR_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
    }
}
