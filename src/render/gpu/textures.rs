//! Textures on the device. Their mipmaps were made at load: nothing is computed here.

use super::device::Device;
use crate::rig::Texture;
use std::sync::Arc;
use wgpu::{FilterMode, ShaderStages};

/// What every texture is bound with.
pub(super) struct TextureBinding {
    pub layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
}

impl TextureBinding {
    pub fn new(device: &Device) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = device
            .device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("textures.texture"),
                entries: &[entry(0, texture), entry(1, sampler)],
            });
        let sampler = device.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("textures.repeated"),
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            // The shader names whole levels.
            mipmap_filter: wgpu::MipmapFilterMode::Nearest,
            ..wgpu::SamplerDescriptor::default()
        });
        Self { layout, sampler }
    }

    pub fn upload(&self, device: &Device, texture: &Arc<Texture>) -> wgpu::BindGroup {
        let levels = texture.levels();
        let extent = |level: &crate::rig::TextureLevel| wgpu::Extent3d {
            width: level.width,
            height: level.height,
            depth_or_array_layers: 1,
        };
        let on_device = device.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("textures.texture"),
            size: extent(&levels[0]),
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            // Decoded before it is filtered.
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        for (mip_level, level) in (0u32..).zip(levels) {
            let place = wgpu::TexelCopyTextureInfo {
                texture: &on_device,
                mip_level,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            };
            let rows = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * level.width),
                rows_per_image: None,
            };
            let texels = bytemuck::cast_slice(&level.texels);
            device
                .queue
                .write_texture(place, texels, rows, extent(level));
        }
        let view = on_device.create_view(&wgpu::TextureViewDescriptor::default());
        device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("textures.texture"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&self.sampler),
                },
            ],
        })
    }
}
