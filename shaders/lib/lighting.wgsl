// Lighting of a single point of the smoke. View space, metres, linear color.

#import "lib/color.wgsl"

// Mirrors LightUniform in crates/haze_core/src/formula/uniforms.rs.
struct Light {
    // Point and spot.
    position: vec3f,
    // 1 / range; 0 for directional lights.
    inverse_range: f32,
    // Direction in which the light travels, unit length. Spot and directional.
    direction: vec3f,
    // 1 for directional lights, else 0.
    directional: f32,
    // Color times intensity.
    color: vec3f,
    specular_scatter: f32,
    // Of cone_attenuation. Scale 0, offset 1 for lights without a cone.
    spot_scale: f32,
    spot_offset: f32,
    radius: f32,
    // Channel of the light's optical depths, 1 to 3; 0 for a light without shadow.
    shadow_slot: f32,
}

struct LightSample {
    // Unit vector towards the light.
    direction: vec3f,
    attenuation: f32,
}

// Window of a light's range: 1 at the light, exactly 0 at its range. (Karis, "Real Shading in Unreal Engine 4", 2013,
// eq. 9)
fn range_window(distance_squared: f32, inverse_range: f32) -> f32 {
    let ratio = distance_squared * inverse_range * inverse_range;
    let window = saturate(1.0 - ratio * ratio);
    return window * window;
}

// Inverse-square falloff with distance, windowed to 0 at the range. The light's radius, and at least 1 cm, keep it
// finite close by.
fn distance_attenuation(distance_squared: f32, inverse_range: f32, radius: f32) -> f32 {
    return range_window(distance_squared, inverse_range) / max(distance_squared + radius * radius, 1.0e-4);
}

// Falloff of a spot across its cone: 1 in the core, 0 outside. `direction`: from the light, unit length. Half the squared
// distance of two unit vectors is 1 - cos of the angle between them, and exact in narrow cones too.
fn cone_attenuation(light: Light, direction: vec3f) -> f32 {
    let apart = direction - light.direction;
    let cone = saturate(light.spot_offset - 0.5 * dot(apart, apart) * light.spot_scale);
    return cone * cone;
}

// Direction to the light and its attenuation at `position`.
fn sample_light(light: Light, position: vec3f) -> LightSample {
    if light.directional > 0.5 {
        return LightSample(-light.direction, 1.0);
    }
    let to_light = light.position - position;
    let distance_squared = dot(to_light, to_light);
    let direction = to_light * inverseSqrt(max(distance_squared, 1.0e-8));
    let attenuation = distance_attenuation(distance_squared, light.inverse_range, light.radius);
    return LightSample(direction, attenuation * cone_attenuation(light, -direction));
}

// Lookup coordinate of the diffuse ramp: 0 for a normal that faces away from the light, 1 for one that faces it. (OTEE
// "Diffuse lighting")
fn diffuse_coordinate(normal: vec3f, to_light: vec3f) -> f32 {
    return saturate(dot(normal, to_light) * 0.5 + 0.5);
}

// Unit vector from a point of the smoke to the viewer.
fn direction_to_viewer(position: vec3f, orthographic: f32) -> vec3f {
    if orthographic > 0.5 {
        return vec3f(0.0, 0.0, 1.0);
    }
    return -position * inverseSqrt(max(dot(position, position), 1.0e-12));
}

// Weight of the backlight ramp: 0 for a light on the viewer's side, 1 for a light exactly behind the smoke. Cubed,
// because forward scattering is strongest close to the direction of the light.
fn backlight_weight(to_light: vec3f, to_viewer: vec3f) -> f32 {
    let against = saturate(0.5 - 0.5 * dot(to_light, to_viewer));
    return against * against * against;
}

// Weight of `ambient_color`, 0 in thin smoke and 1 in thick: smoothstep(scatter_amount, scatter_amount +
// scatter_smooth, A), safe at scatter_smooth = 0. (OTEE "Soft scattering")
fn soft_scatter_weight(amount: f32, scatter_amount: f32, scatter_smooth: f32) -> f32 {
    let x = saturate((amount - scatter_amount) / max(scatter_smooth, 1.0e-4));
    return x * x * (3.0 - 2.0 * x);
}

// Fraction of the scene that the smoke hides. (OTEE "Diffuse lighting", col.a)
fn coverage(amount: f32, boost: f32) -> f32 {
    return saturate(amount * boost);
}

// Fraction that a color of a coverage or heat ramp stands for. It is the sRGB code of the color's luminance, so that a
// displayed middle gray is half.
fn painted_fraction(paint: vec3f) -> f32 {
    return srgb_from_linear(saturate(luminance(paint)));
}

// Fraction of the smoke's depth range that lies in front of a light: 0 on its near side, 1 behind its far side. (OTEE
// "Specular scattering": fade out the quad as it goes through the bounding box)
fn specular_scatter_fade(light_depth: f32, smoke_near: f32, smoke_far: f32) -> f32 {
    return saturate((light_depth - smoke_near) / max(smoke_far - smoke_near, 1.0e-4));
}

// Factor of a glow for a light at a distance from the smoke: 1 / distance² to the power of `falloff`, 0 to 1.
fn glow_falloff(distance_squared: f32, radius: f32, falloff: f32) -> f32 {
    return pow(max(distance_squared + radius * radius, 1.0e-4), -falloff);
}

const VISIBILITY_TAPS: u32 = 9u;

// Offset of a visibility tap from the center of a light, pixels: 8 taps on a ring of `radius`, and the center as the
// last.
fn visibility_tap(index: u32, radius: f32) -> vec2f {
    let angle = f32(index) * 0.785398163;
    return select(vec2f(cos(angle), sin(angle)) * radius, vec2f(0.0), index == 8u);
}
