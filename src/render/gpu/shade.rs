//! Stages 2 to 4 on the device, `shaders/shade.wgsl`, `lines.wgsl` and `solids.wgsl`: skin and skeleton into the targets.

use super::buffers::Growing;
use super::device::Device;
use super::shaders;
use super::skin::SkinnedMesh;
use super::solids::SolidBuffers;
use super::targets::{COLOR_FORMAT, ColorTarget, DEPTH_FORMAT, Layers, Targets};
use super::textures::TextureBinding;
use super::upload::GpuRig;
use crate::render::cull::{self, Side};
use crate::render::view::View;
use crate::render::{Instance, Picture, Segment, SolidVertex};
use crate::scene::Samples;
use glam::Vec4;
use std::collections::HashMap;
use std::ops::Range;
use wgpu::{BufferUsages, CompareFunction, VertexStepMode};

/// What a pipeline draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Kind {
    Lines,
    Solids,
    Skin,
    TexturedSkin,
}

/// What tells one pipeline from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Variant {
    kind: Kind,
    samples: Samples,
    culled: Option<Side>,
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

/// Of the two triangles that a line is drawn as.
const LINE_CORNERS: u32 = 6;

pub(super) struct ShadeStage {
    layout: wgpu::PipelineLayout,
    textured_layout: wgpu::PipelineLayout,
    skin_module: wgpu::ShaderModule,
    line_module: wgpu::ShaderModule,
    solid_module: wgpu::ShaderModule,
    pipelines: HashMap<Variant, wgpu::RenderPipeline>,
    view: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    /// Each segment once for each of its six corners: a software driver takes instances one at a time.
    lines: Growing,
    /// Reused from frame to frame.
    corners: Vec<Segment>,
    solids: SolidBuffers,
}

/// Skinned meshes, and the instances that they are of.
pub(super) struct Drawn<'a> {
    pub skinned: &'a [SkinnedMesh],
    pub instances: &'a [Instance],
    pub rigs: &'a [&'a GpuRig],
    pub vertices: &'a wgpu::Buffer,
}

