//! Response of smoke to light, by its ramps. WGSL: `shaders/lib/response.wgsl`.

use glam::{Vec2, Vec3};

use super::lighting::{coverage, diffuse_coordinate, soft_scatter_weight};
use super::ramp::sample_ramp_2d;
use super::texture::Texture2d;
use crate::settings::RampFilter;

/// Fraction of a light that the smoke sends to the viewer: ramp(dot(n, l) / 2 + 1/2, amount · boost). `against`: as from
/// [`backlight_weight`](super::lighting::backlight_weight), or 0 without a backlight ramp. (OTEE "Diffuse lighting")
pub fn diffuse_response<T: Texture2d>(
    [ramp, ramp_from_behind]: [&T; 2],
    filter: RampFilter,
    normal: Vec3,
    to_light: Vec3,
    covered: f32,
    against: f32,
) -> Vec3 {
    let at = Vec2::new(diffuse_coordinate(normal, to_light), covered);
    let falloff = sample_ramp_2d(ramp, filter, at);
    match against > 0.0 {
        true => falloff.lerp(sample_ramp_2d(ramp_from_behind, filter, at), against),
        false => falloff,
    }
}

/// Even backlight of smoke by its amount: from `scatter_color` in thin smoke to `ambient_color` in thick. (OTEE "Soft
/// scattering")
pub fn soft_scatter_curve(
    amount: f32,
    scatter_color: Vec3,
    ambient_color: Vec3,
    scatter_amount: f32,
    scatter_smooth: f32,
) -> Vec3 {
    scatter_color.lerp(ambient_color, soft_scatter_weight(amount, scatter_amount, scatter_smooth))
}

/// Light that hot smoke gives, per fraction of the scene that all smoke hides. `fire`: as from
/// [`fire_from_moments`](super::fire::fire_from_moments).
pub fn fire_response(ramp: &impl Texture2d, filter: RampFilter, fire: Vec2, amount: f32, boost: f32) -> Vec3 {
    sample_ramp_2d(ramp, filter, Vec2::new(fire.x, coverage(amount * fire.y, boost))) * fire.y
}
