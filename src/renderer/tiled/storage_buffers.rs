//! Creation of buffers and bind groups.

use crate::renderer::layouts::bind_resources;

/// Bytes of a key, index or count.
pub(super) const WORD_BYTES: u64 = 4;

/// Creates a storage buffer of `count` elements of `bytes` bytes each.
pub(super) fn storage(device: &wgpu::Device, name: &str, count: u32, bytes: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(name),
        size: u64::from(count) * bytes,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Creates a buffer for the size of an indirect dispatch, which shaders write.
pub(super) fn workgroups(device: &wgpu::Device, name: &str) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(name),
        size: 3 * WORD_BYTES,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT,
        mapped_at_creation: false,
    })
}

/// Creates a bind group of resources, in the order of its layout.
pub(super) fn bind<'a>(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> wgpu::BindGroup {
    bind_resources(device, "haze tiled", layout, resources)
}
