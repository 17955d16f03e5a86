//! The pictures of a particle system: its ramps, its sprite flipbook and what belongs to it.

use glam::UVec2;

use crate::error::FieldError;
use crate::noise_volume::NoiseVolume;
use crate::pass::{Layouts, array_layers};
use crate::ramp::Ramp;
use crate::reference::diffuse_bake::zonal_coefficients;
use crate::reference::ramp::sample_ramp;
use crate::settings::Settings;
use crate::sprite::Sprite;
use crate::system::{DetailInfo, MaterialInfo};

/// The pictures in memory. The reference renderer works on these; the GPU renderer uploads them.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialAssets {
    /// Flipbook of normal maps.
    pub sprite: Sprite,
    /// Depth and motion of the sprite, frame by frame: see [`sprite::detail`](crate::sprite::detail). Depth sprites and
    /// `sprite.motion` need it.
    pub detail: Option<Sprite>,
    /// What volumetric sprites are made of.
    pub noise: NoiseVolume,
    /// Light by dot(n, l)/2 + 1/2: facing away at 0, facing the light at 1. One row.
    pub diffuse_ramp: Ramp,
    /// Light by amount, for [`SoftScatterMode::Ramp`](crate::settings::SoftScatterMode::Ramp). One row.
    pub soft_scatter_ramp: Ramp,
    /// Glow by distance² (across) and amount (up).
    pub specular_ramp: Ramp,
    /// A painted lit sphere, for [`DiffuseMode::PaintedMotif`](crate::settings::DiffuseMode::PaintedMotif).
    pub motif: Ramp,
    /// Colour of a particle by its age, forward only. One row. (MS)
    pub age_ramp: Ramp,
}

impl MaterialAssets {
    pub(crate) fn info(&self) -> MaterialInfo {
        MaterialInfo {
            sprite_size: self.sprite.size() as f32,
            frame_count: self.sprite.frame_count() as f32,
            detail: self.detail.as_ref().map(|detail| DetailInfo {
                frame_count: detail.frame_count(),
                lod: (self.sprite.size() as f32 / detail.size() as f32).log2(),
            }),
            zonal: zonal_coefficients(|cos| sample_ramp(&self.diffuse_ramp, cos * 0.5 + 0.5)),
        }
    }
}

impl MaterialInfo {
    /// Refuses settings that need a picture which the material of system `index` lacks.
    pub fn validate(&self, index: usize, settings: &Settings) -> Result<(), FieldError> {
        let refuse = |field: &str, value: String, expected: String| {
            Err(FieldError::new(format!("systems[{index}].{field}"), value, expected))
        };
        let Some(detail) = &self.detail else {
            let expected = || "another, or a detail map in the material, as `haze sprite bake` makes it".to_owned();
            if settings.technique.is_depth_sprite() {
                return refuse("settings.technique", format!("{:?}", settings.technique.name()), expected());
            }
            if settings.sprite.motion > 0.0 {
                return refuse("settings.sprite.motion", settings.sprite.motion.to_string(), expected());
            }
            return Ok(());
        };
        if detail.frame_count != self.frame_count as u32 {
            let expected = format!("as many as the sprite has, {}", self.frame_count);
            return refuse("material.detail", format!("{} frames", detail.frame_count), expected);
        }
        Ok(())
    }
}

/// How pictures are filtered.
#[derive(Debug)]
pub(crate) struct Samplers {
    /// Ramps and sprites: clamped at the border.
    pub linear: wgpu::Sampler,
    /// Noise: round and round.
    pub repeat: wgpu::Sampler,
}

impl Samplers {
    pub fn new(device: &wgpu::Device) -> Self {
        let sampler = |label, address_mode| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: address_mode,
                address_mode_v: address_mode,
                address_mode_w: address_mode,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            })
        };
        Self {
            linear: sampler("haze linear", wgpu::AddressMode::ClampToEdge),
            repeat: sampler("haze repeat", wgpu::AddressMode::Repeat),
        }
    }
}

/// The pictures on the GPU. Cheap to share between systems; made by
/// [`Renderer::create_material`](crate::Renderer::create_material).
#[derive(Clone, Debug)]
pub struct Material {
    pub(crate) bind_group: wgpu::BindGroup,
    pub(crate) info: MaterialInfo,
    bytes: u64,
}

