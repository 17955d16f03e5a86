// Sprite lookups: a flipbook of normal maps, rgb = normal / 2 + 1/2 (y up), a = amount. With six-way maps, two sets of
// as many frames follow: light from right, top and front with the amount, then light from left, bottom and back.

#import "lib/ramp.wgsl"

// Mip level whose texels are closest in size to the target's. Sprites face the camera, so one level fits the whole
// sprite and no derivatives are needed. A whole level takes one lookup instead of two; docs/bench.md has the
// difference.
fn sprite_lod(sprite_size: f32, diameter_in_texels: f32) -> f32 {
    return max(floor(log2(sprite_size / max(diameter_in_texels, 1.0e-3)) + 0.5), 0.0);
}

const SPRITE_ANIMATION_FLIPBOOK: u32 = 0u;
const SPRITE_ANIMATION_VOLUME: u32 = 1u;
const SPRITE_ANIMATION_STILL: u32 = 2u;
const SPRITE_ANIMATION_NEAREST: u32 = 3u;

// Fractional frame that a particle shows: its own frame, its age through the slices of a volume texture, or the first
// frame. `nearest` adds half a frame, because its fraction is cut off later.
fn sprite_frame(animation: u32, frame: f32, age: f32, frame_count: f32) -> f32 {
    switch animation {
        case SPRITE_ANIMATION_VOLUME: { return saturate(age) * (frame_count - 1.0); }
        case SPRITE_ANIMATION_STILL: { return 0.0; }
        case SPRITE_ANIMATION_NEAREST: { return frame + 0.5; }
        default: { return frame; }
    }
}

// The two frames that a fractional frame blends, and the weight of the second. The flipbook repeats.
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

// The same frames of a flipbook that starts `layers` layers later.
fn offset_frames(frames: FlipbookFrames, layers: i32) -> FlipbookFrames {
    return FlipbookFrames(frames.first + layers, frames.second + layers, frames.blend);
}

// Frames as an animation shows them. If an animation does not blend, the weight is a constant and the compiler removes
// the second lookup. A branch would not do: llvmpipe takes both sides.
fn animation_frames(animation: u32, frame: f32, frame_count: f32) -> FlipbookFrames {
    var frames = flipbook_frames(frame, frame_count);
    if animation == SPRITE_ANIMATION_STILL || animation == SPRITE_ANIMATION_NEAREST {
        frames.blend = 0.0;
    }
    return frames;
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

// The mip chain is complete. WebGL2 cannot query the number of levels; the small term covers the rounding of log2.
fn last_level(sprite: texture_2d_array<f32>) -> f32 {
    return floor(log2(f32(textureDimensions(sprite).x)) + 1.0e-3);
}

fn sample_sprite_frame(sprite: texture_2d_array<f32>, linear_sampler: sampler, uv: vec2f, frame: i32, lod: f32) -> vec4f {
    if !EXACT_FILTERING {
        return textureSampleLevel(sprite, linear_sampler, uv, frame, lod);
    }
    let last = last_level(sprite);
    let level = min(lod, last);
    let base = floor(level);
    let fine = load_sprite_bilinear(sprite, uv, frame, i32(base));
    let coarse = load_sprite_bilinear(sprite, uv, frame, i32(min(base + 1.0, last)));
    return mix(fine, coarse, level - base);
}

// True: four loads replace a filtered lookup at a whole mip level. In compute shaders on llvmpipe loads take less time,
// but the level must be the same for all invocations that it runs side by side.
override LOADS_SPRITE: bool = false;

fn sample_at_level(sprite: texture_2d_array<f32>, linear_sampler: sampler, uv: vec2f, frame: i32, level: f32) -> vec4f {
    if LOADS_SPRITE {
        return load_sprite_bilinear(sprite, uv, frame, i32(min(level, last_level(sprite))));
    }
    return sample_sprite_frame(sprite, linear_sampler, uv, frame, level);
}

// Samples a flipbook between two frames. `uv` is 0..1, v down. `motion` is the motion of texels from the first frame to
// the second, in uv. Each frame is looked up at the texel's position at this moment, so that blending does not ghost.
fn sample_flipbook(
    sprite: texture_2d_array<f32>,
    linear_sampler: sampler,
    uv: vec2f,
    frames: FlipbookFrames,
    motion: vec2f,
    lod: f32,
) -> vec4f {
    var texel = sample_at_level(sprite, linear_sampler, uv - motion * frames.blend, frames.first, lod);
    if frames.blend > 0.0 {
        let position = uv + motion * (1.0 - frames.blend);
        let next = sample_at_level(sprite, linear_sampler, position, frames.second, lod);
        texel = mix(texel, next, frames.blend);
    }
    return texel;
}

// Samples a sprite: normal (-1..1, about unit length) and amount.
fn sample_sprite(
    sprite: texture_2d_array<f32>,
    linear_sampler: sampler,
    uv: vec2f,
    frames: FlipbookFrames,
    motion: vec2f,
    lod: f32,
) -> vec4f {
    let texel = sample_flipbook(sprite, linear_sampler, uv, frames, motion, lod);
    return vec4f(texel.rgb * 2.0 - 1.0, texel.a);
}

// Largest motion that a detail map can store, in uv. MOTION_RANGE in crates/haze_core/src/formula/sprite.rs.
const MOTION_RANGE: f32 = 0.125;

// Decodes a detail map's texel: x = offset towards the viewer, -1..1 radii; yz = motion to the next frame, in uv. A
// value of 128 out of 255 is zero.
fn detail_from_texel(texel: vec3f) -> vec3f {
    return (texel * 255.0 - 128.0) / 127.0 * vec3f(1.0, MOTION_RANGE, MOTION_RANGE);
}

// Samples the detail map between two frames. The motion is the first frame's.
fn sample_detail(
    detail: texture_2d_array<f32>,
    linear_sampler: sampler,
    uv: vec2f,
    frames: FlipbookFrames,
    lod: f32,
) -> vec3f {
    let first = detail_from_texel(sample_sprite_frame(detail, linear_sampler, uv, frames.first, lod).rgb);
    let second = detail_from_texel(sample_sprite_frame(detail, linear_sampler, uv, frames.second, lod).rgb);
    return vec3f(mix(first.x, second.x, frames.blend), first.yz);
}

// Undoes a sprite's rotation, (cos, sin).
fn unrotate(offset: vec2f, rotation: vec2f) -> vec2f {
    return vec2f(offset.x * rotation.x + offset.y * rotation.y, offset.y * rotation.x - offset.x * rotation.y);
}

// NV's debug sprite: 8 x 8 checks with amounts of 1 and 0.25 in turn.
fn checkerboard(uv: vec2f) -> vec4f {
    let check = vec2i(floor(uv * 8.0));
    return vec4f(0.0, 0.0, 1.0, select(0.25, 1.0, ((check.x + check.y) & 1) == 0));
}

// Corner 0..4 of a triangle strip, -1..1, y up.
fn sprite_corner(index: u32) -> vec2f {
    return vec2f(f32(index & 1u) * 2.0 - 1.0, f32(index >> 1u) * 2.0 - 1.0);
}

// Corner of a sprite's trimmed rectangle, -1..1, y up. `corner` is the one of the full square; `reach` is the extent
// from the center to the left, bottom, right and top, as fractions of half a side.
fn trimmed_corner(corner: vec2f, reach: vec4f) -> vec2f {
    return select(-reach.xy, reach.zw, corner > vec2f(0.0));
}

fn sprite_uv(corner: vec2f) -> vec2f {
    return vec2f(corner.x * 0.5 + 0.5, 0.5 - corner.y * 0.5);
}
