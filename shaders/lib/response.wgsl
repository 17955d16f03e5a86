// Response of smoke to light, by its ramps. All inputs are parameters, so that a material of another engine can use it.

#import "lib/lighting.wgsl"
#import "lib/ramp.wgsl"

const BACKLIGHT_SAME: u32 = 0u;
const BACKLIGHT_RAMP: u32 = 1u;
override BACKLIGHT: u32 = BACKLIGHT_SAME;

// Fraction of a light that the smoke sends to the viewer: ramp(dot(n, l) / 2 + 1/2, amount · boost). `against`: as from
// backlight_weight(). (OTEE "Diffuse lighting")
fn diffuse_response(
    ramp: texture_2d<f32>,
    ramp_from_behind: texture_2d<f32>,
    linear_sampler: sampler,
    normal: vec3f,
    to_light: vec3f,
    covered: f32,
    against: f32,
) -> vec3f {
    let at = vec2f(diffuse_coordinate(normal, to_light), covered);
    var falloff = sample_ramp_2d(ramp, linear_sampler, at);
    if BACKLIGHT == BACKLIGHT_RAMP {
        falloff = mix(falloff, sample_ramp_2d(ramp_from_behind, linear_sampler, at), against);
    }
    return falloff;
}

// Even backlight of smoke by its amount: from `scatter_color` in thin smoke to `ambient_color` in thick. (OTEE "Soft
// scattering")
fn soft_scatter_curve(
    amount: f32,
    scatter_color: vec3f,
    ambient_color: vec3f,
    scatter_amount: f32,
    scatter_smooth: f32,
) -> vec3f {
    return mix(scatter_color, ambient_color, soft_scatter_weight(amount, scatter_amount, scatter_smooth));
}

// Light that hot smoke gives, per fraction of the scene that all smoke hides. `fire`: as from fire_from_moments().
fn fire_response(ramp: texture_2d<f32>, linear_sampler: sampler, fire: vec2f, amount: f32, boost: f32) -> vec3f {
    return sample_ramp_2d(ramp, linear_sampler, vec2f(fire.x, coverage(amount * fire.y, boost))) * fire.y;
}
