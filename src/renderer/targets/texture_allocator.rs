//! Creation of target textures.

use haze_core::glam::UVec2;

/// Creates textures and counts their bytes.
pub(super) struct TextureAllocator<'a> {
    pub device: &'a wgpu::Device,
    pub bytes: u64,
    /// `RENDER_ATTACHMENT`, or `STORAGE_BINDING` if compute shaders write the textures. Not both, because not every device
    /// can render to every storage format.
    pub written: wgpu::TextureUsages,
}

impl TextureAllocator<'_> {
    pub fn create(&mut self, label: &str, format: wgpu::TextureFormat, size: UVec2, layers: u32) -> wgpu::Texture {
        let texel = u64::from(format.block_copy_size(None).unwrap_or(16));
        self.bytes += texel * u64::from(size.x) * u64::from(size.y) * u64::from(layers);
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: self.written | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    pub fn create_whole(&mut self, label: &str, format: wgpu::TextureFormat, size: UVec2) -> wgpu::TextureView {
        self.create(label, format, size, 1).create_view(&wgpu::TextureViewDescriptor::default())
    }
}

/// Creates a single texture. `written`: as in [`TextureAllocator`].
pub(crate) fn single_target(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    size: UVec2,
    written: wgpu::TextureUsages,
) -> wgpu::TextureView {
    TextureAllocator { device, bytes: 0, written }.create_whole(label, format, size)
}
