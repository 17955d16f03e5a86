//! depth_downsample: reduces the scene depth to the resolution of the accumulation target.
//!
//! Reads: scene depth.
//! Writes: reduced depth, Depth32Float, linear view depth divided by `depth_limit`. If the backend cannot test what it
//! samples, also a coarse copy, never nearer than the original. On the path `tiled`, R32Float.
//! Blend: none.
//! Source: OTEE "Transfer & lighting", option 1.

use haze_core::settings::DepthDownsample;

use super::texel_pass::TexelKey;
use crate::renderer::gpu::pipeline::{Constant, bool_constant, enum_constant};
use crate::renderer::targets::{Extent, SystemTextures, Target};

/// A depth format if it is drawn, so that it can be attached and the hardware rejects hidden sprites. Every backend can
/// render to it, which does not hold for `R32Float`. No device can write it by compute shaders.
pub(crate) const REDUCED_DEPTH: Target = Target {
    label: "haze reduced depth",
    extent: Extent::Texels,
    drawn: wgpu::TextureFormat::Depth32Float,
    computed: wgpu::TextureFormat::R32Float,
};

/// Copy that OpenGL tests against. Half the size of the reduced depth, to limit the memory per system. Never computed.
pub(crate) const DEPTH_COPY: Target = Target {
    label: "haze depth copy",
    extent: Extent::Texels,
    drawn: wgpu::TextureFormat::Depth16Unorm,
    computed: wgpu::TextureFormat::R32Float,
};

/// Key of a downsampling pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthDownsampleKey {
    pub mode: DepthDownsample,
}

/// Key of a pipeline of the coarse copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthCopyKey {
    pub mode: DepthDownsample,
}

impl TexelKey for DepthDownsampleKey {
    const PASS: &'static str = "depth_downsample";
    const READS: &'static [wgpu::BindingType] = &[];
    const COMPUTED: &'static [Target] = &[REDUCED_DEPTH];

    fn drawn(self) -> &'static [Target] {
        &[REDUCED_DEPTH]
    }

    fn reads(_: SystemTextures<'_>) -> Vec<&wgpu::TextureView> {
        Vec::new()
    }

    fn constants(self) -> Vec<Constant> {
        vec![enum_constant!("DEPTH_DOWNSAMPLE", self.mode), bool_constant("COARSE_COPY", false)]
    }
}

impl TexelKey for DepthCopyKey {
    const PASS: &'static str = "depth_downsample";
    const READS: &'static [wgpu::BindingType] = &[];
    const COMPUTED: &'static [Target] = &[];

    fn drawn(self) -> &'static [Target] {
        &[DEPTH_COPY]
    }

    fn reads(_: SystemTextures<'_>) -> Vec<&wgpu::TextureView> {
        Vec::new()
    }

    fn constants(self) -> Vec<Constant> {
        vec![enum_constant!("DEPTH_DOWNSAMPLE", self.mode), bool_constant("COARSE_COPY", true)]
    }
}
