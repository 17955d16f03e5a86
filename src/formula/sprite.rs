//! The sprite picture: a flipbook of normal maps. `shaders/lib/sprite.wgsl`.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};

use super::saturate;
use super::texture::Texture2dArray;
use crate::settings::SpriteAnimation;

/// The largest motion that a detail map holds, in sides of the sprite.
pub const MOTION_RANGE: f32 = 0.125;

/// The mip level whose texels are nearest in size to the target's.
pub fn sprite_lod(sprite_size: f32, diameter_in_texels: f32) -> f32 {
    ((sprite_size / diameter_in_texels.max(1.0e-3)).log2() + 0.5).floor().max(0.0)
}

/// The fractional frame that a particle shows: its own, its age through the slices of a volume texture, or the first.
/// `nearest` is cut off, so it is half a frame on.
pub fn sprite_frame(animation: SpriteAnimation, frame: f32, age: f32, frame_count: f32) -> f32 {
    match animation {
        SpriteAnimation::Flipbook => frame,
        SpriteAnimation::Volume => saturate(age) * (frame_count - 1.0),
        SpriteAnimation::Still => 0.0,
        SpriteAnimation::Nearest => frame + 0.5,
    }
}

/// The two frames that a fractional frame blends, and the share of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlipbookFrames {
    /// Index of the frame shown.
    pub first: i32,
    /// Index of the frame after it.
    pub second: i32,
    /// 0 shows the first, 1 the second.
    pub blend: f32,
}

/// Splits a fractional frame; the flipbook repeats.
pub fn flipbook_frames(frame: f32, frame_count: f32) -> FlipbookFrames {
    let wrapped = frame - (frame / frame_count).floor() * frame_count;
    let first = wrapped.floor().max(0.0).min(frame_count - 1.0);
    let second = if first + 1.5 > frame_count { 0.0 } else { first + 1.0 };
    FlipbookFrames { first: first as i32, second: second as i32, blend: saturate(wrapped - first) }
}

/// The same frames of a flipbook that comes `layers` later.
pub fn frames_after(frames: FlipbookFrames, layers: i32) -> FlipbookFrames {
    FlipbookFrames { first: frames.first + layers, second: frames.second + layers, ..frames }
}

/// The frames as an animation shows them: some blend none.
pub fn shown_frames(animation: SpriteAnimation, frame: f32, frame_count: f32) -> FlipbookFrames {
    let frames = flipbook_frames(frame, frame_count);
    match animation {
        SpriteAnimation::Flipbook | SpriteAnimation::Volume => frames,
        SpriteAnimation::Still | SpriteAnimation::Nearest => FlipbookFrames { blend: 0.0, ..frames },
    }
}

fn load_sprite_bilinear(sprite: &impl Texture2dArray, uv: Vec2, frame: i32, level: u32) -> Vec4 {
    let size = sprite.dimensions(level) as i32;
    let texel = uv * size as f32 - 0.5;
    let base = texel.floor();
    let fraction = texel - base;
    let limit = |texel: IVec2| texel.clamp(IVec2::ZERO, IVec2::splat(size - 1)).as_uvec2();
    let (low, high) = (limit(base.as_ivec2()), limit(base.as_ivec2() + 1));
    let load = |x, y| sprite.load(UVec2::new(x, y), frame as u32, level);
    let top = load(low.x, low.y).lerp(load(high.x, low.y), fraction.x);
    let bottom = load(low.x, high.y).lerp(load(high.x, high.y), fraction.x);
    top.lerp(bottom, fraction.y)
}

fn sample_sprite_frame(sprite: &impl Texture2dArray, uv: Vec2, frame: i32, lod: f32) -> Vec4 {
    let last = (sprite.level_count() - 1) as f32;
    let level = lod.min(last);
    let base = level.floor();
    let fine = load_sprite_bilinear(sprite, uv, frame, base as u32);
    let coarse = load_sprite_bilinear(sprite, uv, frame, (base + 1.0).min(last) as u32);
    fine.lerp(coarse, level - base)
}

/// A flipbook at a moment between two frames. uv 0..1, v down. `motion` is where texels go from the first frame to the second, in
/// uv.
pub fn sample_flipbook(sprite: &impl Texture2dArray, uv: Vec2, frames: FlipbookFrames, motion: Vec2, lod: f32) -> Vec4 {
    let mut texel = sample_sprite_frame(sprite, uv - motion * frames.blend, frames.first, lod);
    if frames.blend > 0.0 {
        let place = uv + motion * (1.0 - frames.blend);
        // Exact where both are one.
        texel += (sample_sprite_frame(sprite, place, frames.second, lod) - texel) * frames.blend;
    }
    texel
}

/// Normal (−1..1, about unit length) and amount of a sprite.
pub fn sample_sprite(sprite: &impl Texture2dArray, uv: Vec2, frames: FlipbookFrames, motion: Vec2, lod: f32) -> Vec4 {
    let texel = sample_flipbook(sprite, uv, frames, motion, lod);
    (texel.xyz() * 2.0 - 1.0).extend(texel.w)
}

/// A detail map's texel: how far it stands out towards the viewer, −1..1 radii, and its motion to the next frame, in uv.
pub fn detail_from_texel(texel: Vec3) -> Vec3 {
    (texel * 255.0 - 128.0) / 127.0 * Vec3::new(1.0, MOTION_RANGE, MOTION_RANGE)
}

/// The detail map at a moment between two frames. Motion is the first frame's.
pub fn sample_detail(detail: &impl Texture2dArray, uv: Vec2, frames: FlipbookFrames, lod: f32) -> Vec3 {
    let sample = |frame| detail_from_texel(sample_sprite_frame(detail, uv, frame, lod).xyz());
    let (first, second) = (sample(frames.first), sample(frames.second));
    Vec3::new(first.x + (second.x - first.x) * frames.blend, first.y, first.z)
}

/// Undoes a sprite's rotation, (cos, sin).
pub fn unrotate(offset: Vec2, rotation: Vec2) -> Vec2 {
    Vec2::new(offset.x * rotation.x + offset.y * rotation.y, offset.y * rotation.x - offset.x * rotation.y)
}

/// A corner, −1..1 with y up, of what a sprite reaches of its square from the middle: left, down, right, up, as shares of half a side.
pub fn trimmed_corner(corner: Vec2, reach: Vec4) -> Vec2 {
    Vec2::select(corner.cmpgt(Vec2::ZERO), reach.zw(), -reach.xy())
}

/// Place in the picture, 0..1 with v down, of a place on the sprite, -1..1 with y up.
pub fn sprite_uv(corner: Vec2) -> Vec2 {
    Vec2::new(corner.x * 0.5 + 0.5, 0.5 - corner.y * 0.5)
}

/// NV's debug sprite: eight by eight checks, every other one of a quarter of the amount.
pub fn checkerboard(uv: Vec2) -> Vec4 {
    let check = (uv * 8.0).floor().as_ivec2();
    Vec4::new(0.0, 0.0, 1.0, if (check.x + check.y) & 1 == 0 { 1.0 } else { 0.25 })
}
