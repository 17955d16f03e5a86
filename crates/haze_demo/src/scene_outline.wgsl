// demo scene: outline
// What    Completes the image: adds objects in front at outlines, each with the smoke in front of it.
// Reads   the image of the surfaces behind outlines with smoke, whose opacity is in alpha, and without; objects in front, with
//         their fraction of the pixel in alpha; depth at 2x2 samples per pixel.
// Writes  the image (linear HDR).
// Source  own. Smoke in front of an object is that of the pixels beside it that show the object. Where none does, because the
//         object is thinner than a pixel, it is a part of the pixel's optical depth, by the object's position between the smoke's
//         nearest and farthest depth.

@group(1) @binding(11) var smoked: texture_2d<f32>;
@group(1) @binding(12) var behind: texture_2d<f32>;
@group(1) @binding(13) var front: texture_2d<f32>;

struct Smoke {
    // Range of view depths, metres.
    nearest: f32,
    farthest: f32,
    padding: vec2f,
}

@group(1) @binding(14) var<uniform> smoke: Smoke;

// Smoke in front of a pixel's surface: premultiplied light, opacity.
fn smoke_of(at: vec2i) -> vec4f {
    let image = textureLoad(smoked, at, 0);
    return vec4f(image.rgb - textureLoad(behind, at, 0).rgb * (1.0 - image.a), image.a);
}

// Smoke in front of an object that covers a part of a pixel, at a view depth.
fn smoke_before(pixel: vec2i, depth: f32) -> vec4f {
    let size = vec2i(textureDimensions(smoked));
    var sum = vec4f(0.0);
    var count = 0.0;
    for (var i = 0; i < 9; i++) {
        let at = clamp(pixel + vec2i(i % 3, i / 3) - 1, vec2i(0), size - 1);
        let difference = abs(scene_view_depth(sample_groups(at).back) - depth);
        if difference < depth * (OUTLINE_RATIO - 1.0) {
            sum += smoke_of(at);
            count += 1.0;
        }
    }
    if count > 0.0 {
        return sum / count;
    }
    let passed = saturate((depth - smoke.nearest) / max(smoke.farthest - smoke.nearest, 1.0e-3));
    let whole = smoke_of(pixel);
    let opacity = 1.0 - pow(max(1.0 - whole.a, 1.0e-6), passed);
    return whole * (opacity / max(whole.a, 1.0e-6));
}

// Weight of a color in a pixel, as in average().
fn color_weight(color: vec3f) -> f32 {
    return 1.0 / (1.0 + max(max(color.r, color.g), max(color.b, 0.0)));
}

@fragment
fn outline_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(position.xy);
    let image = textureLoad(smoked, pixel, 0).rgb;
    let object = textureLoad(front, pixel, 0);
    if object.a == 0.0 {
        return vec4f(image, 1.0);
    }
    let before = smoke_before(pixel, scene_view_depth(sample_groups(pixel).front));
    let seen = max(object.rgb * (1.0 - before.a) + before.rgb, vec3f(0.0));
    let weight = object.a * color_weight(seen);
    let rest = (1.0 - object.a) * color_weight(image);
    return vec4f((seen * weight + image * rest) / (weight + rest), 1.0);
}
