//! The pipelines of the shade stage: one for each kind of thing, sample count, side that is left out and whether it blends, made when first
//! needed.

use super::coats::Coats;
use super::device::Device;
use super::shaders::{self, SAMPLES, Shading};
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
    CoatedSkin(Given),
}

/// What a rig gives for each vertex by itself. What it does not is the same for all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Given {
    pub texcoords: bool,
    pub colors: bool,
}

/// What tells one pipeline from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    pub kind: Kind,
    pub samples: Samples,
    pub culled: Option<Side>,
    /// Laid over what is there, by its alpha, and hides nothing that is drawn later. Otherwise it takes the place of what is behind.
    pub blends: bool,
}

pub(super) struct Pipelines {
    layout: wgpu::PipelineLayout,
    textured_layout: wgpu::PipelineLayout,
    coated_layout: wgpu::PipelineLayout,
    shading: Shading,
    skin_module: wgpu::ShaderModule,
    coat_module: wgpu::ShaderModule,
    line_module: wgpu::ShaderModule,
    solid_module: wgpu::ShaderModule,
    made: HashMap<Variant, wgpu::RenderPipeline>,
}

impl Pipelines {
    pub fn new(
        device: &Device,
        uniform_layout: &wgpu::BindGroupLayout,
        textures: &TextureBinding,
        coats: &Coats,
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
        let shading = if device.tells_coverage {
            shaders::BY_MASK
        } else {
            shaders::BY_DRIVER
        };
        Self {
            layout: layout(&[Some(uniform_layout)]),
            textured_layout: layout(&[Some(uniform_layout), Some(&textures.layout)]),
            coated_layout: layout(&[
                Some(uniform_layout),
                Some(&textures.coat_layout),
                Some(&coats.layout),
            ]),
            skin_module: module("shade.skin", shading.skin),
            coat_module: module("shade.coat", shading.coat),
            line_module: module("shade.lines", shaders::LINES),
            solid_module: module("shade.solids", shading.solids),
            shading,
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
            blends,
        } = variant;
        let positions = wgpu::vertex_attr_array![0 => Float32x3];
        let normals = wgpu::vertex_attr_array![1 => Float32x3];
        let texcoords = wgpu::vertex_attr_array![2 => Float32x2];
        let colors = wgpu::vertex_attr_array![3 => Float32x4];
        let segment =
            wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Float32x3];
        let solid = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];
        // What is drawn is a single instance: all of its vertices read the same.
        let per_vertex_or_once = |is_given, array_stride: usize, attributes| {
            Some(wgpu::VertexBufferLayout {
                array_stride: array_stride as u64,
                step_mode: if is_given {
                    VertexStepMode::Vertex
                } else {
                    VertexStepMode::Instance
                },
                attributes,
            })
        };
        let per_vertex =
            |array_stride, attributes| per_vertex_or_once(true, array_stride, attributes);
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
            Kind::CoatedSkin(given) => (
                &self.coated_layout,
                &self.coat_module,
                "coated",
                vec![
                    per_vertex(12, &positions[..]),
                    per_vertex(12, &normals[..]),
                    per_vertex_or_once(given.texcoords, 8, &texcoords[..]),
                    per_vertex_or_once(given.colors, 16, &colors[..]),
                ],
            ),
        };
        let samples_constant = [(SAMPLES, f64::from(samples.count()))];
        let counts_samples = self.shading.counts_samples && kind != Kind::Lines;
        let constants: &[_] = if counts_samples {
            &samples_constant
        } else {
            &[]
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
                    depth_write_enabled: Some(!blends),
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
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants,
                        ..wgpu::PipelineCompilationOptions::default()
                    },
                    targets: &[Some(wgpu::ColorTargetState {
                        blend: blends.then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                        ..COLOR_FORMAT.into()
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
    }
}
