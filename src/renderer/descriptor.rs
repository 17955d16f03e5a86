//! Description of a renderer and of the host's render pass.

use haze_core::error::FieldError;

use super::gpu::host_pass::{HostPass, MAX_ATTACHMENTS};

/// Describes the host's render pass. All fields are fixed for the lifetime of a [`Renderer`](crate::Renderer).
#[derive(Clone, Copy, Debug)]
pub struct RendererDescriptor<'a> {
    /// Format of the view that is the first color attachment. It must be blendable. haze writes linear light: use
    /// `Rgba16Float` for HDR. If the texture holds sRGB-encoded values (`Rgba8Unorm`, `Bgra8Unorm`), attach a view in the
    /// format that ends in `Srgb`, so that the hardware blends linear light.
    pub color_format: wgpu::TextureFormat,
    /// Formats of the pass's further color attachments (velocity, object IDs …), in order, at most 7; `None` for an
    /// unused index. haze does not write to them.
    pub other_color_formats: &'a [Option<wgpu::TextureFormat>],
    /// Format of the pass's depth attachment, `None` if it has none.
    ///
    /// The attachment is the frame's scene depth. It must be read-only (`depth_ops: None`), because haze samples it
    /// too. OpenGL and WebGL2 cannot test and sample one texture in the same pass: there, supply a linear target
    /// ([`SceneDepth::BufferAndLinear`](crate::SceneDepth::BufferAndLinear)) or set `None`. See
    /// [`read_only_depth_is_supported`](crate::read_only_depth_is_supported). A multisampled host attaches its
    /// depth buffer and supplies the same as [`SceneDepth::Multisampled`](crate::SceneDepth::Multisampled).
    pub depth_format: Option<wgpu::TextureFormat>,
    /// Samples per pixel of the pass: 1, or a count that the device supports for these formats.
    pub sample_count: u32,
    /// Format of the first color attachment of the pass in which
    /// [`render_scene_shadow`](crate::Renderer::render_scene_shadow) darkens the scene, if it is another pass than that of
    /// the smoke: one with this attachment alone, and the same depth and samples. `None`: the same pass.
    pub scene_color_format: Option<wgpu::TextureFormat>,
    /// Filters ramps and sprites in the shader in f32 instead of by the sampler: slower, but equal to the CPU reference
    /// on every driver. Intended for tests. Samplers quantize filter weights to 1/256; without exact filtering, thin
    /// smoke under light intensities of 1000 and more differs slightly from the reference in up to 0.3 % of the pixels.
    pub exact_filtering: bool,
}

impl Default for RendererDescriptor<'_> {
    fn default() -> Self {
        Self {
            color_format: wgpu::TextureFormat::Rgba16Float,
            other_color_formats: &[],
            depth_format: Some(wgpu::TextureFormat::Depth32Float),
            sample_count: 1,
            scene_color_format: None,
            exact_filtering: false,
        }
    }
}

impl RendererDescriptor<'_> {
    /// Returns the pass.
    ///
    /// # Errors
    /// Names the field that the device does not support.
    pub(crate) fn host_pass(&self, device: &wgpu::Device) -> Result<HostPass, FieldError> {
        let pass = HostPass {
            depth_format: self.depth_format,
            sample_count: self.sample_count,
            ..HostPass::color_only(self.color_format)
        };
        let Some(pass) = pass.with_further(self.other_color_formats) else {
            let problem = format!("{} formats are too many", self.other_color_formats.len());
            let expected = format!("at most {}", MAX_ATTACHMENTS - 1);
            return Err(FieldError::from_problem("other_color_formats", problem, expected));
        };
        pass.validate(device)?;
        Ok(pass)
    }

    /// Returns the pass that darkens the scene. `host`: the other one.
    ///
    /// # Errors
    /// Names the format that the device does not support.
    pub(crate) fn scene_pass(&self, host: HostPass, device: &wgpu::Device) -> Result<HostPass, FieldError> {
        let Some(format) = self.scene_color_format else { return Ok(host) };
        let HostPass { depth_format, sample_count, .. } = host;
        let pass = HostPass { depth_format, sample_count, ..HostPass::color_only(format) };
        pass.validate(device).map_err(|mut error| {
            error.field = "scene_color_format".into();
            error
        })?;
        Ok(pass)
    }
}
