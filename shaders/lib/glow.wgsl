// Glow of a light behind the smoke, shared by specular_scatter and light_target. (OTEE "Specular scattering")

#import "lib/accumulated.wgsl"
#import "lib/lighting.wgsl"
#import "lib/ramp.wgsl"

struct Glow {
    // Middle of the quad.
    centre_ndc: vec2f,
    // The same, pixels of the view.
    centre: vec2f,
    // Light color times all fades except that of the range; 0 for a light that does not glow.
    color: vec3f,
    // Position, and 1 / range.
    position_inverse_range: vec4f,
}

// Share of a light's body that the scene leaves visible.
fn light_visibility(pixel: vec2f, radius: f32, light_depth: f32) -> f32 {
    var visible = 0.0;
    for (var i = 0u; i < VISIBILITY_TAPS; i++) {
        let tap = clamp(floor(pixel + visibility_tap(i, radius)), vec2f(0.0), view.size - 1.0);
        visible += select(0.0, 1.0, scene_view_depth(tap) >= light_depth);
    }
    return visible / f32(VISIBILITY_TAPS);
}

fn glow_of_light(light: Light) -> Glow {
    var glow: Glow;
    let homogeneous = select(vec4f(light.position, 1.0), vec4f(-light.direction, 0.0), light.directional > 0.5);
    let clip = view.clip_from_view * homogeneous;
    let depth = select(-light.position.z, SKY_VIEW_DEPTH, light.directional > 0.5);
    let fade = specular_scatter_fade(depth, system.smoke_near, system.smoke_far);
    let strength = light.specular_scatter * system.specular_scatter_intensity * fade;
    if clip.w <= 0.0 || depth <= view.near || strength <= 0.0 {
        return glow;
    }
    glow.centre_ndc = clip.xy / clip.w;
    glow.centre = pixel_from_ndc(glow.centre_ndc, view.size);
    // The glow ends with its quad: a light that is further outside the view shows nothing.
    if any(abs(glow.centre - 0.5 * view.size) > 0.5 * view.size + system.specular_scatter_size) {
        return glow;
    }
    // Surfaces less than the diameter of the light's body in front of it do not hide it, because they may be its own
    // fixture. Any surface hides a directional light.
    let body = max(light.radius * pixels_per_metre(view.size.y, view.ray_scale.y, depth, view.orthographic), 1.5);
    let compared_depth = min(depth - 2.0 * light.radius, 0.99 * view.far);
    glow.color = light.color * strength * light_visibility(glow.centre, body, compared_depth);
    glow.position_inverse_range = vec4f(light.position, light.inverse_range);
    return glow;
}

// Light of a glow through smoke of an amount above 0. `distance_squared`: from the quad's middle, of half its side. `pixel`: of
// the view.
fn glow_light(color: vec3f, position_inverse_range: vec4f, distance_squared: f32, amount: f32, pixel: vec2f) -> vec3f {
    let to_light = position_inverse_range.xyz - shading_position(pixel);
    let window = range_window(dot(to_light, to_light), position_inverse_range.w);
    // x is distance², y is the amount.
    let found = sample_ramp_2d(specular_ramp, linear_sampler, vec2f(distance_squared, amount));
    return bounded_light(found * color * window);
}
