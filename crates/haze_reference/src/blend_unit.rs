//! Emulation of the hardware's blend unit, with its rounding. The blend states are in `src/renderer/gpu/pipeline.rs`.

use glam::{Vec4, Vec4Swizzles};
use half::f16;

use haze_core::settings::{AccumulationFormat, BlendMode};

/// ONE, ONE_MINUS_SRC_ALPHA: rgb' = e·a + rgb·(1 − a) with e·a premultiplied, A' = a + A·(1 − a). (OTEE "AddSmooth")
pub fn premultiplied_over(source: Vec4, target: Vec4) -> Vec4 {
    source + target * (1.0 - source.w)
}

/// ONE, ONE on the normal, ONE, ONE_MINUS_SRC_ALPHA on the amount.
pub fn weighted_sum(source: Vec4, target: Vec4) -> Vec4 {
    (source.xyz() + target.xyz()).extend(source.w + target.w * (1.0 - source.w))
}

/// OTEE's three classic blends of a forward fragment over the image.
pub fn forward_blend(mode: BlendMode, source: Vec4, target: Vec4) -> Vec4 {
    match mode {
        BlendMode::Alpha => premultiplied_over(source, target),
        BlendMode::Additive => (target.xyz() + source.xyz()).extend(target.w),
        BlendMode::Multiply => (target.xyz() * source.xyz()).extend(target.w),
    }
}

/// Rounds to the precision of the accumulation target.
pub fn quantise(format: AccumulationFormat, value: Vec4) -> Vec4 {
    match format {
        AccumulationFormat::Rgba16Float => Vec4::from(value.to_array().map(|channel| f16::from_f32(channel).to_f32())),
        AccumulationFormat::Rgba8Unorm => (value.clamp(Vec4::ZERO, Vec4::ONE) * 255.0).round() / 255.0,
    }
}
