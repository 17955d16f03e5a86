//! Types of bindings, and bind groups of them.

use std::num::NonZeroU64;

/// A 2D texture that is read through a sampler.
pub(crate) const FILTERED: wgpu::BindingType = texture(true, wgpu::TextureViewDimension::D2);

/// A 2D texture whose texels are loaded: a depth buffer or any other.
pub(crate) const LOADED: wgpu::BindingType = texture(false, wgpu::TextureViewDimension::D2);

pub(crate) const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

/// A storage buffer that shaders read.
pub(crate) const READ_BUFFER: wgpu::BindingType = storage_buffer(true);

/// A storage buffer that shaders write.
pub(crate) const WRITTEN_BUFFER: wgpu::BindingType = storage_buffer(false);

/// Returns the type of a texture of floats that is not multisampled.
pub(crate) const fn texture(filterable: bool, view_dimension: wgpu::TextureViewDimension) -> wgpu::BindingType {
    let sample_type = wgpu::TextureSampleType::Float { filterable };
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

/// Returns the type of a texture that compute shaders write.
pub(crate) const fn written_texture(
    format: wgpu::TextureFormat,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::StorageTexture { access: wgpu::StorageTextureAccess::WriteOnly, format, view_dimension }
}

/// Returns the type of a uniform block of `bytes` bytes.
pub(crate) const fn uniform(bytes: usize) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(bytes as u64),
    }
}

const fn storage_buffer(read_only: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// Creates the layout of a bind group. `types`: by binding, from 0.
pub(crate) fn bind_group_layout(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    types: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let entries: Vec<_> = (0..).zip(types).map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Creates a bind group of resources, in the order of its layout.
pub(crate) fn bind_resources<'a>(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>,
) -> wgpu::BindGroup {
    let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
    let entries: Vec<_> = (0..).zip(resources).map(entry).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}
