//! Second image of a comparison: another shot, or an image that was rendered elsewhere.

use std::sync::Arc;

use eframe::wgpu;
use glam::Vec4;
use haze_core::assets::image::Image;
use haze_core::formula::tonemap::DisplayTransform;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::display_transform;

use super::cached_render::{Target, reduced};

/// Second image of a comparison.
#[derive(Clone)]
pub enum ComparisonImage {
    Shot(Box<Shot>),
    /// Image rendered elsewhere, and how it is shown.
    Image(Arc<Image<Vec4>>, DisplayTransform),
}

/// Texture of an image that was rendered elsewhere.
pub struct UploadedImage {
    image: Arc<Image<Vec4>>,
    pub texture: wgpu::Texture,
}

impl ComparisonImage {
    /// Returns it at the reduced resolution that is used while something moves.
    pub fn reduced(&self, divisor: u32) -> Self {
        match self {
            Self::Shot(shot) => Self::Shot(Box::new(reduced(shot, divisor))),
            Self::Image(image, transform) => Self::Image(image.clone(), *transform),
        }
    }

    pub fn transform(&self) -> DisplayTransform {
        match self {
            Self::Shot(shot) => display_transform(shot),
            Self::Image(_, transform) => *transform,
        }
    }
}

impl UploadedImage {
    /// Uploads an image, or drops the texture if there is none. Returns true if the texture was replaced.
    pub fn sync_upload(uploaded: &mut Option<Self>, target: &Target<'_>, image: Option<&Arc<Image<Vec4>>>) -> bool {
        let is_up = match (&*uploaded, image) {
            (Some(uploaded), Some(image)) => Arc::ptr_eq(&uploaded.image, image),
            (None, None) => true,
            _ => false,
        };
        if !is_up {
            *uploaded = image.map(|image| Self { texture: upload(target, image), image: image.clone() });
        }
        !is_up
    }
}

/// Uploads a linear HDR image as half floats.
fn upload(target: &Target<'_>, image: &Image<Vec4>) -> wgpu::Texture {
    let size = wgpu::Extent3d { width: image.size.x, height: image.size.y, depth_or_array_layers: 1 };
    let texture = target.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("made image"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let texels: Vec<_> = image.texels.iter().flat_map(|texel| texel.to_array().map(half::f16::from_f32)).collect();
    let bytes: Vec<_> = texels.iter().flat_map(|channel| channel.to_le_bytes()).collect();
    let rows = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * size.width), rows_per_image: None };
    target.queue.write_texture(texture.as_image_copy(), &bytes, rows, size);
    texture
}