impl ShadeStage {
    pub fn new(device: &Device, textures: &TextureBinding) -> Self {
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
        let layout = |groups: &[Option<&wgpu::BindGroupLayout>]| {
            wgpu_device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("shade.pipeline_layout"),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        Self {
            layout: layout(&[Some(&view_layout)]),
            textured_layout: layout(&[Some(&view_layout), Some(&textures.layout)]),
            skin_module: module("shade.skin", shaders::SHADE),
            line_module: module("shade.lines", shaders::LINES),
            solid_module: module("shade.solids", shaders::SOLIDS),
            pipelines: HashMap::new(),
            view,
            view_group,
            lines: Growing::new(device, "shade.lines", BufferUsages::VERTEX),
            corners: Vec::new(),
            solids: SolidBuffers::new(device),
        }
    }

    pub fn bytes(&self) -> u64 {
        self.view.size() + self.lines.buffer().size() + self.solids.bytes()
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
        self.prepare(device, picture, drawn);
        let background = picture.scene.background.premultiplied();
        let mut pass = begin(encoder, &targets.color, Some(background), targets);
        self.draw_skeleton(&mut pass, picture);
        let Some(skin_color) = &targets.skin_color else {
            return self.draw_skin(&mut pass, picture, drawn);
        };
        drop(pass);
        // With the depth of the skeleton, so that skin behind it stays behind it.
        let mut pass = begin(encoder, skin_color, None, targets);
        self.draw_skin(&mut pass, picture, drawn);
    }

    /// Writes what the passes read, and makes the pipelines that were not needed before.
    fn prepare(&mut self, device: &Device, picture: &Picture, drawn: &Drawn<'_>) {
        let samples = picture.scene.samples;
        self.corners.clear();
        let segments = picture.skeleton.lines.iter();
        self.corners
            .extend(segments.flat_map(|segment| [*segment; LINE_CORNERS as usize]));
        let lines: &[u8] = bytemuck::cast_slice(&self.corners);
        self.lines.reserve(device, lines.len() as u64);
        device.queue.write_buffer(self.lines.buffer(), 0, lines);
        self.solids.write(device, &picture.skeleton.solids);
        device
            .queue
            .write_buffer(&self.view, 0, bytemuck::bytes_of(&View::of(picture)));
        let of_skeleton = [
            (Kind::Lines, !lines.is_empty()),
            (Kind::Solids, !picture.skeleton.solids.is_empty()),
        ];
        let of_skeleton = of_skeleton.into_iter().filter(|(_, is_drawn)| *is_drawn);
        let mut variants: Vec<_> = of_skeleton
            .map(|(kind, _)| Variant {
                kind,
                samples,
                culled: None,
            })
            .collect();
        if picture.skin_is_shown {
            let skinned = drawn.skinned.iter();
            let parts = skinned.flat_map(|place| drawn.parts(place, picture));
            variants.extend(parts.map(|(variant, _)| variant));
        }
        for variant in variants {
            if !self.pipelines.contains_key(&variant) {
                let pipeline = self.pipeline(device, variant);
                self.pipelines.insert(variant, pipeline);
            }
        }
    }

    fn draw_skeleton(&self, pass: &mut wgpu::RenderPass<'_>, picture: &Picture) {
        let (lines, solids) = (&picture.skeleton.lines, &picture.skeleton.solids);
        let pipeline = |kind| {
            let samples = picture.scene.samples;
            &self.pipelines[&Variant {
                kind,
                samples,
                culled: None,
            }]
        };
        pass.set_bind_group(0, &self.view_group, &[]);
        if !lines.is_empty() {
            pass.set_pipeline(pipeline(Kind::Lines));
            pass.set_vertex_buffer(0, self.lines.buffer().slice(..));
            pass.draw(0..LINE_CORNERS * lines.len() as u32, 0..1);
        }
        if !solids.is_empty() {
            pass.set_pipeline(pipeline(Kind::Solids));
            self.solids.draw(pass, solids);
        }
    }

    fn draw_skin(&self, pass: &mut wgpu::RenderPass<'_>, picture: &Picture, drawn: &Drawn<'_>) {
        if !picture.skin_is_shown {
            return;
        }
        pass.set_bind_group(0, &self.view_group, &[]);
        let vertices = drawn.vertices;
        for place in drawn.skinned {
            let mesh = &drawn.rigs[place.instance].meshes[place.uploaded];
            if mesh.index_count == 0 {
                continue;
            }
            if let Some(texturing) = &mesh.texturing {
                pass.set_bind_group(1, &texturing.bind_group, &[]);
                pass.set_vertex_buffer(2, texturing.texcoords.slice(..));
            }
            pass.set_vertex_buffer(0, vertices.slice(place.positions_start..));
            pass.set_vertex_buffer(1, vertices.slice(place.normals_start..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            for (variant, indices) in drawn.parts(place, picture) {
                pass.set_pipeline(&self.pipelines[&variant]);
                pass.draw_indexed(indices, 0, 0..1);
            }
        }
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

impl Drawn<'_> {
    /// What one mesh of the skin is drawn with, and which of its indices.
    fn parts(
        &self,
        place: &SkinnedMesh,
        picture: &Picture,
    ) -> impl Iterator<Item = (Variant, Range<u32>)> + use<> {
        let instance = &self.instances[place.instance];
        let mesh = &instance.rig().meshes()[place.mesh];
        let uploaded = &self.rigs[place.instance].meshes[place.uploaded];
        let kind = match uploaded.texturing {
            Some(_) => Kind::TexturedSkin,
            None => Kind::Skin,
        };
        let samples = picture.scene.samples;
        let reach = cull::reach(instance, mesh);
        cull::parts(instance, mesh, &picture.scene, reach).map(move |part| {
            let variant = Variant {
                kind,
                samples,
                culled: part.culled,
            };
            let Range { start, end } = part.triangles;
            (variant, 3 * start as u32..3 * end as u32)
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
