//! Formats of the host's render pass, which pipelines that draw into it must match.

use haze_core::error::FieldError;

use super::error_scopes::with_error_scopes;
use super::pipeline::read_only_depth;

/// Maximum number of color attachments of a pass.
pub(crate) const MAX_ATTACHMENTS: usize = 8;

/// Formats and sample count of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct HostPass {
    pub color_format: wgpu::TextureFormat,
    pub further: [Option<wgpu::TextureFormat>; MAX_ATTACHMENTS - 1],
    pub further_count: usize,
    pub depth_format: Option<wgpu::TextureFormat>,
    pub sample_count: u32,
}

impl HostPass {
    /// Returns a pass with one color attachment and nothing else.
    pub const fn color_only(color_format: wgpu::TextureFormat) -> Self {
        Self {
            color_format,
            further: [None; MAX_ATTACHMENTS - 1],
            further_count: 0,
            depth_format: None,
            sample_count: 1,
        }
    }

    /// Returns the pass with further color attachments; `None` if there are more than a pass can have.
    pub fn with_further(mut self, formats: &[Option<wgpu::TextureFormat>]) -> Option<Self> {
        self.further.get_mut(..formats.len())?.copy_from_slice(formats);
        self.further_count = formats.len();
        Some(self)
    }

    /// Returns the pass's color targets: the first is blended, the others are not written.
    pub fn color_targets(&self, blend: wgpu::BlendState) -> Vec<Option<wgpu::ColorTargetState>> {
        let first = wgpu::ColorTargetState {
            format: self.color_format,
            blend: Some(blend),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let masked = |format: &Option<wgpu::TextureFormat>| {
            format.map(|format| wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::empty() })
        };
        std::iter::once(Some(first)).chain(self.further[..self.further_count].iter().map(masked)).collect()
    }

    /// Validates the pass: asks wgpu for a minimal pipeline that draws into it.
    ///
    /// # Errors
    /// Names the field of the descriptor that the device does not support.
    pub fn validate(&self, device: &wgpu::Device) -> Result<(), FieldError> {
        let Err(whole) = self.probe(device) else { return Ok(()) };
        let refuse = |field: String, value: String, reason: &str, expected: &str| {
            Err(FieldError::new(field, value, format!("{expected} ({reason})")))
        };
        // Finds the field at fault: tests each one in an otherwise plain pass.
        if let Err(reason) = Self::color_only(self.color_format).probe(device) {
            let expected = "a format that this device can render to and blend, for example Rgba16Float";
            return refuse("color_format".into(), format!("{:?}", self.color_format), &reason, expected);
        }
        let color_only = Self::color_only(wgpu::TextureFormat::Rgba8Unorm);
        if let (Some(format), Err(reason)) =
            (self.depth_format, Self { depth_format: self.depth_format, ..color_only }.probe(device))
        {
            let expected = "a depth format that this device supports, or None";
            return refuse("depth_format".into(), format!("{format:?}"), &reason, expected);
        }
        for (index, &format) in self.further[..self.further_count].iter().enumerate() {
            let one = color_only.with_further(&[format]).map_or(Ok(()), |pass| pass.probe(device));
            if let (Some(format), Err(reason)) = (format, one) {
                let field = format!("other_color_formats[{index}]");
                let expected = "a format that this device can render to as a further attachment";
                return refuse(field, format!("{format:?}"), &reason, expected);
            }
        }
        let expected = "a sample count that this device supports for these formats: 1, or 4 for most";
        refuse("sample_count".into(), self.sample_count.to_string(), &whole, expected)
    }

    fn probe(&self, device: &wgpu::Device) -> Result<(), String> {
        const SOURCE: &str = "
            @vertex fn vertex() -> @builtin(position) vec4f { return vec4f(0.0); }
            @fragment fn fragment() -> @location(0) vec4f { return vec4f(0.0); }";
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("haze pass"),
            source: wgpu::ShaderSource::Wgsl(SOURCE.into()),
        });
        let stage = wgpu::PipelineCompilationOptions::default;
        let pipeline = || {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("haze pass"),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: None,
                    compilation_options: stage(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: self.depth_format.map(|format| read_only_depth(format, wgpu::CompareFunction::Less)),
                multisample: wgpu::MultisampleState { count: self.sample_count, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: None,
                    compilation_options: stage(),
                    targets: &self.color_targets(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        with_error_scopes(device, pipeline).map(drop)
    }
}
