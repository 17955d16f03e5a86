// demo scene: light
// What    Lights the samples of paint, in two layers: surfaces behind outlines, and objects in front.
// Reads   paint, and depth at 2x2 samples per pixel, in addition to scene.wgsl.
// Writes  scene color of a layer (linear HDR), or its parts.
// Source  Karis, "Tone mapping", 2013, for the weights of the samples.

@group(1) @binding(0) var paint: texture_2d<f32>;

// Returns the direction of the ray through a position in the image, pixels.
fn ray_direction(place: vec2f) -> vec3f {
    return normalize(ray_at_unit_depth(place * 2.0 / vec2f(textureDimensions(paint))));
}

// Averages samples of a pixel, weighted so that a single bright sample does not dominate an edge (Karis, "Tone mapping",
// 2013). Alpha of paint is below 0 without a surface.
fn average(paints: array<vec4f, 4>, lit: array<Lit, 4>, is_in_group: vec4<bool>) -> Lit {
    var sum: Lit;
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        if !is_in_group[i] {
            continue;
        }
        let reflectance = select(paints[i].rgb, vec3f(1.0), paints[i].a < 0.0);
        let light = lit[i];
        let color = reflectance * total(light);
        let weight = 1.0 / (1.0 + max(color.r, max(color.g, color.b)));
        sum.rest += reflectance * light.rest * weight;
        for (var slot = 0; slot < 3; slot++) {
            sum.apart[slot] += reflectance * light.apart[slot] * weight;
        }
        weights += weight;
    }
    sum.rest /= weights;
    for (var slot = 0; slot < 3; slot++) {
        sum.apart[slot] /= weights;
    }
    return sum;
}

// Light of a group of samples, with their share of the pixel in alpha.
struct LightParts {
    @location(0) rest: vec4f,
    @location(1) first: vec4f,
    @location(2) second: vec4f,
    @location(3) third: vec4f,
}

fn light_parts(lit: Lit, share: f32) -> LightParts {
    return LightParts(
        vec4f(lit.rest, share),
        vec4f(lit.apart[0], 1.0),
        vec4f(lit.apart[1], 1.0),
        vec4f(lit.apart[2], 1.0),
    );
}

// Alpha is 0: that of the smoke is added to it.
@fragment
fn light_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let groups = sample_groups(vec2i(position.xy));
    return vec4f(total(light_at(position.xy, !groups.is_front)), 0.0);
}

@fragment
fn light_parts_fragment(@builtin(position) position: vec4f) -> LightParts {
    let groups = sample_groups(vec2i(position.xy));
    return light_parts(light_at(position.xy, !groups.is_front), 0.0);
}

@fragment
fn front_light_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let groups = sample_groups(vec2i(position.xy));
    if !any(groups.is_front) {
        discard;
    }
    return vec4f(total(light_at(position.xy, groups.is_front)), group_share(groups.is_front));
}

@fragment
fn front_light_parts_fragment(@builtin(position) position: vec4f) -> LightParts {
    let groups = sample_groups(vec2i(position.xy));
    if !any(groups.is_front) {
        discard;
    }
    return light_parts(light_at(position.xy, groups.is_front), group_share(groups.is_front));
}
