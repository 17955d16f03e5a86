//! Capabilities in which devices and backends differ.

/// Returns true if a pass of this device can test and sample the same depth buffer. OpenGL and WebGL2 cannot: there,
/// supply a linear target to sample, or set [`RendererDescriptor::depth_format`](crate::RendererDescriptor::depth_format) to `None`, so
/// that only the shaders hide smoke behind the scene.
pub fn read_only_depth_is_supported(device: &wgpu::Device) -> bool {
    device.adapter_info().backend != wgpu::Backend::Gl
}

/// Returns the number of layers to allocate for a square array texture of `layers`. wgpu's OpenGL backend creates a
/// plain texture for one layer, and a cube for a square texture of six layers or a multiple of six; neither can be
/// sampled as an array. One more layer avoids both.
pub(crate) fn array_layers(layers: u32) -> u32 {
    if layers == 1 || layers.is_multiple_of(6) { layers + 1 } else { layers }
}

/// Returns true if a device can blend two targets of 8 bytes per texel in one pass, which six-way lighting needs.
pub(crate) fn six_way_is_supported(device: &wgpu::Device) -> bool {
    let limits = device.limits();
    limits.max_color_attachments >= 2 && limits.max_color_attachment_bytes_per_sample >= 16
}

/// Returns true if a device can blend the targets of one pass in different ways. WebGL 2 cannot.
pub(crate) fn independent_blend_is_supported(device: &wgpu::Device) -> bool {
    !cfg!(target_arch = "wasm32") || device.adapter_info().backend != wgpu::Backend::Gl
}

/// Returns true if a device has compute shaders and the limits that the tiled passes need: WebGPU's defaults suffice.
/// False on OpenGL, where compiling these shaders can exceed the time that wgpu waits for the context, after which wgpu
/// panics.
pub(crate) fn tiles_are_supported(device: &wgpu::Device) -> bool {
    let limits = device.limits();
    device.adapter_info().backend != wgpu::Backend::Gl
        && limits.max_compute_invocations_per_workgroup >= 256
        && limits.max_compute_workgroup_size_x >= 256
        && limits.max_compute_workgroup_storage_size >= 16384
        && limits.max_storage_buffers_per_shader_stage >= 8
        && limits.max_storage_textures_per_shader_stage >= 4
}
