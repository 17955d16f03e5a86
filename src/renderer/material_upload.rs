//! Upload of materials: sprite images, ramps and noise.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use haze_core::assets::material_assets::MaterialAssets;
use haze_core::assets::noise::NoiseVolume;
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::Sprite;
use haze_core::assets::sprite::alpha_bounds::AlphaBounds;
use haze_core::error::FieldError;
use haze_core::glam::UVec2;

use super::gpu::Gpu;
use super::gpu::capabilities::array_layers;
use super::layouts::{LIGHTING_BINDINGS, Layouts, SPRITE_BINDINGS};
use crate::frame::{Material, UploadedImage};

/// Samplers and textures that every material binds.
#[derive(Debug)]
pub(crate) struct SharedTextures {
    /// For ramps and sprites: clamps at the border.
    pub linear: wgpu::Sampler,
    /// For noise: repeats.
    repeat: wgpu::Sampler,
    /// Placeholder for a missing detail map. No shader reads it, but the binding must be filled.
    no_detail: wgpu::TextureView,
    /// Images of materials.
    pub images: UploadedImages,
}

impl SharedTextures {
    pub fn new(gpu: &Gpu<'_>) -> Self {
        let sampler = |label, address_mode| {
            gpu.device.create_sampler(&wgpu::SamplerDescriptor {
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
        let no_detail = Sprite::with_levels(1, 1, vec![[128, 128, 128, 0]]);
        Self {
            linear: sampler("haze linear", wgpu::AddressMode::ClampToEdge),
            repeat: sampler("haze repeat", wgpu::AddressMode::Repeat),
            no_detail: upload_sprite(gpu, "haze no detail", &no_detail, None).view,
            images: UploadedImages::default(),
        }
    }
}

/// Images that materials of a context hold.
#[derive(Debug, Default)]
pub(crate) struct UploadedImages(Mutex<HashMap<ImageKey, Weak<UploadedImage>>>);

/// Images that an uploaded one was made of, by number.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
enum ImageKey {
    Single(u64),
    /// A sprite, and the six-way maps that follow its frames.
    Sprite(u64, Option<u64>),
    AlphaBounds(u64, Option<u64>),
}

impl UploadedImages {
    /// Returns the size of the images that materials hold, bytes.
    pub fn bytes(&self) -> u64 {
        let images = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        images.values().filter_map(Weak::upgrade).map(|image| image.bytes).sum()
    }

    /// Returns an image that a material holds already, or uploads it.
    fn get_or_upload(&self, key: ImageKey, upload: impl FnOnce() -> UploadedImage) -> Arc<UploadedImage> {
        let mut images = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(image) = images.get(&key).and_then(Weak::upgrade) {
            return image;
        }
        images.retain(|_, image| image.strong_count() > 0);
        let image = Arc::new(upload());
        images.insert(key, Arc::downgrade(&image));
        image
    }
}

/// Uploads the images that no other material of the context holds, and binds all.
///
/// # Errors
/// Names an image that is too large for the device, or six-way maps that do not fit the sprite.
pub(crate) fn create_material(
    gpu: &Gpu<'_>,
    layouts: &Layouts,
    shared: &SharedTextures,
    context: u64,
    assets: &MaterialAssets,
) -> Result<Material, FieldError> {
    validate_sizes(&gpu.device.limits(), assets)?;
    let uploaded = &shared.images;
    let six_way = assets.six_way.as_ref();
    let maps = six_way.map(Sprite::number);
    let number = assets.sprite.number();
    let upload = || upload_sprite(gpu, "haze sprite", &assets.sprite, six_way);
    let sprite = uploaded.get_or_upload(ImageKey::Sprite(number, maps), upload);
    let info = assets.info();
    let upload = || upload_filled(gpu, &info.alpha_bounds);
    let alpha_bounds = uploaded.get_or_upload(ImageKey::AlphaBounds(number, maps), upload);
    let detail = assets.detail.as_ref().map(|detail| {
        uploaded.get_or_upload(ImageKey::Single(detail.number()), || upload_sprite(gpu, "haze detail", detail, None))
    });
    let noise = &assets.noise;
    let noise = uploaded.get_or_upload(ImageKey::Single(noise.number()), || upload_noise(gpu, noise));
    let ramp =
        |label, ramp: &Ramp| uploaded.get_or_upload(ImageKey::Single(ramp.number()), || upload_ramp(gpu, label, ramp));
    let diffuse_ramp = ramp("haze diffuse_ramp", &assets.diffuse_ramp);
    let soft_scatter_ramp = ramp("haze soft_scatter_ramp", &assets.soft_scatter_ramp);
    let specular_ramp = ramp("haze specular_ramp", &assets.specular_ramp);
    let motif = ramp("haze painted_motif", &assets.motif);
    let age_ramp = ramp("haze age_ramp", &assets.age_ramp);
    let heat_ramp = ramp("haze heat_ramp", &assets.heat_ramp);
    let fire_ramp = ramp("haze fire_ramp", &assets.fire_ramp);
    let coverage_ramp = ramp("haze coverage_ramp", &assets.coverage_ramp);
    let backlight_ramp = ramp("haze backlight_ramp", &assets.backlight_ramp);
    let shadow_ramp = ramp("haze shadow_ramp", &assets.shadow_ramp);
    let texture = |binding, view| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(view) };
    let sampler =
        |binding, sampler| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::Sampler(sampler) };
    let entries = [
        texture(0, &sprite.view),
        texture(1, &diffuse_ramp.view),
        texture(2, &soft_scatter_ramp.view),
        texture(3, &specular_ramp.view),
        texture(4, &motif.view),
        sampler(5, &shared.linear),
        texture(6, detail.as_ref().map_or(&shared.no_detail, |detail| &detail.view)),
        texture(7, &age_ramp.view),
        texture(8, &noise.view),
        sampler(9, &shared.repeat),
        texture(10, &coverage_ramp.view),
        texture(11, &alpha_bounds.view),
        texture(12, &backlight_ramp.view),
        texture(13, &shadow_ramp.view),
        texture(14, &heat_ramp.view),
        texture(15, &fire_ramp.view),
    ];
    let bind = |label, layout, entries: &[wgpu::BindGroupEntry<'_>]| {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries })
    };
    let of_sprites = SPRITE_BINDINGS.map(|binding| entries[binding as usize].clone());
    let lighting = LIGHTING_BINDINGS.map(|binding| entries[binding as usize].clone());
    let bind_group = bind("haze material", &layouts.material, &of_sprites);
    let lighting = bind("haze material lighting", &layouts.lighting, &lighting);
    let mut images = vec![sprite, alpha_bounds, noise];
    images.extend(detail);
    images.extend([diffuse_ramp, soft_scatter_ramp, specular_ramp, motif, age_ramp]);
    images.extend([heat_ramp, fire_ramp, coverage_ramp, backlight_ramp]);
    Ok(Material { context, bind_group, lighting, shadow_ramp, images, info })
}

/// Refuses images that are too large for the device, and six-way maps that do not fit the sprite.
fn validate_sizes(limits: &wgpu::Limits, assets: &MaterialAssets) -> Result<(), FieldError> {
    let check = |name: &str, count: u32, unit: &str, max: u32| {
        if count <= max {
            return Ok(());
        }
        let problem = format!("{count} {unit} are too many");
        Err(FieldError::from_problem(format!("material.{name}"), problem, format!("at most {max} on this device")))
    };
    let side = "texels along a side";
    let flat = limits.max_texture_dimension_2d;
    let max_layers = limits.max_texture_array_layers;
    let ramps = [
        ("diffuse_ramp", &assets.diffuse_ramp),
        ("soft_scatter_ramp", &assets.soft_scatter_ramp),
        ("specular_ramp", &assets.specular_ramp),
        ("motif", &assets.motif),
        ("age_ramp", &assets.age_ramp),
        ("coverage_ramp", &assets.coverage_ramp),
        ("backlight_ramp", &assets.backlight_ramp),
        ("shadow_ramp", &assets.shadow_ramp),
        ("heat_ramp", &assets.heat_ramp),
        ("fire_ramp", &assets.fire_ramp),
    ];
    for (name, ramp) in ramps {
        check(name, ramp.size().max_element(), side, flat)?;
    }
    for (name, sprite) in [("sprite", Some(&assets.sprite)), ("detail", assets.detail.as_ref())] {
        let Some(sprite) = sprite else { continue };
        check(name, sprite.size(), side, flat)?;
        check(name, array_layers(sprite.frame_count()), "frames", max_layers)?;
    }
    if let Some(maps) = &assets.six_way {
        if maps.size() != assets.sprite.size() {
            let problem = format!("the frames have {} texels along a side", maps.size());
            let expected = format!("{}, as the sprite has", assets.sprite.size());
            return Err(FieldError::from_problem("material.six_way", problem, expected));
        }
        let layers = array_layers(assets.sprite.frame_count() + maps.frame_count());
        check("six_way", layers, "frames together with those of the sprite", max_layers)?;
    }
    check("noise", assets.noise.size(), side, limits.max_texture_dimension_3d)
}

pub(crate) fn upload_ramp(gpu: &Gpu<'_>, label: &str, ramp: &Ramp) -> UploadedImage {
    let size = extent(ramp.size(), 1);
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
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
    gpu.queue.write_texture(texture.as_image_copy(), &data, layout(8 * size.width, size.height), size);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    UploadedImage { view, bytes: data.len() as u64 }
}

fn upload_noise(gpu: &Gpu<'_>, noise: &NoiseVolume) -> UploadedImage {
    let size = extent(UVec2::splat(noise.size()), noise.size());
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("haze noise"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D3,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    gpu.queue.write_texture(texture.as_image_copy(), noise.bytes(), layout(4 * size.width, size.height), size);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    UploadedImage { view, bytes: noise.bytes().len() as u64 }
}

/// Uploads a sprite as an array texture with all mip levels. `after`: further frames of the same size, appended.
fn upload_sprite(gpu: &Gpu<'_>, label: &str, sprite: &Sprite, after: Option<&Sprite>) -> UploadedImage {
    let mut bytes = 0;
    let layers = array_layers(sprite.frame_count() + after.map_or(0, Sprite::frame_count));
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
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
        let size = sprite.level_size(level);
        bytes += 4 * u64::from(size) * u64::from(size) * u64::from(layers);
        let mut first = 0;
        for sprite in std::iter::once(sprite).chain(after) {
            let origin = wgpu::Origin3d { z: first, ..wgpu::Origin3d::ZERO };
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo { mip_level: level, origin, ..texture.as_image_copy() },
                sprite.level_bytes(level),
                layout(4 * size, size),
                extent(UVec2::splat(size), sprite.frame_count()),
            );
            first += sprite.frame_count();
        }
    }
    let view = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    UploadedImage { view, bytes }
}

/// Uploads the alpha bounds of a sprite: one texel per mip level and frame.
fn upload_filled(gpu: &Gpu<'_>, alpha_bounds: &AlphaBounds) -> UploadedImage {
    let size = extent(alpha_bounds.size(), 1);
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("haze sprite filled"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let data = alpha_bounds.bytes();
    gpu.queue.write_texture(texture.as_image_copy(), data, layout(16 * size.width, size.height), size);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    UploadedImage { view, bytes: data.len() as u64 }
}

fn extent(size: UVec2, layers: u32) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers }
}

fn layout(bytes_per_row: u32, rows: u32) -> wgpu::TexelCopyBufferLayout {
    wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row), rows_per_image: Some(rows) }
}
