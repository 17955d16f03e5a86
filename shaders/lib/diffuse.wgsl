// Lighting of smoke, shared by transfer, forward and diffuse_bake.

#import "lib/bindings.wgsl"
#import "lib/response.wgsl"
#import "lib/six_way.wgsl"
#import "lib/shadow.wgsl"
#import "lib/shadow_volume.wgsl"
#import "lib/ambient.wgsl"

const SOFT_SCATTER_MODE_SMOOTHSTEP: u32 = 0u;
const SOFT_SCATTER_MODE_RAMP: u32 = 1u;
override SOFT_SCATTER_MODE: u32 = SOFT_SCATTER_MODE_SMOOTHSTEP;

// True if light from sky and ground falls on the smoke.
override AMBIENT: bool = false;

// Smoke and scene between a point of the smoke and the light that falls on it.
struct Shade {
    // Of other smoke, towards the lights of the first block.
    optical_depths: vec3f,
    // Fraction of each of these lights that comes past the scene.
    visible: vec3f,
    // To sky and ground.
    openness: vec2f,
    // Ray and moments of depth, for the lights of further blocks.
    ray: vec2f,
    moments: vec2f,
    // See own_at_mean_depth().
    own: f32,
}

// Smoke and scene in front of the lights of one block.
struct BlockShade {
    block: f32,
    optical_depths: vec3f,
    visible: vec3f,
}

// Other smoke in front of sprites. `optical_depths`: towards the lights of the first block.
fn shade_of_sprites(optical_depths: vec3f) -> Shade {
    var shade: Shade;
    shade.optical_depths = optical_depths;
    shade.visible = vec3f(1.0);
    shade.openness = vec2f(1.0);
    return shade;
}

// The same, past the scene, open to the sky, and before further lights. `ray`: of the smoke; `moments`: of its depth.
fn shade_on_ray(optical_depths: vec3f, ray: vec2f, moments: vec2f) -> Shade {
    var shade = shade_of_sprites(optical_depths);
    shade.visible = scene_visibility(0.0, ray, moments);
    if AMBIENT {
        shade.openness = openness(ray, moments);
    }
    if SHADOW_BLOCKS > 1u {
        shade.ray = ray;
        shade.moments = moments;
        shade.own = own_at_mean_depth(sample_volume(0.0, mean_cell(ray, moments)), optical_depths);
    }
    return shade;
}

// Shade of the lights of the first block.
fn first_block(shade: Shade) -> BlockShade {
    return BlockShade(0.0, shade.optical_depths, shade.visible);
}

// Shade of the block of a light. `last`: that of the light before; lights of a block follow each other.
fn shade_of_block(slot: f32, shade: Shade, last: BlockShade) -> BlockShade {
    let block = block_of_slot(slot);
    if SHADOW_BLOCKS == 1u || slot < 0.5 || block == last.block {
        return last;
    }
    if block == 0.0 {
        return first_block(shade);
    }
    let in_grid = sample_volume(block, mean_cell(shade.ray, shade.moments));
    let visible = scene_visibility(block, shade.ray, shade.moments);
    return BlockShade(block, foreign_optical_depths(in_grid, shade.own), visible);
}

// Fraction of a light that comes past the scene and through the smoke in front of it.
fn shadow_on_light(slot: f32, shade: BlockShade, to_light: vec3f, to_viewer: vec3f) -> vec3f {
    if !SHADOW || slot < 0.5 {
        return vec3f(1.0);
    }
    let at = shadow_position(select_slot(slot, shade.optical_depths), to_light, to_viewer);
    let through = mix(vec3f(1.0), sample_ramp_2d(shadow_ramp, linear_sampler, at), system.shadow_strength);
    return through * select_slot(slot, shade.visible);
}

// Fraction of the light from a hemisphere that comes through the smoke.
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

// Sum of all lights through the diffuse ramp: response · color · attenuation.
fn diffuse_from_lights(normal: vec3f, covered: f32, position: vec3f, shade: Shade) -> vec3f {
    let to_viewer = direction_to_viewer(position, view.orthographic);
    var sum = vec3f(0.0);
    var of_block = first_block(shade);
    for (var i = 0u; i < system.light_count; i++) {
        of_block = shade_of_block(lights[i].shadow_slot, shade, of_block);
        let light = sample_light(lights[i], position);
        let against = backlight_weight(light.direction, to_viewer);
        let response = diffuse_response(
            diffuse_ramp, backlight_ramp, linear_sampler, normal, light.direction, covered, against,
        );
        let shadow = shadow_on_light(lights[i].shadow_slot, of_block, light.direction, to_viewer);
        sum += response * lights[i].color * light.attenuation * shadow;
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
    var of_block = first_block(shade);
    for (var i = 0u; i < system.light_count; i++) {
        of_block = shade_of_block(lights[i].shadow_slot, shade, of_block);
        let light = sample_light(lights[i], position);
        let response = six_way_response(six_way.positive, six_way.negative, light.direction, system.six_way_anisotropy);
        let shadow = shadow_on_light(lights[i].shadow_slot, of_block, light.direction, to_viewer);
        sum += lights[i].color * (response * light.attenuation) * shadow;
    }
    if AMBIENT {
        sum += ambient_from_six_way(six_way, shade.openness);
    }
    return sum * system.six_way_color;
}

// Even backlight of smoke by its amount.
fn soft_scatter(amount: f32) -> vec3f {
    if SOFT_SCATTER_MODE == SOFT_SCATTER_MODE_RAMP {
        return sample_ramp(soft_scatter_ramp, linear_sampler, amount) * system.soft_scatter_intensity;
    }
    let light = soft_scatter_curve(
        amount, system.scatter_color, system.ambient_color, system.scatter_amount, system.scatter_smooth,
    );
    return light * system.soft_scatter_intensity;
}
