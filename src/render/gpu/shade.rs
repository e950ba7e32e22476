//! Stages 2 to 4 on the device, `shaders/shade.wgsl`, `material.wgsl`, `lines.wgsl` and `solids.wgsl`: skin and skeleton into the targets.

use super::buffers::{Growing, filled};
use super::device::Device;
use super::draw_list::MaterialBinding;
use super::draws::{Draw, Drawing, Draws};
use super::material_buffer::MaterialBuffer;
use super::pipelines::{Kind, Pipelines, Variant};
use super::solids::{SolidBuffers, SolidPlace};
use super::targets::{ColorTarget, Layers, TargetShape, Targets};
use super::textures::TextureBinding;
use crate::render::instance_params::InstanceParams;
use crate::render::order::{PartPlace, blending_parts};
use crate::render::view::View;
use crate::render::{Plan, Segment};
use crate::scene::{Samples, Scene};
use glam::Vec4;
use std::ops::Range;
use wgpu::BufferUsages;

/// What the picture of `plan` is drawn into. Translucent skin gets a layer of its own, so that only its nearest surface is laid over what is
/// behind.
pub(super) fn shape_of(plan: &Plan, scene: &Scene) -> TargetShape {
    TargetShape {
        size: scene.size,
        samples: scene.samples,
        layers: if plan.is_translucent() {
            Layers::Two
        } else {
            Layers::One
        },
    }
}

/// Of the two triangles that a line is drawn as.
pub(super) const LINE_CORNERS: u32 = 6;

pub(super) struct ShadeStage {
    pipelines: Pipelines,
    uniform_layout: wgpu::BindGroupLayout,
    /// Those of all pictures of a submission, and so are instances, lines and solids.
    views: Growing,
    instances: Growing,
    uniform_group: wgpu::BindGroup,
    /// Bytes from one view to the next, as the device aligns them.
    view_stride: usize,
    /// The same of instances.
    params_stride: usize,
    /// Each segment once for each of its six corners: a software driver takes instances one at a time.
    lines: Growing,
    solids: SolidBuffers,
    materials: MaterialBuffer,
    /// What all vertices of a rig read where it gives none: white, and texture coordinates of zero.
    not_given: wgpu::Buffer,
    /// Reused from submission to submission.
    scratch: Scratch,
}

#[derive(Default)]
struct Scratch {
    views: Vec<u8>,
    instances: Vec<u8>,
    corners: Vec<Segment>,
    order: Vec<(f64, PartPlace)>,
}

/// A picture whose numbers are on the device.
pub(super) struct Ready<'a> {
    scene: &'a Scene,
    view_offset: u32,
    skeletons: Vec<ReadySkeleton>,
    skin: Draws<'a>,
}

/// The skeleton of an instance.
struct ReadySkeleton {
    params_offset: u32,
    /// Corners in the buffer of lines.
    lines: Range<u32>,
    solids: SolidPlace,
}

/// Bytes from the parameters of one instance to the next, at the most: what devices align to at the worst.
pub(super) const MOST_PARAMS_STRIDE: usize = size_of::<InstanceParams>().next_multiple_of(256);

/// Four floats of color, then two of texture coordinates.
const NOT_GIVEN: [f32; 6] = [1.0, 1.0, 1.0, 1.0, 0.0, 0.0];
const NO_COLOR: Range<u64> = 0..16;
const NO_TEXCOORD: Range<u64> = 16..24;

