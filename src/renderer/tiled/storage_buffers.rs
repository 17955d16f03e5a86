//! Creation of buffers.

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
