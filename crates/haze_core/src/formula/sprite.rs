//! Sprite lookups: a flipbook of normal maps. WGSL: `shaders/lib/sprite.wgsl`.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};

use super::saturate;
use super::texture::Texture2dArray;
use crate::settings::SpriteAnimation;

/// Largest motion that a detail map can store, in sides of the sprite.
pub const MOTION_RANGE: f32 = 0.125;

/// Mip level whose texels are closest in size to the target's.
pub fn sprite_lod(sprite_size: f32, diameter_in_texels: f32) -> f32 {
    ((sprite_size / diameter_in_texels.max(1.0e-3)).log2() + 0.5).floor().max(0.0)
}

/// Fractional frame that a particle shows: its own frame, its age through the slices of a volume texture, or the first
/// frame. `nearest` adds half a frame, because its fraction is cut off later.
pub fn sprite_frame(animation: SpriteAnimation, frame: f32, age: f32, frame_count: f32) -> f32 {
    match animation {
        SpriteAnimation::Flipbook => frame,
        SpriteAnimation::Volume => saturate(age) * (frame_count - 1.0),
        SpriteAnimation::Still => 0.0,
        SpriteAnimation::Nearest => frame + 0.5,
    }
}

/// The two frames that a fractional frame blends, and the weight of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlipbookFrames {
    /// Index of the frame shown.
    pub first: i32,
    /// Index of the next frame.
    pub second: i32,
    /// Weight of the second frame: 0 shows the first, 1 the second.
    pub blend: f32,
}

/// Splits a fractional frame. The flipbook repeats.
pub fn flipbook_frames(frame: f32, frame_count: f32) -> FlipbookFrames {
    let wrapped = frame - (frame / frame_count).floor() * frame_count;
    let first = wrapped.floor().max(0.0).min(frame_count - 1.0);
    let second = if first + 1.5 > frame_count { 0.0 } else { first + 1.0 };
    FlipbookFrames { first: first as i32, second: second as i32, blend: saturate(wrapped - first) }
}

/// The same frames of a flipbook that starts `layers` layers later.
pub fn offset_frames(frames: FlipbookFrames, layers: i32) -> FlipbookFrames {
    FlipbookFrames { first: frames.first + layers, second: frames.second + layers, ..frames }
}

/// Frames as an animation shows them; `still` and `nearest` do not blend.
pub fn animation_frames(animation: SpriteAnimation, frame: f32, frame_count: f32) -> FlipbookFrames {
    let frames = flipbook_frames(frame, frame_count);
    match animation {
        SpriteAnimation::Flipbook | SpriteAnimation::Volume => frames,
        SpriteAnimation::Still | SpriteAnimation::Nearest => FlipbookFrames { blend: 0.0, ..frames },
    }
}

/// Samples a frame at a mip level, filtered between four texels.
pub fn load_sprite_bilinear(sprite: &impl Texture2dArray, uv: Vec2, frame: i32, level: u32) -> Vec4 {
    let size = sprite.dimensions(level) as i32;
    let texel = uv * size as f32 - 0.5;
    let base = texel.floor();
    let fraction = texel - base;
    let limit = |texel: IVec2| texel.clamp(IVec2::ZERO, IVec2::splat(size - 1)).as_uvec2();
    let low = limit(base.as_ivec2());
    let high = limit(base.as_ivec2() + 1);
    let load = |x, y| sprite.load(UVec2::new(x, y), frame as u32, level);
    let top = load(low.x, low.y).lerp(load(high.x, low.y), fraction.x);
    let bottom = load(low.x, high.y).lerp(load(high.x, high.y), fraction.x);
    top.lerp(bottom, fraction.y)
}

/// Last mip level of a sprite.
pub fn last_level(sprite: &impl Texture2dArray) -> f32 {
    (sprite.level_count() - 1) as f32
}