impl Material {
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        samplers: &Samplers,
        assets: &MaterialAssets,
    ) -> Result<Self, FieldError> {
        validate_sizes(&device.limits(), assets)?;
        let mut bytes = 0;
        let sprite = upload_sprite(device, queue, "haze sprite", &assets.sprite, &mut bytes);
        // Nothing reads it where there is none, but something must be bound.
        let placeholder = Sprite::with_levels(1, 1, vec![[128, 128, 128, 0]]);
        let detail = assets.detail.as_ref().unwrap_or(&placeholder);
        let detail = upload_sprite(device, queue, "haze detail", detail, &mut bytes);
        let noise = upload_noise(device, queue, &assets.noise, &mut bytes);
        let mut ramp = |label, ramp| upload_ramp(device, queue, label, ramp, &mut bytes);
        let diffuse_ramp = ramp("haze diffuse_ramp", &assets.diffuse_ramp);
        let soft_scatter_ramp = ramp("haze soft_scatter_ramp", &assets.soft_scatter_ramp);
        let specular_ramp = ramp("haze specular_ramp", &assets.specular_ramp);
        let motif = ramp("haze painted_motif", &assets.motif);
        let age_ramp = ramp("haze age_ramp", &assets.age_ramp);
        let texture =
            |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("haze material"),
            layout: &layouts.material,
            entries: &[
                texture(0, &sprite),
                texture(1, &diffuse_ramp),
                texture(2, &soft_scatter_ramp),
                texture(3, &specular_ramp),
                texture(4, &motif),
                wgpu::BindGroupEntry { binding: 5, resource: wgpu::BindingResource::Sampler(&samplers.linear) },
                texture(6, &detail),
                texture(7, &age_ramp),
                texture(8, &noise),
                wgpu::BindGroupEntry { binding: 9, resource: wgpu::BindingResource::Sampler(&samplers.repeat) },
            ],
        });
        Ok(Self { bind_group, info: assets.info(), bytes })
    }

    /// Bytes of GPU memory that the pictures take.
    pub fn memory_use(&self) -> u64 {
        self.bytes
    }
}

/// Refuses pictures that are too large for the device.
fn validate_sizes(limits: &wgpu::Limits, assets: &MaterialAssets) -> Result<(), FieldError> {
    let check = |name: &str, side: u32, most: u32| {
        if side <= most {
            return Ok(());
        }
        Err(FieldError::new(
            format!("material.{name}"),
            format!("{side} texels"),
            format!("at most {most} on this device"),
        ))
    };
    let flat = limits.max_texture_dimension_2d;
    let ramps = [
        ("diffuse_ramp", &assets.diffuse_ramp),
        ("soft_scatter_ramp", &assets.soft_scatter_ramp),
        ("specular_ramp", &assets.specular_ramp),
        ("motif", &assets.motif),
        ("age_ramp", &assets.age_ramp),
    ];
    for (name, ramp) in ramps {
        check(name, ramp.size().max_element(), flat)?;
    }
    for (name, sprite) in [("sprite", Some(&assets.sprite)), ("detail", assets.detail.as_ref())] {
        let Some(sprite) = sprite else { continue };
        check(name, sprite.size(), flat)?;
        check(name, array_layers(sprite.frame_count()), limits.max_texture_array_layers)?;
    }
    check("noise", assets.noise.size(), limits.max_texture_dimension_3d)
}

fn upload_ramp(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    ramp: &Ramp,
    bytes: &mut u64,
) -> wgpu::TextureView {
    let size = extent(ramp.size(), 1);
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let data = ramp.bytes();
    *bytes += data.len() as u64;
    queue.write_texture(texture.as_image_copy(), &data, layout(8 * size.width, size.height), size);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn upload_noise(device: &wgpu::Device, queue: &wgpu::Queue, noise: &NoiseVolume, bytes: &mut u64) -> wgpu::TextureView {
    let size = extent(UVec2::splat(noise.size()), noise.size());
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("haze noise"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    *bytes += noise.bytes().len() as u64;
    queue.write_texture(texture.as_image_copy(), noise.bytes(), layout(4 * size.width, size.height), size);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn upload_sprite(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    sprite: &Sprite,
    bytes: &mut u64,
) -> wgpu::TextureView {
    let layers = array_layers(sprite.frame_count());
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: extent(UVec2::splat(sprite.size()), layers),
        mip_level_count: sprite.level_count(),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for level in 0..sprite.level_count() {
        let data = sprite.level_bytes(level);
        let size = sprite.level_size(level);
        *bytes += 4 * u64::from(size) * u64::from(size) * u64::from(layers);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            data,
            layout(4 * size, size),
            extent(UVec2::splat(size), sprite.frame_count()),
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

fn extent(size: UVec2, layers: u32) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers }
}

fn layout(bytes_per_row: u32, rows: u32) -> wgpu::TexelCopyBufferLayout {
    wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row), rows_per_image: Some(rows) }
}
