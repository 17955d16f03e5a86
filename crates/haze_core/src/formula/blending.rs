//! Output of lit smoke to the blend unit. WGSL: `shaders/lib/blending.wgsl`.

use glam::{Vec3, Vec4};

use crate::settings::BlendMode;

/// Output of a forward fragment: premultiplied for alpha and additive, a filter color for multiply.
pub fn forward_fragment(mode: BlendMode, light: Vec3, coverage: f32) -> Vec4 {
    match mode {
        BlendMode::Alpha => light.extend(1.0) * coverage,
        BlendMode::Additive => (light * coverage).extend(0.0),
        BlendMode::Multiply => Vec3::ONE.lerp(light.min(Vec3::ONE), coverage).extend(1.0),
    }
}

/// Output of a pixel of deferred smoke, premultiplied: its light, and the fraction of the scene that it hides.
pub fn deferred_fragment(is_additive: bool, light: Vec3, coverage: f32) -> Vec4 {
    let hidden = if is_additive { 0.0 } else { coverage };
    (light * coverage).extend(hidden)
}
