//! The pipelines of the shade stage: one for each kind of thing, sample count, side that is left out and whether it blends, made when first
//! needed.

use super::device::Device;
use super::material_buffer::MaterialBuffer;
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
    MaterialSkin(Given),
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

/// Shaders of one kind: `stem` is what the names of their entry points start with.
struct Program<'a> {
    layout: &'a wgpu::PipelineLayout,
    module: &'a wgpu::ShaderModule,
    stem: &'static str,
}

const POSITION: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
const NORMAL: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![1 => Float32x3];
const TEXCOORD: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![2 => Float32x2];
const COLOR: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![3 => Float32x4];
const SEGMENT: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Float32x3];
const SOLID: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3];

impl Kind {
    fn vertex_buffers(self) -> Vec<Option<wgpu::VertexBufferLayout<'static>>> {
        let per_vertex = VertexStepMode::Vertex;
        // A draw has a single instance: all of its vertices then read the same.
        let once_unless = |is_given| {
            if is_given {
                per_vertex
            } else {
                VertexStepMode::Instance
            }
        };
        let positions = buffer(12, per_vertex, &POSITION);
        let normals = buffer(12, per_vertex, &NORMAL);
        match self {
            Self::Lines => vec![buffer(size_of::<Segment>(), per_vertex, &SEGMENT)],
            Self::Solids => vec![buffer(size_of::<SolidVertex>(), per_vertex, &SOLID)],
            Self::Skin => vec![positions, normals],
            Self::TexturedSkin => vec![positions, normals, buffer(8, per_vertex, &TEXCOORD)],
            Self::MaterialSkin(given) => vec![
                positions,
                normals,
                buffer(8, once_unless(given.texcoords), &TEXCOORD),
                buffer(16, once_unless(given.colors), &COLOR),
            ],
        }
    }
}

fn buffer(
    array_stride: usize,
    step_mode: VertexStepMode,
    attributes: &'static [wgpu::VertexAttribute],
) -> Option<wgpu::VertexBufferLayout<'static>> {
    Some(wgpu::VertexBufferLayout {
        array_stride: array_stride as u64,
        step_mode,
        attributes,
    })
}

pub(super) struct Pipelines {
    layout: wgpu::PipelineLayout,
    textured_layout: wgpu::PipelineLayout,
    material_layout: wgpu::PipelineLayout,
    shading: Shading,
    skin_module: wgpu::ShaderModule,
    material_module: wgpu::ShaderModule,
    line_module: wgpu::ShaderModule,
    solid_module: wgpu::ShaderModule,
    made: HashMap<Variant, wgpu::RenderPipeline>,
}

impl Pipelines {
    pub(super) fn new(
        device: &Device,
        uniform_layout: &wgpu::BindGroupLayout,
        textures: &TextureBinding,
        materials: &MaterialBuffer,
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
        let shading = if device.has_sample_mask_input {
            shaders::BY_MASK
        } else {
            shaders::BY_DRIVER
        };
        Self {
            layout: layout(&[Some(uniform_layout)]),
            textured_layout: layout(&[Some(uniform_layout), Some(&textures.layout)]),
            material_layout: layout(&[
                Some(uniform_layout),
                Some(&textures.material_layout),
                Some(&materials.layout),
            ]),
            skin_module: module("shade.skin", shading.skin),
            material_module: module("shade.material", shading.material),
            line_module: module("shade.lines", shaders::LINES),
            solid_module: module("shade.solids", shading.solids),
            shading,
            made: HashMap::new(),
        }
    }

    /// Makes the one of `variant` where it was not needed before.
    pub(super) fn prepare(&mut self, device: &Device, variant: Variant) {
        if !self.made.contains_key(&variant) {
            let pipeline = self.pipeline(device, variant);
            self.made.insert(variant, pipeline);
        }
    }

    /// One that was [prepared](Self::prepare).
    pub(super) fn get(&self, variant: Variant) -> &wgpu::RenderPipeline {
        &self.made[&variant]
    }

    fn program(&self, kind: Kind) -> Program<'_> {
        let (layout, module, stem) = match kind {
            Kind::Lines => (&self.layout, &self.line_module, "line"),
            Kind::Solids => (&self.layout, &self.solid_module, "solid"),
            Kind::Skin => (&self.layout, &self.skin_module, "plain"),
            Kind::TexturedSkin => (&self.textured_layout, &self.skin_module, "textured"),
            Kind::MaterialSkin(_) => (&self.material_layout, &self.material_module, "material"),
        };
        Program {
            layout,
            module,
            stem,
        }
    }

    fn pipeline(&self, device: &Device, variant: Variant) -> wgpu::RenderPipeline {
        let Variant {
            kind,
            samples,
            culled,
            blends,
        } = variant;
        let Program {
            layout,
            module,
            stem,
        } = self.program(kind);
        let buffers = kind.vertex_buffers();
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
                    cull_mode: culled.map(face),
                    ..wgpu::PrimitiveState::default()
                },
                depth_stencil: Some(depth(!blends)),
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

fn face(side: Side) -> wgpu::Face {
    match side {
        Side::Front => wgpu::Face::Front,
        Side::Back => wgpu::Face::Back,
    }
}

/// The nearest wins; `is_written`: it hides what is drawn later.
fn depth(is_written: bool) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(is_written),
        depth_compare: Some(CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}
