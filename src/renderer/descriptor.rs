//! The pass that a renderer will draw into.

use super::context::Context;
use super::gpu::host_pass::{HostPass, MAX_ATTACHMENTS};
use crate::error::FieldError;

/// Describes a renderer: the host's pass, and what it shares with other renderers. All of it is fixed for the life of a
/// [`Renderer`](crate::Renderer).
#[derive(Clone, Copy, Debug)]
pub struct Descriptor<'a> {
    /// What is shared with the renderers of other views; `None` for a context of its own.
    pub context: Option<&'a Context>,
    /// Format of the first colour attachment: blendable. `Rgba16Float` for HDR.
    pub color_format: wgpu::TextureFormat,
    /// Formats of the pass's further colour attachments (velocity, object numbers …), in order; `None` for a hole. haze leaves
    /// them as they are.
    pub further_color_formats: &'a [Option<wgpu::TextureFormat>],
    /// Format of the pass's depth attachment, `None` if it has none. The attachment is the scene depth of the frame,
    /// read-only (`depth_ops: None`), because haze samples it too. OpenGL and WebGL2 cannot do both with one
    /// texture: there either hand over a linear target ([`SceneDepth::Both`](crate::SceneDepth::Both)), or say `None`. See
    /// [`read_only_depth_is_supported`](crate::read_only_depth_is_supported). The passes of a multisampled host test the
    /// multisampled buffer and hand over a resolved one.
    pub depth_format: Option<wgpu::TextureFormat>,
    /// Samples per pixel of the pass.
    pub sample_count: u32,
    /// True where the first attachment holds sRGB code and the hardware does not know it: an `Rgba8Unorm` picture that is
    /// shown as it is. haze then writes code, clamped to 0..1, and blends code. Leave it false for linear light, and for
    /// formats that end in `Srgb`, which encode by themselves.
    pub gamma_target: bool,
    /// Filter ramps and sprites in the shader in f32 instead of by the sampler: slower, and equal to the reference on
    /// every driver. For tests. Samplers weigh texels in steps of 1/256, so without it thin smoke under lights of 1000 and more is
    /// a little off in up to 0.3 % of the pixels.
    pub exact_filtering: bool,
}

impl Default for Descriptor<'_> {
    fn default() -> Self {
        Self {
            context: None,
            color_format: wgpu::TextureFormat::Rgba16Float,
            further_color_formats: &[],
            depth_format: Some(wgpu::TextureFormat::Depth32Float),
            sample_count: 1,
            gamma_target: false,
            exact_filtering: false,
        }
    }
}

impl Descriptor<'_> {
    /// The pass, if the device can have one like it.
    pub(crate) fn host_pass(&self, device: &wgpu::Device) -> Result<HostPass, FieldError> {
        let pass = HostPass {
            depth_format: self.depth_format,
            sample_count: self.sample_count,
            gamma_target: self.gamma_target,
            ..HostPass::plain(self.color_format)
        };
        let Some(pass) = pass.with_further(self.further_color_formats) else {
            let value = format!("{} formats", self.further_color_formats.len());
            let expected = format!("at most {}", MAX_ATTACHMENTS - 1);
            return Err(FieldError::new("further_color_formats", value, expected));
        };
        if self.gamma_target && self.color_format.is_srgb() {
            let expected = "false for a format that encodes by itself";
            return Err(FieldError::new("gamma_target", "true", expected));
        }
        pass.validate(device)?;
        Ok(pass)
    }
}
