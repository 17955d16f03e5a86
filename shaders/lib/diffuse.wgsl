// Lighting of smoke, shared by transfer, forward and diffuse_bake.

#import "lib/bindings.wgsl"
#import "lib/ramp.wgsl"
#import "lib/six_way.wgsl"
#import "lib/shadow.wgsl"
#import "lib/ambient.wgsl"

const SOFT_SCATTER_MODE_SMOOTHSTEP: u32 = 0u;
const SOFT_SCATTER_MODE_RAMP: u32 = 1u;
override SOFT_SCATTER_MODE: u32 = SOFT_SCATTER_MODE_SMOOTHSTEP;

const BACKLIGHT_SAME: u32 = 0u;
const BACKLIGHT_RAMP: u32 = 1u;
override BACKLIGHT: u32 = BACKLIGHT_SAME;

// True if light from sky and ground falls on the smoke.
override AMBIENT: bool = false;

// Smoke and scene between a point of the smoke and the light that falls on it.
struct Shade {
    // Of other smoke, towards the lights with shadow.
    optical_depths: array<vec3f, LIGHT_BLOCKS>,
    // Share of each of these lights that comes past the scene.
    visible: array<vec3f, LIGHT_BLOCKS>,
    // To sky and ground.
    openness: vec2f,
}

// Other smoke before sprites. `optical_depths`: towards the lights of the first block.
fn shade_of_sprites(optical_depths: vec3f) -> Shade {
    var shade: Shade;
    shade.optical_depths[0] = optical_depths;
    shade.visible = fully_visible();
    shade.openness = vec2f(1.0);
    return shade;
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

// Share of the light from a hemisphere that comes through the smoke.
fn shadow_on_hemisphere(openness: f32) -> vec3f {
    if !SHADOW {
        return vec3f(1.0);
    }
    let painted = sample_ramp_2d(shadow_ramp, linear_sampler, openness_position(openness));
    return mix(vec3f(1.0), painted, system.shadow_strength);
}

// Light from sky and ground, after the smoke between them.
struct Hemispheres {
    sky: vec3f,
    ground: vec3f,
}

fn hemispheres(openness: vec2f) -> Hemispheres {
    return Hemispheres(
        system.sky_color * shadow_on_hemisphere(openness.x),
        system.ground_color * shadow_on_hemisphere(openness.y),
    );
}

// Light from sky and ground through the diffuse ramp.
fn ambient_from_ramp(normal: vec3f, covered: f32, openness: vec2f) -> vec3f {
    let light = hemispheres(openness);
    let above = vec2f(hemisphere_coordinate(normal, system.up), covered);
    let below = vec2f(hemisphere_coordinate(normal, -system.up), covered);
    return light.sky * sample_ramp_2d(diffuse_ramp, linear_sampler, above)
        + light.ground * sample_ramp_2d(diffuse_ramp, linear_sampler, below);
}

// Light from sky and ground through six-way maps.
fn ambient_from_six_way(six_way: SixWay, openness: vec2f) -> vec3f {
    let light = hemispheres(openness);
    return light.sky * six_way_hemisphere(six_way.positive, six_way.negative, system.up)
        + light.ground * six_way_hemisphere(six_way.positive, six_way.negative, -system.up);
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
    if AMBIENT {
        sum += ambient_from_ramp(normal, covered, shade.openness);
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
    if AMBIENT {
        sum += ambient_from_six_way(six_way, shade.openness);
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
