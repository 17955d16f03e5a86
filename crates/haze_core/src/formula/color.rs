//! sRGB encoding, luminance, and the color scale of overdraw. WGSL: `shaders/lib/color.wgsl`.

use glam::Vec3;

use super::saturate;

/// Decodes sRGB, 0..1, to linear. (IEC 61966-2-1)
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Encodes linear light as sRGB, 0..1. (IEC 61966-2-1)
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Luminance of linear RGB. (ITU-R BT.709)
pub fn luminance(light: Vec3) -> f32 {
    light.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Linear light, clamped to 0..1 and encoded as sRGB, for a target whose format the hardware does not encode.
pub fn srgb_color(light: Vec3) -> Vec3 {
    light.clamp(Vec3::ZERO, Vec3::ONE).map(srgb_from_linear)
}

/// Upper limit of light in half floats: half of the largest half float.
pub const MAX_HALF_FLOAT_LIGHT: f32 = 32752.0;

/// Light, limited to what a target of half floats can store.
pub fn bounded_light(light: Vec3) -> Vec3 {
    light.min(Vec3::splat(MAX_HALF_FLOAT_LIGHT))
}

/// Color scale of overdraw: black, blue, green, yellow, red, white at 0, 4, 8, 16, 32, 64 layers.
pub fn overdraw_color(layers: f32) -> Vec3 {
    let heat = if layers > 4.0 { layers.log2() - 1.0 } else { layers * 0.25 };
    let colors = [Vec3::ZERO, Vec3::Z, Vec3::Y, Vec3::new(1.0, 1.0, 0.0), Vec3::X, Vec3::ONE];
    let index = (heat.max(0.0) as usize).min(colors.len() - 2);
    colors[index].lerp(colors[index + 1], saturate(heat - index as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_round_trips() {
        for step in 0..=255 {
            let encoded = step as f32 / 255.0;
            assert!((srgb_from_linear(linear_from_srgb(encoded)) - encoded).abs() < 1e-5);
        }
    }
}
