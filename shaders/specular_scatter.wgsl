// specular_scatter: draws the glow of lights behind the smoke, one quad of constant pixel size around each light.
// Reads   accumulation target, or lit smoke and its depth slopes; reduced depth, scene depth, lights, specular ramp.
// Writes  the host's color target: linear light.
// Blend   ONE, ONE (additive); alpha is unchanged.
// Source  OTEE "Specular scattering".

#import "lib/lit_target.wgsl"
#import "lib/color.wgsl"
#import "lib/ramp.wgsl"
#import "lib/sprite.wgsl"

// True: the amount comes from the output of light_target.
override LIT: bool = false;

struct QuadVertex {
    @builtin(position) position: vec4f,
    // -1..1 across the quad.
    @location(0) uv: vec2f,
    // Light color times all fades except that of the range.
    @location(1) @interpolate(flat, either) color: vec3f,
    // Position, and 1 / range.
    @location(2) @interpolate(flat, either) position_inverse_range: vec4f,
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

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> QuadVertex {
    var out: QuadVertex;
    // Outside the clip volume, until the light is known to be visible.
    out.position = vec4f(2.0, 2.0, 2.0, 1.0);

    let light = lights[instance];
    let homogeneous = select(vec4f(light.position, 1.0), vec4f(-light.direction, 0.0), light.directional > 0.5);
    let clip = view.clip_from_view * homogeneous;
    let depth = select(-light.position.z, SKY_VIEW_DEPTH, light.directional > 0.5);
    let fade = specular_scatter_fade(depth, system.smoke_near, system.smoke_far);
    let strength = light.specular_scatter * system.specular_scatter_intensity * fade;
    if clip.w <= 0.0 || depth <= view.near || strength <= 0.0 {
        return out;
    }
    let centre = clip.xy / clip.w;
    let pixel = pixel_from_ndc(centre, view.size);
    // The glow ends with its quad: a light that is further outside the view shows nothing.
    if any(abs(pixel - 0.5 * view.size) > 0.5 * view.size + system.specular_scatter_size) {
        return out;
    }
    // Surfaces less than the diameter of the light's body in front of it do not hide it, because they may be its own
    // fixture. Any surface hides a directional light.
    let body = max(light.radius * pixels_per_metre(view.size.y, view.ray_scale.y, depth, view.orthographic), 1.5);
    let compared_depth = min(depth - 2.0 * light.radius, 0.99 * view.far);
    let visibility = light_visibility(pixel, body, compared_depth);
    if visibility <= 0.0 {
        return out;
    }
    let corner = sprite_corner(index);
    let extent = corner * system.specular_scatter_size * 2.0 / view.size;
    out.position = vec4f(centre + extent, 0.5, 1.0);
    out.uv = corner;
    out.color = light.color * strength * visibility;
    out.position_inverse_range = vec4f(light.position, light.inverse_range);
    return out;
}

@fragment
fn fragment(in: QuadVertex) -> @location(0) vec4f {
    let distance_squared = dot(in.uv, in.uv);
    if distance_squared >= 1.0 {
        discard;
    }
    let pixel = in.position.xy - view.origin;
    var amount = 0.0;
    if LIT {
        amount = sample_lit(pixel).a;
    } else {
        amount = sample_target(accumulation, pixel).a;
    }
    if amount <= 0.0 {
        discard;
    }
    let to_light = in.position_inverse_range.xyz - shading_position(pixel);
    let window = range_window(dot(to_light, to_light), in.position_inverse_range.w);
    // x is distance², y is the amount.
    let glow = sample_ramp_2d(specular_ramp, linear_sampler, vec2f(distance_squared, amount));
    return vec4f(bounded_light(glow * in.color * window), 0.0);
}
