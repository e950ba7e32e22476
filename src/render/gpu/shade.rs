//! Stages 2 to 4 on the device, `shaders/shade.wgsl` and `shaders/skeleton.wgsl`: triangles and lines into the targets.

use super::buffers::Growing;
use super::device::Device;
use super::layout::View;
use super::shaders;
use super::skin::SkinnedMesh;
use super::targets::{COLOR_FORMAT, ColorTarget, DEPTH_FORMAT, Layers, Targets};
use super::upload::GpuRig;
use crate::render::{Picture, Segment};
use crate::scene::Samples;
use glam::Vec4;
use std::collections::HashMap;
use wgpu::{BufferUsages, CompareFunction, VertexAttribute, VertexFormat, VertexStepMode};

/// What a pipeline draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Kind {
    Lines,
    Skin,
}

/// A translucent skin gets a layer of its own, so that only its nearest surface is laid over what stands behind it.
pub(super) fn layers_of(picture: &Picture) -> Layers {
    let is_translucent = picture.skin_is_shown && picture.scene.show.skin_opacity() < 1.0;
    if is_translucent {
        Layers::Two
    } else {
        Layers::One
    }
}

pub(super) struct ShadeStage {
    layout: wgpu::PipelineLayout,
    skin_module: wgpu::ShaderModule,
    line_module: wgpu::ShaderModule,
    pipelines: HashMap<(Kind, Samples), wgpu::RenderPipeline>,
    view: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    lines: Growing,
}

/// Skinned meshes, and the rigs of the instances that they are of.
pub(super) struct Drawn<'a> {
    pub skinned: &'a [SkinnedMesh],
    pub rigs: &'a [&'a GpuRig],
    pub vertices: &'a wgpu::Buffer,
}