impl ShadeStage {
    pub(super) fn new(device: &Device, textures: &TextureBinding) -> Self {
        let wgpu_device = &device.device;
        let uniform = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: None,
            },
            count: None,
        };
        let uniform_layout =
            wgpu_device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("shade.uniforms"),
                entries: &[uniform(0), uniform(1)],
            });
        let views = Growing::new(device, "shade.views", BufferUsages::UNIFORM);
        let instances = Growing::new(device, "shade.instances", BufferUsages::UNIFORM);
        let alignment = wgpu_device.limits().min_uniform_buffer_offset_alignment as usize;
        let materials = MaterialBuffer::new(device);
        Self {
            pipelines: Pipelines::new(device, &uniform_layout, textures, &materials),
            uniform_group: bind(device, &uniform_layout, &views, &instances),
            uniform_layout,
            views,
            instances,
            view_stride: size_of::<View>().next_multiple_of(alignment),
            params_stride: size_of::<InstanceParams>().next_multiple_of(alignment),
            lines: Growing::new(device, "shade.lines", BufferUsages::VERTEX),
            solids: SolidBuffers::new(device),
            materials,
            not_given: filled(device, "shade.not_given", BufferUsages::VERTEX, &NOT_GIVEN),
            scratch: Scratch::default(),
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        let own = [&self.views, &self.instances, &self.lines];
        let own = own.map(|growing| growing.buffer().size());
        own.iter().sum::<u64>() + self.solids.bytes() + self.materials.bytes()
    }

    /// Writes what the passes of all pictures of a submission read, and makes the pipelines that were not needed before.
    pub(super) fn prepare<'a>(
        &mut self,
        device: &Device,
        drawings: &[Drawing<'a>],
    ) -> Vec<Ready<'a>> {
        if drawings.is_empty() {
            return Vec::new();
        }
        let Scratch {
            views,
            instances,
            corners,
            order,
        } = &mut self.scratch;
        views.clear();
        instances.clear();
        corners.clear();
        self.materials.clear();
        let skeletons = drawings.iter().flat_map(|drawing| &drawing.plan.instances);
        let solids = skeletons.map(|instance| &instance.skeleton().solids);
        let mut solids = self.solids.write(device, solids).into_iter();
        let ready = drawings.iter().map(|drawing| {
            let view_offset = append(views, &View::of(drawing.scene), self.view_stride);
            let placed = drawing.plan.instances.iter().zip(&mut solids);
            let skeletons = placed.map(|(instance, solids)| {
                let params = InstanceParams::of(instance, &drawing.scene.camera);
                let first = corners.len() as u32;
                let segments = instance.skeleton().lines.iter();
                corners.extend(segments.flat_map(|segment| [*segment; LINE_CORNERS as usize]));
                ReadySkeleton {
                    params_offset: append(instances, &params, self.params_stride),
                    lines: first..corners.len() as u32,
                    solids,
                }
            });
            let skeletons: Vec<_> = skeletons.collect();
            blending_parts(drawing.plan, order);
            let params_offset = |instance: usize| skeletons[instance].params_offset;
            let skin = Draws::of(drawing, params_offset, order, &mut self.materials);
            Ready {
                scene: drawing.scene,
                view_offset,
                skin,
                skeletons,
            }
        });
        let ready: Vec<_> = ready.collect();
        let grew = [
            self.views.write(device, views),
            self.instances.write(device, instances),
        ];
        if grew.contains(&true) {
            let layout = &self.uniform_layout;
            self.uniform_group = bind(device, layout, &self.views, &self.instances);
        }
        self.lines.write(device, corners);
        self.materials.write(device);
        for ready in &ready {
            for variant in ready.variants() {
                self.pipelines.prepare(device, variant);
            }
        }
        ready
    }

    /// Records the passes that draw `ready` into `targets`; `vertices` are the skinned ones.
    pub(super) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        ready: &Ready<'_>,
        targets: &Targets,
        vertices: &wgpu::Buffer,
    ) {
        let background = ready.scene.background.premultiplied();
        let mut pass = begin(encoder, &targets.color, Some(background), targets);
        self.draw_skeletons(&mut pass, ready);
        self.draw_skin(&mut pass, ready.view_offset, &ready.skin.base, vertices);
        let Some(layer_color) = &targets.skin_color else {
            return;
        };
        drop(pass);
        // With the depth of what is there, so that the skin stays behind what it is behind of.
        let mut pass = begin(encoder, layer_color, None, targets);
        self.draw_skin(&mut pass, ready.view_offset, &ready.skin.layer, vertices);
    }

    fn draw_skeletons(&self, pass: &mut wgpu::RenderPass<'_>, ready: &Ready<'_>) {
        for skeleton in &ready.skeletons {
            let offsets = [ready.view_offset, skeleton.params_offset];
            for variant in skeleton.variants(ready.scene.samples) {
                pass.set_bind_group(0, &self.uniform_group, &offsets);
                pass.set_pipeline(self.pipelines.get(variant));
                if variant.kind == Kind::Solids {
                    self.solids.draw(pass, &skeleton.solids);
                } else {
                    pass.set_vertex_buffer(0, self.lines.buffer().slice(..));
                    pass.draw(skeleton.lines.clone(), 0..1);
                }
            }
        }
    }

    fn draw_skin(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        view_offset: u32,
        draws: &[Draw<'_>],
        vertices: &wgpu::Buffer,
    ) {
        for Draw {
            variant,
            params_offset,
            place,
            binding,
            material_offset,
            indices,
        } in draws
        {
            let rig = place.rig;
            pass.set_bind_group(0, &self.uniform_group, &[view_offset, *params_offset]);
            let texcoords = match &rig.texcoords {
                Some(texcoords) => texcoords.slice(..),
                None => self.not_given.slice(NO_TEXCOORD),
            };
            let colors = match &rig.colors {
                Some(colors) => colors.slice(..),
                None => self.not_given.slice(NO_COLOR),
            };
            match binding {
                MaterialBinding::Plain => {}
                MaterialBinding::Textured(texture) => {
                    pass.set_bind_group(1, texture, &[]);
                    pass.set_vertex_buffer(2, texcoords);
                }
                MaterialBinding::Full { textures, .. } => {
                    pass.set_bind_group(1, textures, &[]);
                    if let Some(offset) = material_offset {
                        self.materials.set(pass, 2, *offset);
                    }
                    pass.set_vertex_buffer(2, texcoords);
                    pass.set_vertex_buffer(3, colors);
                }
            }
            pass.set_vertex_buffer(0, vertices.slice(place.positions_start..));
            pass.set_vertex_buffer(1, vertices.slice(place.normals_start..));
            pass.set_index_buffer(rig.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.set_pipeline(self.pipelines.get(*variant));
            pass.draw_indexed(indices.clone(), 0, 0..1);
        }
    }
}

impl Ready<'_> {
    fn variants(&self) -> impl Iterator<Item = Variant> {
        let skeletons = self.skeletons.iter();
        let of_skeletons = skeletons.flat_map(|skeleton| skeleton.variants(self.scene.samples));
        of_skeletons.chain(self.skin.iter().map(|draw| draw.variant))
    }
}

