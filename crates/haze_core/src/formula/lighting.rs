//! Lighting of a single point of the smoke. WGSL: `shaders/lib/lighting.wgsl`.

use glam::{Vec2, Vec3};

use super::color::{luminance, srgb_from_linear};
use super::saturate;
use super::uniforms::LightUniform;

/// Direction to a light, and its attenuation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Multiplies the light's color.
    pub attenuation: f32,
}

/// Window of a light's range: 1 at the light, exactly 0 at its range. (Karis, "Real Shading in Unreal Engine 4", 2013,
/// eq. 9)
pub fn range_window(distance_squared: f32, inverse_range: f32) -> f32 {
    let ratio = distance_squared * inverse_range * inverse_range;
    let window = saturate(1.0 - ratio * ratio);
    window * window
}

/// Inverse-square falloff with distance, windowed to 0 at the range. The light's radius, and at least 1 cm, keep it
/// finite close by.
pub fn distance_attenuation(distance_squared: f32, inverse_range: f32, radius: f32) -> f32 {
    range_window(distance_squared, inverse_range) / (distance_squared + radius * radius).max(1.0e-4)
}

/// Falloff of a spot across its cone: 1 in the core, 0 outside. `direction`: from the light, unit length. Half the squared
/// distance of two unit vectors is 1 - cos of the angle between them, and exact in narrow cones too.
pub fn cone_attenuation(light: &LightUniform, direction: Vec3) -> f32 {
    let apart = direction - light.direction;
    let cone = saturate(light.spot_offset - 0.5 * apart.length_squared() * light.spot_scale);
    cone * cone
}

/// Direction to the light and its attenuation at `position`, view space.
pub fn sample_light(light: &LightUniform, position: Vec3) -> LightSample {
    if light.directional > 0.5 {
        return LightSample { direction: -light.direction, attenuation: 1.0 };
    }
    let to_light = light.position - position;
    let distance_squared = to_light.length_squared();
    let direction = to_light / distance_squared.max(1.0e-8).sqrt();
    let attenuation = distance_attenuation(distance_squared, light.inverse_range, light.radius);
    LightSample { direction, attenuation: attenuation * cone_attenuation(light, -direction) }
}

/// Lookup coordinate of the diffuse ramp: 0 for a normal that faces away from the light, 1 for one that faces it. (OTEE
/// "Diffuse lighting")
pub fn diffuse_coordinate(normal: Vec3, to_light: Vec3) -> f32 {
    saturate(normal.dot(to_light) * 0.5 + 0.5)
}

/// Unit vector from a point of the smoke to the viewer, view space.
pub fn direction_to_viewer(position: Vec3, orthographic: f32) -> Vec3 {
    if orthographic > 0.5 { Vec3::Z } else { -position / position.length_squared().max(1.0e-12).sqrt() }
}

/// Weight of the backlight ramp: 0 for a light on the viewer's side, 1 for a light exactly behind the smoke. Cubed,
/// because forward scattering is strongest close to the direction of the light.
pub fn backlight_weight(to_light: Vec3, to_viewer: Vec3) -> f32 {
    let against = saturate(0.5 - 0.5 * to_light.dot(to_viewer));
    against * against * against
}

/// Weight of `ambient_color`, 0 in thin smoke and 1 in thick: smoothstep(scatter_amount, scatter_amount +
/// scatter_smooth, A). (OTEE "Soft scattering")
pub fn soft_scatter_weight(amount: f32, scatter_amount: f32, scatter_smooth: f32) -> f32 {
    let x = saturate((amount - scatter_amount) / scatter_smooth.max(1.0e-4));
    x * x * (3.0 - 2.0 * x)
}

/// Fraction of the scene that the smoke hides, 0..1. (OTEE "Diffuse lighting", col.a)
pub fn coverage(amount: f32, boost: f32) -> f32 {
    saturate(amount * boost)
}

/// Fraction that a color of a coverage or heat ramp stands for. It is the sRGB code of the color's luminance, so that a
/// displayed middle gray is half.
pub fn painted_fraction(paint: Vec3) -> f32 {
    srgb_from_linear(saturate(luminance(paint)))
}

/// Fraction of the smoke's depth range that lies in front of a light: 0 on its near side, 1 behind its far side. (OTEE
/// "Specular scattering")
pub fn specular_scatter_fade(light_depth: f32, smoke_near: f32, smoke_far: f32) -> f32 {
    saturate((light_depth - smoke_near) / (smoke_far - smoke_near).max(1.0e-4))
}

/// Factor of a glow for a light at a distance from the smoke: 1 / distance² to the power of `falloff`, 0 to 1.
pub fn glow_falloff(distance_squared: f32, radius: f32, falloff: f32) -> f32 {
    (distance_squared + radius * radius).max(1.0e-4).powf(-falloff)
}

/// Number of taps of [`visibility_tap`].
pub const VISIBILITY_TAPS: u32 = 9;

/// Offset of a visibility tap from the center of a light, pixels: 8 taps on a ring of `radius`, and the center as the
/// last.
pub fn visibility_tap(index: u32, radius: f32) -> Vec2 {
    if index == 8 { Vec2::ZERO } else { Vec2::from_angle(index as f32 * std::f32::consts::FRAC_PI_4) * radius }
}
