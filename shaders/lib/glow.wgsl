// Glow of lights behind the smoke, shared by specular_scatter, light_target and transfer_lit. (OTEE "Specular
// scattering")

#import "lib/accumulated.wgsl"
#import "lib/color.wgsl"
#import "lib/lighting.wgsl"
#import "lib/ramp.wgsl"

// True if a texel covers several pixels: it may have smoke at a thin surface that is in front of all smoke.
override COARSE: bool = true;

// A light as its glow is drawn: within a circle of constant size around it.
struct Glow {
    // Pixels of the view.
    center: vec2f,
    // Light color times all fades except that of the range. Zero if nothing shows.
    color: vec3f,
}

// Fraction of a light's body that the scene leaves visible.
fn light_visibility(pixel: vec2f, radius: f32, light_depth: f32) -> f32 {
    var visible = 0.0;
    for (var i = 0u; i < VISIBILITY_TAPS; i++) {
        let tap = clamp(floor(pixel + visibility_tap(i, radius)), vec2f(0.0), view.size - 1.0);
        visible += select(0.0, 1.0, scene_view_depth(tap) >= light_depth);
    }
    return visible / f32(VISIBILITY_TAPS);
}

fn glow_of_light(light: Light) -> Glow {
    let homogeneous = select(vec4f(light.position, 1.0), vec4f(-light.direction, 0.0), light.directional > 0.5);
    let clip = view.clip_from_view * homogeneous;
    let depth = select(-light.position.z, SKY_VIEW_DEPTH, light.directional > 0.5);
    let fade = specular_scatter_fade(depth, system.smoke_near, system.smoke_far);
    // The light that the smoke scatters on was on its way to the viewer.
    let cone = cone_attenuation(light, direction_to_viewer(light.position, view.orthographic));
    let to_smoke = system.center - light.position;
    let falloff = select(system.specular_scatter_falloff, 0.0, light.directional > 0.5);
    let arriving = glow_falloff(dot(to_smoke, to_smoke), light.radius, falloff);
    let strength = light.specular_scatter * system.specular_scatter_intensity * fade * cone * arriving;
    if clip.w <= 0.0 || depth <= view.near || strength <= 0.0 {
        return Glow(vec2f(0.0), vec3f(0.0));
    }
    let pixel = pixel_from_ndc(clip.xy / clip.w, view.size);
    // The glow ends with its circle: a light that is further outside the view shows nothing.
    if any(abs(pixel - 0.5 * view.size) > 0.5 * view.size + system.specular_scatter_size) {
        return Glow(pixel, vec3f(0.0));
    }
    // Surfaces less than the diameter of the light's body in front of it do not hide it, because they may be its own
    // fixture. Any surface hides a directional light.
    let body = max(light.radius * pixels_per_metre(view.size.y, view.ray_scale.y, depth, view.orthographic), 1.5);
    let compared_depth = min(depth - 2.0 * light.radius, 0.99 * view.far);
    return Glow(pixel, light.color * strength * light_visibility(pixel, body, compared_depth));
}

// Glow of a light in smoke at a pixel. `distance_squared`: from the light, in radii of the circle.
fn glow_in_smoke(color: vec3f, light: Light, distance_squared: f32, amount: f32, pixel: vec2f) -> vec3f {
    if COARSE && scene_view_depth(pixel) < system.smoke_near {
        return vec3f(0.0);
    }
    let to_light = light.position - shading_position(pixel);
    let window = range_window(dot(to_light, to_light), light.inverse_range);
    // x is distance², y is the amount.
    let glow = sample_ramp_2d(specular_ramp, linear_sampler, vec2f(distance_squared, amount));
    return bounded_light(glow * color * window);
}
