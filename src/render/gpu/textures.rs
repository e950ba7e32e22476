//! Textures on the device, and how they are bound. Their mipmaps were made at load: nothing is computed here.

use super::device::Device;
use crate::rig::{Encoding, Material, Texture, TextureLevel, TexturePlace, Wrap};
use std::collections::HashMap;
use std::sync::Arc;
use wgpu::{AddressMode, BindingResource, FilterMode, ShaderStages, TextureView};

/// What textures are bound with.
pub(super) struct TextureBinding {
    /// Of one texture, repeated.
    pub layout: wgpu::BindGroupLayout,
    /// Of a material's three: of its color, of what it emits, of normals.
    pub material_layout: wgpu::BindGroupLayout,
    /// For each way of going on to the sides, and of these for each up and down.
    samplers: [[wgpu::Sampler; 3]; 3],
    /// Stand where a material has none: a color that changes nothing, a normal that leans nowhere.
    white: TextureView,
    upright: TextureView,
}

/// Textures of one rig, each uploaded once, however many materials have it.
#[derive(Default)]
pub(super) struct TextureUploads {
    views: HashMap<*const Texture, TextureView>,
    bytes: u64,
}

impl TextureBinding {
    pub(super) fn new(device: &Device) -> Self {
        let single = |texel| {
            let level = TextureLevel {
                width: 1,
                height: 1,
                texels: vec![texel],
            };
            let texture = Texture::new(String::new(), Encoding::Linear, level);
            upload(device, &texture)
        };
        let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
        Self {
            layout: layout(device, "textures.texture", 1),
            material_layout: layout(device, "textures.material", 3),
            samplers: wraps.map(|u| wraps.map(|v| sampler(device, [u, v]))),
            white: single([255; 4]),
            upright: single([128, 128, 255, 255]),
        }
    }

    /// A texture that is repeated.
    pub(super) fn bind(&self, device: &Device, texture: &TextureView) -> wgpu::BindGroup {
        let sampler = self.sampler([Wrap::Repeat; 2]);
        bind(device, &self.layout, &[(texture, sampler)])
    }

    /// Those of `material`.
    pub(super) fn bind_material(
        &self,
        device: &Device,
        uploads: &mut TextureUploads,
        material: Option<&Material>,
    ) -> wgpu::BindGroup {
        let color = material.and_then(|it| it.texture.as_ref());
        let emissive = material.and_then(|it| it.emissive_texture.as_ref());
        let normals = material.and_then(|it| it.normal_map.as_ref());
        let places = [
            (color, &self.white),
            (emissive, &self.white),
            (normals.map(|map| &map.place), &self.upright),
        ];
        let bound = places.map(|(place, otherwise)| self.bound(device, uploads, place, otherwise));
        let [color, emissive, normals] = &bound;
        let pairs = [color, emissive, normals].map(|(texture, sampler)| (texture, *sampler));
        bind(device, &self.material_layout, &pairs)
    }

    fn bound(
        &self,
        device: &Device,
        uploads: &mut TextureUploads,
        place: Option<&TexturePlace>,
        otherwise: &TextureView,
    ) -> (TextureView, &wgpu::Sampler) {
        match place {
            Some(place) => {
                let texture = uploads.upload(device, &place.texture);
                (texture, self.sampler(place.wrap))
            }
            None => (otherwise.clone(), self.sampler([Wrap::Repeat; 2])),
        }
    }

    fn sampler(&self, [u, v]: [Wrap; 2]) -> &wgpu::Sampler {
        let index = |wrap| match wrap {
            Wrap::Repeat => 0,
            Wrap::Mirror => 1,
            Wrap::Clamp => 2,
        };
        &self.samplers[index(u)][index(v)]
    }
}

impl TextureUploads {
    pub(super) fn upload(&mut self, device: &Device, texture: &Arc<Texture>) -> TextureView {
        let Self { views, bytes } = self;
        let uploaded = views.entry(Arc::as_ptr(texture)).or_insert_with(|| {
            *bytes += texture.memory_bytes() as u64;
            upload(device, texture)
        });
        uploaded.clone()
    }

    /// Of all of them.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes
    }
}

fn layout(device: &Device, label: &str, textures: u32) -> wgpu::BindGroupLayout {
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
    let pair = |index| [entry(2 * index, texture), entry(2 * index + 1, sampler)];
    let entries: Vec<_> = (0..textures).flat_map(pair).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    };
    device.device.create_bind_group_layout(&descriptor)
}

fn bind(
    device: &Device,
    layout: &wgpu::BindGroupLayout,
    textures: &[(&TextureView, &wgpu::Sampler)],
) -> wgpu::BindGroup {
    let resources = textures.iter().flat_map(|(texture, sampler)| {
        [
            BindingResource::TextureView(texture),
            BindingResource::Sampler(sampler),
        ]
    });
    let entries: Vec<_> = (0u32..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
        .collect();
    device.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("textures.bound"),
        layout,
        entries: &entries,
    })
}

fn sampler(device: &Device, wrap: [Wrap; 2]) -> wgpu::Sampler {
    let [u, v] = wrap.map(|wrap| match wrap {
        Wrap::Repeat => AddressMode::Repeat,
        Wrap::Mirror => AddressMode::MirrorRepeat,
        Wrap::Clamp => AddressMode::ClampToEdge,
    });
    device.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("textures.sampler"),
        address_mode_u: u,
        address_mode_v: v,
        mag_filter: FilterMode::Linear,
        min_filter: FilterMode::Linear,
        // The shader names whole levels.
        mipmap_filter: wgpu::MipmapFilterMode::Nearest,
        ..wgpu::SamplerDescriptor::default()
    })
}

fn upload(device: &Device, texture: &Texture) -> TextureView {
    let levels = texture.levels();
    let extent = |level: &TextureLevel| wgpu::Extent3d {
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
        format: match texture.encoding() {
            // Decoded before it is filtered.
            Encoding::Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
            Encoding::Linear => wgpu::TextureFormat::Rgba8Unorm,
        },
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
    on_device.create_view(&wgpu::TextureViewDescriptor::default())
}
