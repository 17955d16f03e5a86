//! The light of one point of the smoke. `shaders/lib/lighting.wgsl`.

use glam::{Vec2, Vec3};

use super::colour::{luminance, srgb_from_linear};
use super::saturate;
use super::uniforms::LightUniform;

/// Direction to a light, and what is left of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Multiplies the light's colour.
    pub attenuation: f32,
}

/// 1 at a light, exactly 0 at its range. (Karis, "Real Shading in Unreal Engine 4", 2013, eq. 9)
pub fn range_window(distance_squared: f32, inverse_range: f32) -> f32 {
    let ratio = distance_squared * inverse_range * inverse_range;
    let window = saturate(1.0 - ratio * ratio);
    window * window
}

/// Inverse square, softened inside the light's body or the last centimetre, windowed to 0 at the range.
pub fn distance_attenuation(distance_squared: f32, inverse_range: f32, radius: f32) -> f32 {
    range_window(distance_squared, inverse_range) / (distance_squared + radius * radius).max(1.0e-4)
}

/// Direction to the light and what is left of it at `position`, view space.
pub fn sample_light(light: &LightUniform, position: Vec3) -> LightSample {
    if light.directional > 0.5 {
        return LightSample { direction: -light.direction, attenuation: 1.0 };
    }
    let to_light = light.position - position;
    let distance_squared = to_light.length_squared();
    let direction = to_light / distance_squared.max(1.0e-8).sqrt();
    let cone = saturate((-direction).dot(light.direction) * light.spot_scale + light.spot_offset);
    let attenuation = distance_attenuation(distance_squared, light.inverse_range, light.radius) * cone * cone;
    LightSample { direction, attenuation }
}

/// Where a normal looks into the diffuse ramp: 0 facing away from the light, 1 facing it. (OTEE "Diffuse lighting")
pub fn diffuse_coordinate(normal: Vec3, to_light: Vec3) -> f32 {
    saturate(normal.dot(to_light) * 0.5 + 0.5)
}

/// The way to the viewer from a point of the smoke, view space.
pub fn direction_to_viewer(position: Vec3, orthographic: f32) -> Vec3 {
    if orthographic > 0.5 { Vec3::Z } else { -position / position.length_squared().max(1.0e-12).sqrt() }
}

/// How far a light shines from behind: 0 from the viewer's side, 1 straight against it. Cubed: smoke that scatters onwards glows
/// near the light most of all.
pub fn backlight_weight(to_light: Vec3, to_viewer: Vec3) -> f32 {
    let against = saturate(0.5 - 0.5 * to_light.dot(to_viewer));
    against * against * against
}

/// 0 in thin smoke, 1 in thick: smoothstep(scatter_amount, scatter_amount + scatter_smooth, A).
/// (OTEE "Soft scattering")
pub fn soft_scatter_weight(amount: f32, scatter_amount: f32, scatter_smooth: f32) -> f32 {
    let x = saturate((amount - scatter_amount) / scatter_smooth.max(1.0e-4));
    x * x * (3.0 - 2.0 * x)
}

/// How much of the scene the smoke hides. (OTEE "Diffuse lighting", col.a)
pub fn coverage(amount: f32, boost: f32) -> f32 {
    saturate(amount * boost)
}

/// How much of the scene smoke hides where the coverage ramp is this light. Paint is read as it looks, the sRGB code of its
/// luminance: grey in the middle hides half.
pub fn painted_coverage(paint: Vec3) -> f32 {
    srgb_from_linear(saturate(luminance(paint)))
}

/// How much of the box, by view depth, lies in front of a light. (OTEE "Specular scattering")
pub fn specular_scatter_fade(light_depth: f32, smoke_near: f32, smoke_far: f32) -> f32 {
    saturate((light_depth - smoke_near) / (smoke_far - smoke_near).max(1.0e-4))
}

/// Taps of [`visibility_tap`].
pub const VISIBILITY_TAPS: u32 = 9;

/// Where a light's body is looked for, from its middle: a ring of 8 taps at its radius, and the middle.
pub fn visibility_tap(index: u32, radius: f32) -> Vec2 {
    if index == 8 { Vec2::ZERO } else { Vec2::from_angle(index as f32 * std::f32::consts::FRAC_PI_4) * radius }
}
