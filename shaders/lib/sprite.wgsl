// The sprite picture: a flipbook of normal maps, rgb = normal / 2 + 1/2 (y up), a = amount.

#import "lib/ramp.wgsl"

// The mip level at which a sprite's texels are as large as the target's. Sprites face the camera, so one level fits the
// whole sprite and no derivatives are needed.
fn sprite_lod(sprite_size: f32, diameter_in_texels: f32) -> f32 {
    return max(log2(sprite_size / max(diameter_in_texels, 1.0e-3)), 0.0);
}

// The two frames that a fractional frame blends, and the share of the second. The flipbook repeats.
struct FlipbookFrames {
    first: i32,
    second: i32,
    blend: f32,
}

fn flipbook_frames(frame: f32, frame_count: f32) -> FlipbookFrames {
    let wrapped = frame - floor(frame / frame_count) * frame_count;
    let first = clamp(floor(wrapped), 0.0, frame_count - 1.0);
    let second = select(first + 1.0, 0.0, first + 1.5 > frame_count);
    return FlipbookFrames(i32(first), i32(second), saturate(wrapped - first));
}

fn load_sprite_bilinear(sprite: texture_2d_array<f32>, uv: vec2f, frame: i32, level: i32) -> vec4f {
    let size = vec2i(textureDimensions(sprite, level));
    let texel = uv * vec2f(size) - 0.5;
    let base = floor(texel);
    let fraction = texel - base;
    let low = clamp(vec2i(base), vec2i(0), size - 1);
    let high = clamp(vec2i(base) + 1, vec2i(0), size - 1);
    let top = mix(
        textureLoad(sprite, low, frame, level),
        textureLoad(sprite, vec2i(high.x, low.y), frame, level),
        fraction.x,
    );
    let bottom = mix(
        textureLoad(sprite, vec2i(low.x, high.y), frame, level),
        textureLoad(sprite, high, frame, level),
        fraction.x,
    );
    return mix(top, bottom, fraction.y);
}

fn sample_sprite_frame(sprite: texture_2d_array<f32>, linear_sampler: sampler, uv: vec2f, frame: i32, lod: f32) -> vec4f {
    if !EXACT_FILTERING {
        return textureSampleLevel(sprite, linear_sampler, uv, frame, lod);
    }
    // The mip chain is whole. WebGL2 cannot ask for the number of levels; the small term is for log2's rounding.
    let last = floor(log2(f32(textureDimensions(sprite).x)) + 1.0e-3);
    let level = min(lod, last);
    let base = floor(level);
    let fine = load_sprite_bilinear(sprite, uv, frame, i32(base));
    let coarse = load_sprite_bilinear(sprite, uv, frame, i32(min(base + 1.0, last)));
    return mix(fine, coarse, level - base);
}

// Normal (-1..1, about unit length) and amount of a sprite. uv 0..1, v down.
fn sample_sprite(
    sprite: texture_2d_array<f32>,
    linear_sampler: sampler,
    uv: vec2f,
    frames: FlipbookFrames,
    lod: f32,
) -> vec4f {
    var texel = sample_sprite_frame(sprite, linear_sampler, uv, frames.first, lod);
    if frames.blend > 0.0 {
        let next = sample_sprite_frame(sprite, linear_sampler, uv, frames.second, lod);
        texel = mix(texel, next, frames.blend);
    }
    return vec4f(texel.rgb * 2.0 - 1.0, texel.a);
}

// Corner 0..4 of a triangle strip, -1..1, y up.
fn sprite_corner(index: u32) -> vec2f {
    return vec2f(f32(index & 1u) * 2.0 - 1.0, f32(index >> 1u) * 2.0 - 1.0);
}

fn sprite_uv(corner: vec2f) -> vec2f {
    return vec2f(corner.x * 0.5 + 0.5, 0.5 - corner.y * 0.5);
}
