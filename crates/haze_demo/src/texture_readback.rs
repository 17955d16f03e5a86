//! Asynchronous readback of textures from the GPU.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{UVec2, Vec4};
use half::f16;

use haze_core::assets::image::Image;

/// Pending readback of several textures through one buffer.
#[derive(Clone, Debug)]
pub(super) struct TextureReadback {
    pub regions: Vec<BufferRegion>,
    bytes: Arc<Mutex<Option<Vec<u8>>>>,
}

/// Pending readback of one image.
#[derive(Clone, Debug)]
pub struct PendingImage(TextureReadback);

impl PendingImage {
    /// Records a copy of a color texture.
    pub(super) fn record(device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) -> Self {
        Self(TextureReadback::record(device, encoder, &[texture]))
    }

    /// True once the readback has finished or failed. Progresses only when the device is polled or work is submitted.
    pub fn is_finished(&self) -> bool {
        self.0.is_finished()
    }

    /// Takes the image. Returns `None` if the readback has not finished or has failed, and on every call after the first
    /// success.
    pub fn take(&self) -> Option<Image<Vec4>> {
        let bytes = self.0.take()?;
        let region = self.0.regions.first()?;
        Some(region.colors(&bytes, 0, region.size()))
    }
}

/// Location of one texture in the buffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct BufferRegion {
    format: wgpu::TextureFormat,
    size: wgpu::Extent3d,
    offset: u64,
}

impl BufferRegion {
    /// Returns the size of a layer, texels.
    pub fn size(&self) -> UVec2 {
        UVec2::new(self.size.width, self.size.height)
    }

    fn texel_size(&self) -> u32 {
        self.format.block_copy_size(None).unwrap_or(4)
    }

    fn bytes_per_row(&self) -> u32 {
        (self.size.width * self.texel_size()).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
    }

    fn bytes(&self) -> u64 {
        u64::from(self.bytes_per_row()) * u64::from(self.size.height) * u64::from(self.size.depth_or_array_layers)
    }

    /// Decodes the upper left `size` texels of a layer.
    fn read<T: Copy + Send>(
        &self,
        bytes: &[u8],
        layer: u32,
        size: UVec2,
        zero: T,
        texel: impl Fn(&[u8]) -> T + Sync,
    ) -> Image<T> {
        let row = self.bytes_per_row() as usize;
        let step = self.texel_size() as usize;
        let mut image = Image::new(size, zero);
        let first = self.offset as usize + layer as usize * row * self.size.height as usize;
        image.for_each(|at, out| {
            let start = first + at.y as usize * row + at.x as usize * step;
            if let Some(bytes) = bytes.get(start..start + step) {
                *out = texel(bytes);
            }
        });
        image
    }

    /// Decodes a color texture: four channels of 8 or 16 bits, or one of 16 or 32 bits.
    pub fn colors(&self, bytes: &[u8], layer: u32, size: UVec2) -> Image<Vec4> {
        let half = |texel: &[u8], channel: usize| {
            texel.get(2 * channel..2 * channel + 2).map_or(0.0, |b| f16::from_le_bytes([b[0], b[1]]).to_f32())
        };
        self.read(bytes, layer, size, Vec4::ZERO, |texel| match self.format {
            wgpu::TextureFormat::Rgba8Unorm => {
                Vec4::from([0, 1, 2, 3].map(|channel| f32::from(texel[channel]) / 255.0))
            }
            wgpu::TextureFormat::R32Float => Vec4::ZERO.with_x(read_f32(texel)),
            _ => Vec4::from([0, 1, 2, 3].map(|channel| half(texel, channel))),
        })
    }

    pub fn depths(&self, bytes: &[u8], size: UVec2) -> Image<f32> {
        self.read(bytes, 0, size, 0.0, read_f32)
    }
}

/// Decodes an f32.
fn read_f32(texel: &[u8]) -> f32 {
    f32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]])
}

impl TextureReadback {
    /// Records copies of textures into a new buffer, which is mapped when the encoder's commands have run.
    pub fn record(device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, textures: &[&wgpu::Texture]) -> Self {
        let mut regions = Vec::new();
        let mut offset = 0;
        for texture in textures {
            let region = BufferRegion { format: texture.format(), size: texture.size(), offset };
            offset += region.bytes();
            regions.push(region);
        }
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("demo copies"),
            size: offset,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        for (texture, region) in textures.iter().zip(&regions) {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: region.offset,
                bytes_per_row: Some(region.bytes_per_row()),
                rows_per_image: Some(region.size.height),
            };
            let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
            encoder.copy_texture_to_buffer(texture.as_image_copy(), target, region.size);
        }
        let bytes = Arc::new(Mutex::new(None));
        let shared_bytes = bytes.clone();
        let mapped = buffer.clone();
        encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |result| {
            // Empty on failure, so that `is_finished` still becomes true.
            let view = if result.is_ok() { mapped.get_mapped_range(..).ok() } else { None };
            let bytes = view.map(|view| view.to_vec()).unwrap_or_default();
            *shared_bytes.lock().unwrap_or_else(PoisonError::into_inner) = Some(bytes);
            mapped.unmap();
        });
        Self { regions, bytes }
    }

    /// True once the readback has finished or failed. Progresses only when the device is polled or work is submitted.
    pub fn is_finished(&self) -> bool {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Takes the bytes. Returns `None` if the readback has not finished or has failed, and on every call after the
    /// first success.
    pub fn take(&self) -> Option<Vec<u8>> {
        let bytes = self.bytes.lock().unwrap_or_else(PoisonError::into_inner).take()?;
        let all = self.regions.last().map_or(0, |region| region.offset + region.bytes());
        (bytes.len() as u64 >= all).then_some(bytes)
    }
}
