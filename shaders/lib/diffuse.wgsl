// Lighting of smoke, shared by transfer, forward and diffuse_bake.

#import "lib/bindings.wgsl"
#import "lib/ramp.wgsl"
#import "lib/six_way.wgsl"
#import "lib/shadow.wgsl"

const SOFT_SCATTER_MODE_SMOOTHSTEP: u32 = 0u;
const SOFT_SCATTER_MODE_RAMP: u32 = 1u;
override SOFT_SCATTER_MODE: u32 = SOFT_SCATTER_MODE_SMOOTHSTEP;

const BACKLIGHT_SAME: u32 = 0u;
const BACKLIGHT_RAMP: u32 = 1u;
override BACKLIGHT: u32 = BACKLIGHT_SAME;

// Smoke and scene between a point of the smoke and the lights with shadow.
struct Shade {
    // Of other smoke.
    optical_depths: vec3f,
    // Share of each light that comes past the scene.
    visible: vec3f,
}

// Share of a light that comes past the scene and through the smoke before it.
fn shadow_on_light(slot: f32, shade: Shade, to_light: vec3f, to_viewer: vec3f) -> vec3f {
    if !SHADOW || slot < 0.5 {
        return vec3f(1.0);
    }
    let at = shadow_position(of_slot(slot, shade.optical_depths), to_light, to_viewer);
    let through = mix(vec3f(1.0), sample_ramp_2d(shadow_ramp, linear_sampler, at), system.shadow_strength);
    return through * of_slot(slot, shade.visible);
}

// Sum of all lights through the diffuse ramp: ramp(dot(n, l) / 2 + 1/2, amount · boost) · color · attenuation. (OTEE
// "Diffuse lighting")
fn diffuse_from_lights(normal: vec3f, covered: f32, position: vec3f, shade: Shade) -> vec3f {
    let to_viewer = direction_to_viewer(position, view.orthographic);
    var sum = vec3f(0.0);
    for (var i = 0u; i < system.light_count; i++) {
        let light = sample_light(lights[i], position);
        let at = vec2f(diffuse_coordinate(normal, light.direction), covered);
        var falloff = sample_ramp_2d(diffuse_ramp, linear_sampler, at);
        if BACKLIGHT == BACKLIGHT_RAMP {
            let against = sample_ramp_2d(backlight_ramp, linear_sampler, at);
            falloff = mix(falloff, against, backlight_weight(light.direction, to_viewer));
        }
        let shadow = shadow_on_light(lights[i].shadow_slot, shade, light.direction, to_viewer);
        sum += falloff * lights[i].color * light.attenuation * shadow;
    }
    return sum;
}

// Sum of all lights through six-way maps.
fn diffuse_from_six_way(six_way: SixWay, position: vec3f, shade: Shade) -> vec3f {
    let to_viewer = direction_to_viewer(position, view.orthographic);
    var sum = vec3f(0.0);
    for (var i = 0u; i < system.light_count; i++) {
        let light = sample_light(lights[i], position);
        let response = six_way_response(six_way.positive, six_way.negative, light.direction, system.six_way_anisotropy);
        let shadow = shadow_on_light(lights[i].shadow_slot, shade, light.direction, to_viewer);
        sum += lights[i].color * (response * light.attenuation) * shadow;
    }
    return sum * system.six_way_color;
}

// Even backlight of smoke by its amount. (OTEE "Soft scattering")
fn soft_scatter(amount: f32) -> vec3f {
    if SOFT_SCATTER_MODE == SOFT_SCATTER_MODE_RAMP {
        return sample_ramp(soft_scatter_ramp, linear_sampler, amount) * system.soft_scatter_intensity;
    }
    let weight = soft_scatter_weight(amount, system.scatter_amount, system.scatter_smooth);
    return mix(system.scatter_color, system.ambient_color, weight) * system.soft_scatter_intensity;
}
