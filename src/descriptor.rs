//! What a renderer must know about the pass it will draw into.

/// Describes the host's pass. All of it is fixed for the life of a [`Renderer`](crate::Renderer).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Descriptor {
    /// Format of the first colour attachment: blendable, linear light. `Rgba16Float` for HDR.
    pub color_format: wgpu::TextureFormat,
    /// Format of the pass's depth attachment, `None` if it has none. The attachment is the scene depth of the frame,
    /// read-only (`depth_ops: None`), because haze samples it too. OpenGL and WebGL2 cannot do both with one
    /// texture: there either hand over a linear target ([`SceneDepth::Both`](crate::SceneDepth::Both)), or say `None`. See
    /// [`read_only_depth_is_supported`].
    pub depth_format: Option<wgpu::TextureFormat>,
    /// Samples per pixel of the pass.
    pub sample_count: u32,
    /// Filter ramps and sprites in the shader in f32 instead of by the sampler: slower, and equal to the reference on
    /// every driver. For tests.
    pub exact_filtering: bool,
}

impl Default for Descriptor {
    fn default() -> Self {
        Self {
            color_format: wgpu::TextureFormat::Rgba16Float,
            depth_format: Some(wgpu::TextureFormat::Depth32Float),
            sample_count: 1,
            exact_filtering: false,
        }
    }
}

/// True if a pass of this device can test and sample one depth buffer. OpenGL and WebGL2 cannot: what is sampled there must
/// be a linear target, or else [`Descriptor::depth_format`] `None`, and the shaders alone hide what is behind the scene.
pub fn read_only_depth_is_supported(device: &wgpu::Device) -> bool {
    device.adapter_info().backend != wgpu::Backend::Gl
}