impl ReadySkeleton {
    /// What it is drawn with, in this order.
    fn variants(&self, samples: Samples) -> impl Iterator<Item = Variant> + use<> {
        let kinds = [
            (Kind::Lines, !self.lines.is_empty()),
            (Kind::Solids, !self.solids.is_empty()),
        ];
        let drawn = kinds.into_iter().filter(|(_, is_drawn)| *is_drawn);
        drawn.map(move |(kind, _)| Variant {
            kind,
            samples,
            culled: None,
            blends: false,
        })
    }
}

/// Adds an item of a uniform buffer, and says where it starts; `stride` is from one to the next.
fn append<T: bytemuck::NoUninit>(items: &mut Vec<u8>, item: &T, stride: usize) -> u32 {
    let offset = items.len();
    items.extend_from_slice(bytemuck::bytes_of(item));
    items.resize(offset + stride, 0);
    offset as u32
}

/// One view and one instance at a time.
fn bind(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    views: &Growing,
    instances: &Growing,
) -> wgpu::BindGroup {
    let one = |buffer, size: usize| {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer,
            offset: 0,
            size: wgpu::BufferSize::new(size as u64),
        })
    };
    let view = one(views.buffer(), size_of::<View>());
    let instance = one(instances.buffer(), size_of::<InstanceParams>());
    let entries = [(0, view), (1, instance)];
    device.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shade.uniforms"),
        layout,
        entries: &entries.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }),
    })
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
