//! What is drawn into: color and depth samples, and the resolved pixels. Kept by size, so that a stream of like frames makes none.

use super::buffers::{create, filled};
use super::device::Device;
use super::layout::ResolveJob;
use crate::scene::{Samples, Size};
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

/// Linear, and precise enough that 8-bit sRGB comes out right after averaging.
pub(super) const COLOR_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
pub(super) const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

pub(super) struct Targets {
    pub shape: TargetShape,
    pub color: ColorTarget,
    pub depth: wgpu::TextureView,
    /// What the skin is drawn into where it is translucent.
    pub skin_color: Option<ColorTarget>,
    /// One RGBA8 word a pixel, rows without padding.
    pub pixels: wgpu::Buffer,
    pub resolve_group: wgpu::BindGroup,
}

/// One layer of color. Where there are several samples the device averages them at the end of the pass: wgpu's GL backend cannot
/// bind multisampled textures, so no shader does it.
pub(super) struct ColorTarget {
    pub drawn: wgpu::TextureView,
    pub averaged: Option<wgpu::TextureView>,
}

impl ColorTarget {
    fn new(device: &Device, shape: TargetShape) -> Self {
        let averaged = TextureUsages::TEXTURE_BINDING;
        let one = TargetShape {
            samples: Samples::One,
            ..shape
        };
        match shape.samples {
            Samples::One => {
                let drawn = one.view(device, "targets.color", COLOR_FORMAT, averaged);
                Self {
                    drawn,
                    averaged: None,
                }
            }
            Samples::Four => {
                let drawn = shape.view(
                    device,
                    "targets.color",
                    COLOR_FORMAT,
                    TextureUsages::empty(),
                );
                let averaged = one.view(device, "targets.averaged", COLOR_FORMAT, averaged);
                Self {
                    drawn,
                    averaged: Some(averaged),
                }
            }
        }
    }

    fn mean(&self) -> &wgpu::TextureView {
        self.averaged.as_ref().unwrap_or(&self.drawn)
    }
}

/// What makes two sets of targets interchangeable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct TargetShape {
    pub size: Size,
    pub samples: Samples,
    pub layers: Layers,
}

/// Whether the skin is drawn over the skeleton or into a layer of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layers {
    One,
    Two,
}

/// The targets of the shapes drawn last.
#[derive(Default)]
pub(super) struct TargetCache {
    /// The most recently used last.
    kept: Vec<Targets>,
}

impl TargetCache {
    /// What several shapes may take together; a single one may take more.
    const MOST_BYTES: u64 = 512 << 20;

    pub(super) fn get(
        &mut self,
        device: &Device,
        resolve_layout: &wgpu::BindGroupLayout,
        shape: TargetShape,
    ) -> &Targets {
        let found = self.kept.iter().position(|targets| targets.shape == shape);
        let targets = match found {
            Some(index) => self.kept.remove(index),
            None => {
                while !self.kept.is_empty() && self.bytes() + shape.bytes() > Self::MOST_BYTES {
                    self.kept.remove(0);
                }
                Targets::new(device, resolve_layout, shape)
            }
        };
        self.kept.push(targets);
        &self.kept[self.kept.len() - 1]
    }

    pub(super) fn bytes(&self) -> u64 {
        self.kept.iter().map(|targets| targets.shape.bytes()).sum()
    }
}

impl TargetShape {
    /// Eight bytes of color a sample and layer and again for the mean, four of depth a sample, four of result a pixel.
    pub(super) fn bytes(self) -> u64 {
        let samples = u64::from(self.samples.count());
        let means = if self.samples == Samples::One { 0 } else { 1 };
        let layers = self.layers as u64 + 1;
        self.size.pixels() as u64 * (8 * layers * (samples + means) + 4 * samples + 4)
    }

    fn view(
        self,
        device: &Device,
        label: &str,
        format: TextureFormat,
        usage: TextureUsages,
    ) -> wgpu::TextureView {
        let Size { width, height } = self.size;
        let texture = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: self.samples.count(),
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT | usage,
            view_formats: &[],
        });
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }
}

impl Targets {
    fn new(device: &Device, resolve_layout: &wgpu::BindGroupLayout, shape: TargetShape) -> Self {
        let color = ColorTarget::new(device, shape);
        let depth = shape.view(
            device,
            "targets.depth",
            DEPTH_FORMAT,
            TextureUsages::empty(),
        );
        let skin_color = (shape.layers == Layers::Two).then(|| ColorTarget::new(device, shape));
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let pixels = create(
            device,
            "targets.pixels",
            usage,
            4 * shape.size.pixels() as u64,
        );

        let Size { width, height } = shape.size;
        let layers = shape.layers as u32 + 1;
        let job = ResolveJob {
            width,
            height,
            layers,
        };
        let job = filled(device, "targets.resolve_job", BufferUsages::UNIFORM, &[job]);
        // With one layer the shader reads no second one, but something must stand there.
        let [base, skin] = [&color, skin_color.as_ref().unwrap_or(&color)].map(ColorTarget::mean);
        let resolve_group = device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("targets.resolve"),
            layout: resolve_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: job.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(base),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(skin),
                },
                wgpu::BindGroupEntry {
                    binding: 3,
                    resource: pixels.as_entire_binding(),
                },
            ],
        });
        Self {
            shape,
            color,
            depth,
            skin_color,
            pixels,
            resolve_group,
        }
    }
}
