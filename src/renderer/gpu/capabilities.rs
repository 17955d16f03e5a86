//! What backends differ in.

/// True if a pass of this device can test and sample one depth buffer. OpenGL and WebGL2 cannot: what is sampled there must
/// be a linear target, or else [`Descriptor::depth_format`](crate::Descriptor::depth_format) `None`, and the shaders alone hide
/// what is behind the scene.
pub fn read_only_depth_is_supported(device: &wgpu::Device) -> bool {
    device.adapter_info().backend != wgpu::Backend::Gl
}

/// Layers to allocate for a square array texture of `layers`. wgpu's OpenGL backend takes a texture of one layer for a plain
/// one, and a square texture of six, or a multiple, for a cube: neither can then be sampled as an array.
pub(crate) fn array_layers(layers: u32) -> u32 {
    if layers == 1 || layers.is_multiple_of(6) { layers + 1 } else { layers }
}

/// True if a device can blend two targets of 8 bytes at once, as six-way light needs.
pub(crate) fn six_way_is_supported(device: &wgpu::Device) -> bool {
    let limits = device.limits();
    limits.max_color_attachments >= 2 && limits.max_color_attachment_bytes_per_sample >= 16
}

/// True for devices with compute shaders and all that the tiled passes bind: WebGPU's defaults are enough. Not on OpenGL, where
/// compiling them may take longer than wgpu waits for the context, which it then panics about.
pub(crate) fn tiles_are_supported(device: &wgpu::Device) -> bool {
    let limits = device.limits();
    device.adapter_info().backend != wgpu::Backend::Gl
        && limits.max_compute_invocations_per_workgroup >= 256
        && limits.max_compute_workgroup_size_x >= 256
        && limits.max_compute_workgroup_storage_size >= 16384
        && limits.max_storage_buffers_per_shader_stage >= 8
        && limits.max_storage_textures_per_shader_stage >= 4
}
