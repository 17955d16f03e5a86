//! Creation of target textures.

use glam::UVec2;

/// Creates textures and counts their bytes.
pub(super) struct TextureAllocator<'a> {
    pub device: &'a wgpu::Device,
    pub bytes: u64,
    /// True if compute shaders write the textures. They are then not render attachments, because not every device can
    /// render to every storage format.
    pub storage: bool,
}

impl TextureAllocator<'_> {
    pub fn create(&mut self, label: &str, format: wgpu::TextureFormat, size: UVec2, layers: u32) -> wgpu::Texture {
        let texel = u64::from(format.block_copy_size(None).unwrap_or(16));
        self.bytes += texel * u64::from(size.x) * u64::from(size.y) * u64::from(layers);
        let written = match self.storage {
            true => wgpu::TextureUsages::STORAGE_BINDING,
            false => wgpu::TextureUsages::RENDER_ATTACHMENT,
        };
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: written | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    pub fn create_whole(&mut self, label: &str, format: wgpu::TextureFormat, size: UVec2) -> wgpu::TextureView {
        self.create(label, format, size, 1).create_view(&wgpu::TextureViewDescriptor::default())
    }
}

/// Creates a single depth buffer.
pub(crate) fn depth_target(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    size: UVec2,
) -> wgpu::TextureView {
    TextureAllocator { device, bytes: 0, storage: false }.create_whole(label, format, size)
}

/// Creates a single texture that compute shaders write.
pub(crate) fn storage_target(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    size: UVec2,
) -> wgpu::TextureView {
    TextureAllocator { device, bytes: 0, storage: true }.create_whole(label, format, size)
}