/// Samples a frame, filtered between texels and between mip levels.
pub fn sample_sprite_frame(sprite: &impl Texture2dArray, uv: Vec2, frame: i32, lod: f32) -> Vec4 {
    let last = last_level(sprite);
    let level = lod.min(last);
    let base = level.floor();
    let fine = load_sprite_bilinear(sprite, uv, frame, base as u32);
    let coarse = load_sprite_bilinear(sprite, uv, frame, (base + 1.0).min(last) as u32);
    fine.lerp(coarse, level - base)
}

/// Samples a flipbook between two frames. `uv` is 0..1, v down. `motion` is the motion of texels from the first frame
/// to the second, in uv.
pub fn sample_flipbook(sprite: &impl Texture2dArray, uv: Vec2, frames: FlipbookFrames, motion: Vec2, lod: f32) -> Vec4 {
    let mut texel = sample_sprite_frame(sprite, uv - motion * frames.blend, frames.first, lod);
    if frames.blend > 0.0 {
        let position = uv + motion * (1.0 - frames.blend);
        // In this form the result is exact if both samples are equal.
        texel += (sample_sprite_frame(sprite, position, frames.second, lod) - texel) * frames.blend;
    }
    texel
}

/// Samples a sprite: normal (−1..1, about unit length) and amount.
pub fn sample_sprite(sprite: &impl Texture2dArray, uv: Vec2, frames: FlipbookFrames, motion: Vec2, lod: f32) -> Vec4 {
    let texel = sample_flipbook(sprite, uv, frames, motion, lod);
    (texel.xyz() * 2.0 - 1.0).extend(texel.w)
}

/// Decodes a detail map's texel: offset towards the viewer, −1..1 radii, and motion to the next frame, in uv.
pub fn detail_from_texel(texel: Vec3) -> Vec3 {
    (texel * 255.0 - 128.0) / 127.0 * Vec3::new(1.0, MOTION_RANGE, MOTION_RANGE)
}

/// Samples the detail map between two frames. The motion is the first frame's.
pub fn sample_detail(detail: &impl Texture2dArray, uv: Vec2, frames: FlipbookFrames, lod: f32) -> Vec3 {
    let sample = |frame| detail_from_texel(sample_sprite_frame(detail, uv, frame, lod).xyz());
    let first = sample(frames.first);
    let second = sample(frames.second);
    Vec3::new(first.x + (second.x - first.x) * frames.blend, first.y, first.z)
}

/// Undoes a sprite's rotation, (cos, sin).
pub fn unrotate(offset: Vec2, rotation: Vec2) -> Vec2 {
    Vec2::new(offset.x * rotation.x + offset.y * rotation.y, offset.y * rotation.x - offset.x * rotation.y)
}

/// Corner 0 to 3 of a triangle strip, −1..1, y up.
pub fn sprite_corner(index: u32) -> Vec2 {
    Vec2::new((index % 2) as f32, (index / 2) as f32) * 2.0 - 1.0
}

/// Corner of a sprite's trimmed rectangle, −1..1, y up. `corner` is the one of the full square; `reach` is the extent
/// from the center to the left, bottom, right and top, as fractions of half a side.
pub fn trimmed_corner(corner: Vec2, reach: Vec4) -> Vec2 {
    Vec2::select(corner.cmpgt(Vec2::ZERO), reach.zw(), -reach.xy())
}

/// Texture coordinates, 0..1 with v down, of a position on the sprite, −1..1 with y up.
pub fn sprite_uv(corner: Vec2) -> Vec2 {
    Vec2::new(corner.x * 0.5 + 0.5, 0.5 - corner.y * 0.5)
}

/// NV's debug sprite: 8 × 8 checks with amounts of 1 and 0.25 in turn.
pub fn checkerboard(uv: Vec2) -> Vec4 {
    let check = (uv * 8.0).floor().as_ivec2();
    Vec4::new(0.0, 0.0, 1.0, if (check.x + check.y) & 1 == 0 { 1.0 } else { 0.25 })
}