impl ShadeStage {
    pub fn new(device: &Device) -> Self {
        let wgpu_device = &device.device;
        let view_layout = wgpu_device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("shade.view"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let module = |label, source: &'static str| {
            let source = wgpu::ShaderSource::Wgsl(source.into());
            wgpu_device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source,
            })
        };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let view = super::buffers::create(device, "shade.view", usage, size_of::<View>() as u64);
        let view_group = wgpu_device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shade.view"),
            layout: &view_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: view.as_entire_binding(),
            }],
        });
        let layout = wgpu_device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("shade.pipeline_layout"),
            bind_group_layouts: &[Some(&view_layout)],
            immediate_size: 0,
        });
        Self {
            layout,
            skin_module: module("shade.skin", shaders::SHADE),
            line_module: module("shade.lines", shaders::SKELETON),
            pipelines: HashMap::new(),
            view,
            view_group,
            lines: Growing::new(device, "shade.lines", BufferUsages::VERTEX),
        }
    }

    pub fn bytes(&self) -> u64 {
        self.view.size() + self.lines.buffer().size()
    }

    /// Records the passes that draw `picture` into `targets`.
    pub fn encode(
        &mut self,
        device: &Device,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Picture,
        targets: &Targets,
        drawn: &Drawn<'_>,
    ) {
        self.prepare(device, picture);
        let background = picture.scene.background.premultiplied();
        let mut pass = begin(encoder, &targets.color, Some(background), targets);
        self.draw_lines(&mut pass, picture);
        let Some(skin_color) = &targets.skin_color else {
            return self.draw_skin(&mut pass, picture, drawn);
        };
        drop(pass);
        // With the depth of the lines, so that skin behind one stays behind it.
        let mut pass = begin(encoder, skin_color, None, targets);
        self.draw_skin(&mut pass, picture, drawn);
    }

    /// Writes what the passes read, and makes the pipelines that were not needed before.
    fn prepare(&mut self, device: &Device, picture: &Picture) {
        let samples = picture.scene.samples;
        let lines: &[u8] = bytemuck::cast_slice(&picture.lines);
        self.lines.reserve(device, lines.len() as u64);
        device.queue.write_buffer(self.lines.buffer(), 0, lines);
        device
            .queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&View::of(picture)));
        let drawn = [
            (Kind::Lines, !lines.is_empty()),
            (Kind::Skin, picture.skin_is_shown),
        ];
        for (kind, _) in drawn.into_iter().filter(|(_, is_drawn)| *is_drawn) {
            if !self.pipelines.contains_key(&(kind, samples)) {
                let pipeline = self.pipeline(device, kind, samples);
                self.pipelines.insert((kind, samples), pipeline);
            }
        }
    }

    fn draw_lines(&self, pass: &mut wgpu::RenderPass<'_>, picture: &Picture) {
        if picture.lines.is_empty() {
            return;
        }
        pass.set_pipeline(&self.pipelines[&(Kind::Lines, picture.scene.samples)]);
        pass.set_bind_group(0, &self.view_group, &[]);
        pass.set_vertex_buffer(0, self.lines.buffer().slice(..));
        pass.draw(0..6, 0..picture.lines.len() as u32);
    }

    fn draw_skin(&self, pass: &mut wgpu::RenderPass<'_>, picture: &Picture, drawn: &Drawn<'_>) {
        if !picture.skin_is_shown {
            return;
        }
        pass.set_pipeline(&self.pipelines[&(Kind::Skin, picture.scene.samples)]);
        pass.set_bind_group(0, &self.view_group, &[]);
        let vertices = drawn.vertices;
        for place in drawn.skinned {
            let mesh = &drawn.rigs[place.instance].meshes[place.uploaded];
            if mesh.index_count > 0 {
                pass.set_vertex_buffer(0, vertices.slice(place.positions_start..));
                pass.set_vertex_buffer(1, vertices.slice(place.normals_start..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
                pass.draw_indexed(0..mesh.index_count, 0, 0..1);
            }
        }
    }

    fn pipeline(&self, device: &Device, kind: Kind, samples: Samples) -> wgpu::RenderPipeline {
        let vector = |location| {
            [VertexAttribute {
                format: VertexFormat::Float32x3,
                offset: 0,
                shader_location: location,
            }]
        };
        let (positions, normals) = (vector(0), vector(1));
        let per_vertex = |attributes| {
            Some(wgpu::VertexBufferLayout {
                array_stride: 12,
                step_mode: VertexStepMode::Vertex,
                attributes,
            })
        };
        let line_attributes =
            wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32, 2 => Float32x3, 3 => Float32x3];
        let lines = Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Segment>() as u64,
            step_mode: VertexStepMode::Instance,
            attributes: &line_attributes,
        });
        let skin_buffers = [per_vertex(&positions), per_vertex(&normals)];
        let line_buffers = [lines];
        let (module, vertex, fragment, buffers): (_, _, _, &[_]) = match kind {
            Kind::Lines => (
                &self.line_module,
                "line_vertex",
                "line_fragment",
                &line_buffers,
            ),
            Kind::Skin => (
                &self.skin_module,
                "skin_vertex",
                "skin_fragment",
                &skin_buffers,
            ),
        };
        device
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("shade.pipeline"),
                layout: Some(&self.layout),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers,
                },
                // Winding decides which side is seen, never whether it is seen: sample files disagree about it.
                primitive: wgpu::PrimitiveState {
                    cull_mode: None,
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
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(COLOR_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
    }
}

/// Starts a pass over a background and fresh depth, or over nothing and the depth that is there.
fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    color: &ColorTarget,
    background: Option<Vec4>,
    targets: &Targets,
) -> wgpu::RenderPass<'a> {
    let [r, g, b, a] = background.unwrap_or_default().to_array().map(f64::from);
    let depth = if background.is_some() {
        wgpu::LoadOp::Clear(0.0)
    } else {
        wgpu::LoadOp::Load
    };
    // Once averaged, the samples themselves are of no more use.
    let store = if color.averaged.is_some() {
        wgpu::StoreOp::Discard
    } else {
        wgpu::StoreOp::Store
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("shade.pass"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &color.drawn,
            depth_slice: None,
            resolve_target: color.averaged.as_ref(),
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
                store,
            },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &targets.depth,
            depth_ops: Some(wgpu::Operations {
                load: depth,
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}
