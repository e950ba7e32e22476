//! Stages 2 to 4 on the device, `shaders/shade.wgsl`, `coat.wgsl`, `lines.wgsl` and `solids.wgsl`: skin and skeleton into the targets.

use super::buffers::{Growing, filled};
use super::coats::Coats;
use super::device::Device;
use super::draws::{Draw, Draws};
use super::pipelines::{Kind, Pipelines, Variant};
use super::skin::SkinnedRig;
use super::solids::{SolidBuffers, SolidPlace};
use super::targets::{ColorTarget, Layers, TargetShape, Targets};
use super::textures::TextureBinding;
use super::wear::Wear;
use crate::render::order::{PartPlace, blending_parts};
use crate::render::view::View;
use crate::render::{Instance, Picture, Plan, Segment};
use glam::Vec4;
use std::ops::Range;
use wgpu::BufferUsages;

/// What `picture` is drawn into. A translucent skin gets a layer of its own, so that only its nearest surface is laid over what is behind.
pub(super) fn shape_of(picture: &Picture) -> TargetShape {
    TargetShape {
        size: picture.scene.size,
        samples: picture.scene.samples,
        layers: if picture.is_translucent() {
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
    view_layout: wgpu::BindGroupLayout,
    /// Those of all pictures of a submission, and so are lines and solids.
    views: Growing,
    view_group: wgpu::BindGroup,
    /// Bytes from one view to the next, as the device aligns them.
    view_stride: usize,
    /// Each segment once for each of its six corners: a software driver takes instances one at a time.
    lines: Growing,
    solids: SolidBuffers,
    coats: Coats,
    /// What all vertices of a rig read where it gives none: white, and texture coordinates of zero.
    not_given: wgpu::Buffer,
    /// Reused from submission to submission.
    scratch: Scratch,
}

#[derive(Default)]
struct Scratch {
    views: Vec<u8>,
    corners: Vec<Segment>,
    order: Vec<(f64, PartPlace)>,
}

/// A picture, that of `plan`, and the skin in it.
pub(super) struct Drawing<'a> {
    pub plan: &'a Plan,
    pub picture: &'a Picture,
    /// By instance that the plan shows; `None` of which nothing is there to be drawn.
    pub skin: Vec<Option<(&'a Instance, &'a SkinnedRig<'a>)>>,
}

/// A picture whose numbers are on the device.
pub(super) struct Ready<'a> {
    pub picture: &'a Picture,
    view_offset: u32,
    /// In bytes.
    lines: Range<u64>,
    solids: SolidPlace,
    skin: Draws<'a>,
}

/// Four floats of color, then two of texture coordinates.
const NOT_GIVEN: [f32; 6] = [1.0, 1.0, 1.0, 1.0, 0.0, 0.0];
const NO_COLOR: Range<u64> = 0..16;
const NO_TEXCOORD: Range<u64> = 16..24;

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
                    has_dynamic_offset: true,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let views = Growing::new(device, "shade.views", BufferUsages::UNIFORM);
        let alignment = wgpu_device.limits().min_uniform_buffer_offset_alignment as usize;
        let coats = Coats::new(device);
        Self {
            pipelines: Pipelines::new(device, &view_layout, textures, &coats),
            view_group: bind(device, &view_layout, &views),
            view_layout,
            views,
            view_stride: size_of::<View>().next_multiple_of(alignment),
            lines: Growing::new(device, "shade.lines", BufferUsages::VERTEX),
            solids: SolidBuffers::new(device),
            coats,
            not_given: filled(device, "shade.not_given", BufferUsages::VERTEX, &NOT_GIVEN),
            scratch: Scratch::default(),
        }
    }

    pub fn bytes(&self) -> u64 {
        let own = self.views.buffer().size() + self.lines.buffer().size();
        own + self.solids.bytes() + self.coats.bytes()
    }

    /// Writes what the passes of all pictures of a submission read, and makes the pipelines that were not needed before.
    pub fn prepare<'a>(&mut self, device: &Device, drawings: &[Drawing<'a>]) -> Vec<Ready<'a>> {
        if drawings.is_empty() {
            return Vec::new();
        }
        let Scratch {
            views,
            corners,
            order,
        } = &mut self.scratch;
        views.clear();
        corners.clear();
        self.coats.clear();
        let pictures = drawings.iter().map(|drawing| drawing.picture);
        let solids = pictures.map(|picture| &picture.skeleton.solids);
        let solids = self.solids.write(device, solids);
        let ready = drawings.iter().zip(solids).map(|(drawing, solids)| {
            let picture = drawing.picture;
            let view_offset = views.len() as u32;
            views.extend_from_slice(bytemuck::bytes_of(&View::of(picture)));
            views.resize(view_offset as usize + self.view_stride, 0);
            let lines_start = size_of_val(corners.as_slice()) as u64;
            let segments = picture.skeleton.lines.iter();
            corners.extend(segments.flat_map(|segment| [*segment; LINE_CORNERS as usize]));
            blending_parts(drawing.plan, order);
            Ready {
                picture,
                view_offset,
                lines: lines_start..size_of_val(corners.as_slice()) as u64,
                solids,
                skin: Draws::of(drawing, order, &mut self.coats),
            }
        });
        let ready: Vec<_> = ready.collect();
        if self.views.write(device, views) {
            self.view_group = bind(device, &self.view_layout, &self.views);
        }
        self.lines.write(device, corners);
        self.coats.write(device);
        for ready in &ready {
            for variant in ready.variants() {
                self.pipelines.prepare(device, variant);
            }
        }
        ready
    }

    /// Records the passes that draw `ready` into `targets`; `vertices` are the skinned ones.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        ready: &Ready<'_>,
        targets: &Targets,
        vertices: &wgpu::Buffer,
    ) {
        let background = ready.picture.scene.background.premultiplied();
        let mut pass = begin(encoder, &targets.color, Some(background), targets);
        self.draw_skeleton(&mut pass, ready);
        self.draw_skin(&mut pass, &ready.skin.base, vertices);
        let Some(layer_color) = &targets.skin_color else {
            return;
        };
        drop(pass);
        // With the depth of what is there, so that the skin stays behind what it is behind of.
        let mut pass = begin(encoder, layer_color, None, targets);
        pass.set_bind_group(0, &self.view_group, &[ready.view_offset]);
        self.draw_skin(&mut pass, &ready.skin.layer, vertices);
    }

    fn draw_skeleton(&self, pass: &mut wgpu::RenderPass<'_>, ready: &Ready<'_>) {
        pass.set_bind_group(0, &self.view_group, &[ready.view_offset]);
        for variant in ready.of_skeleton() {
            pass.set_pipeline(self.pipelines.get(variant));
            if variant.kind == Kind::Solids {
                self.solids.draw(pass, &ready.solids);
            } else {
                let count = LINE_CORNERS * ready.picture.skeleton.lines.len() as u32;
                pass.set_vertex_buffer(0, self.lines.buffer().slice(ready.lines.clone()));
                pass.draw(0..count, 0..1);
            }
        }
    }

    fn draw_skin(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        draws: &[Draw<'_>],
        vertices: &wgpu::Buffer,
    ) {
        for Draw {
            variant,
            place,
            wear,
            coat,
            indices,
        } in draws
        {
            let rig = place.rig;
            let texcoords = match &rig.texcoords {
                Some(texcoords) => texcoords.slice(..),
                None => self.not_given.slice(NO_TEXCOORD),
            };
            let colors = match &rig.colors {
                Some(colors) => colors.slice(..),
                None => self.not_given.slice(NO_COLOR),
            };
            match wear {
                Wear::Plain => {}
                Wear::Textured(texture) => {
                    pass.set_bind_group(1, texture, &[]);
                    pass.set_vertex_buffer(2, texcoords);
                }
                Wear::Coated { textures, .. } => {
                    pass.set_bind_group(1, textures, &[]);
                    coat.iter().for_each(|coat| self.coats.set(pass, 2, *coat));
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
        let of_skin = self.skin.iter().map(|draw| draw.variant);
        self.of_skeleton().chain(of_skin)
    }

    /// What the skeleton is drawn with, in this order.
    fn of_skeleton(&self) -> impl Iterator<Item = Variant> + use<> {
        let skeleton = &self.picture.skeleton;
        let samples = self.picture.scene.samples;
        let kinds = [
            (Kind::Lines, !skeleton.lines.is_empty()),
            (Kind::Solids, !skeleton.solids.is_empty()),
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

/// One view at a time.
fn bind(device: &Device, layout: &wgpu::BindGroupLayout, views: &Growing) -> wgpu::BindGroup {
    let view = wgpu::BufferBinding {
        buffer: views.buffer(),
        offset: 0,
        size: wgpu::BufferSize::new(size_of::<View>() as u64),
    };
    device.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shade.view"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(view),
        }],
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
