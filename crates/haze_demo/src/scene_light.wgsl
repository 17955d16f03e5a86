// demo scene: light
// What    Lights the samples of paint, in two layers: surfaces behind outlines, and objects in front.
// Reads   paint, and depth at 2x2 samples per pixel, in addition to scene.wgsl.
// Writes  scene color of a layer (linear HDR), or its parts.
// Source  Karis, "Tone mapping", 2013, for the weights of the samples.

@group(1) @binding(0) var paint: texture_2d<f32>;

// Returns the direction of the ray through a position in the image, pixels.
fn ray_direction(position: vec2f) -> vec3f {
    return normalize(ray_at_unit_depth(position * 2.0 / vec2f(textureDimensions(paint))));
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

// Light of a group of samples, with their fraction of the pixel in alpha.
struct LightParts {
    @location(0) rest: vec4f,
    @location(1) first: vec4f,
    @location(2) second: vec4f,
    @location(3) third: vec4f,
}

fn light_parts(lit: Lit, fraction: f32) -> LightParts {
    return LightParts(
        vec4f(lit.rest, fraction),
        vec4f(lit.apart[0], 1.0),
        vec4f(lit.apart[1], 1.0),
        vec4f(lit.apart[2], 1.0),
    );
}

// Samples of a pixel in a layer. Discards the pixel if there are none.
fn layer_samples(in: LayerVertex) -> vec4<bool> {
    let is_front = sample_groups(vec2i(in.position.xy)).is_front;
    let is_in_layer = is_front == vec4<bool>(in.layer == FRONT);
    if !any(is_in_layer) {
        discard;
    }
    return is_in_layer;
}

// Alpha of a layer. Behind it is 0: that of the smoke is added to it.
fn layer_alpha(in: LayerVertex, is_in_layer: vec4<bool>) -> f32 {
    return select(0.0, group_fraction(is_in_layer), in.layer == FRONT);
}

@fragment
fn light_fragment(in: LayerVertex) -> @location(0) vec4f {
    let samples = layer_samples(in);
    return vec4f(total(light_at(in.position.xy, samples)), layer_alpha(in, samples));
}

@fragment
fn light_parts_fragment(in: LayerVertex) -> LightParts {
    let samples = layer_samples(in);
    return light_parts(light_at(in.position.xy, samples), layer_alpha(in, samples));
}
