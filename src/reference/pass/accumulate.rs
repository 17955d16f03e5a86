//! `shaders/accumulate.wgsl` and `shaders/lib/sprite_vertex.wgsl`.

use glam::{IVec2, UVec2, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};

use crate::particle::Particle;
use crate::reference::blending::{premultiplied_over, quantise};
use crate::reference::normal::{accumulation_from_normal, rotate_normal};
use crate::reference::picture::Picture;
use crate::reference::renderer::Draw;
use crate::reference::soft_fade::{near_fade, soft_fade};
use crate::reference::sprite::{FlipbookFrames, flipbook_frames, sample_sprite, sprite_lod};

/// A sprite in view space.
pub struct SpriteSetup {
    pub centre: Vec3,
    pub view_depth: f32,
    pub radius: f32,
    pub rotation: Vec2,
    pub amount: f32,
    pub lod: f32,
    pub frames: FlipbookFrames,
}

/// The texels that sprites are drawn on: texel (i, j) is the pixels from (origin + (i, j)) · scale.
pub struct Grid {
    pub origin: Vec2,
    pub scale: f32,
    pub size: UVec2,
}

impl Draw<'_> {
    pub fn accumulate(&self, reduced_depth: &Picture<f32>, overdraw: bool) -> Picture<Vec4> {
        let mut accumulation = Picture::new(self.in_view.rect.size, Vec4::ZERO);
        let accumulate = &self.settings.accumulate;
        let origin = self.in_view.rect.origin.as_vec2();
        accumulation.for_bands(|first_row, band| {
            let grid = Grid { origin, scale: self.system.scale, size: self.in_view.rect.size };
            self.for_fragments(&grid, first_row, band, |at, sprite, uv, texel: &mut Vec4| {
                let distance = reduced_depth.load(at) - sprite.view_depth;
                let fade = self.soft_fade(distance);
                if fade <= 0.0 {
                    return;
                }
                let blended = if overdraw {
                    *texel + Vec4::splat(1.0 / 255.0)
                } else {
                    let fragment = self.sprite_fragment(sprite, uv);
                    let amount = fragment.w * fade;
                    let source = accumulation_from_normal(accumulate.encoding, fragment.xyz(), amount);
                    premultiplied_over(source, *texel)
                };
                *texel = quantise(accumulate.format, blended);
            });
        });
        accumulation
    }

    pub fn soft_fade(&self, distance: f32) -> f32 {
        let system = &self.system;
        let curve = self.settings.soft_fade.curve;
        soft_fade(curve, distance, system.fade_scale, system.contrast_power, system.epsilon)
    }

    /// Calls `f(texel position, sprite, uv, texel)` for every fragment of every sprite in a band of rows, in order.
    pub fn for_fragments<T>(
        &self,
        grid: &Grid,
        first_row: u32,
        band: &mut [T],
        f: impl Fn(IVec2, &SpriteSetup, Vec2, &mut T),
    ) {
        let width = grid.size.x as i32;
        let rows = band.len() as i32 / width;
        let (top, bottom) = (first_row as i32, first_row as i32 + rows);
        for particle in &self.particles {
            let Some(sprite) = self.sprite_setup(particle, 1.0 / grid.scale) else { continue };
            // Half the diagonal holds the sprite at every rotation.
            let reach = Vec2::splat(sprite.radius * std::f32::consts::SQRT_2);
            let corner = |sign: f32| {
                let position = (sprite.centre.xy() + reach * sign).extend(sprite.centre.z);
                self.pixel_from_view(position) / grid.scale - grid.origin
            };
            let (a, b) = (corner(-1.0), corner(1.0));
            let min = a.min(b).floor().as_ivec2().max(IVec2::new(0, top));
            let max = a.max(b).ceil().as_ivec2().min(IVec2::new(width, bottom));
            for y in min.y..max.y {
                for x in min.x..max.x {
                    let at = IVec2::new(x, y);
                    let pixel = (at.as_vec2() + 0.5 + grid.origin) * grid.scale;
                    let offset = self.view_position(pixel, sprite.view_depth) - sprite.centre;
                    // Undo the sprite's rotation.
                    let local = Vec2::new(
                        offset.x * sprite.rotation.x + offset.y * sprite.rotation.y,
                        offset.y * sprite.rotation.x - offset.x * sprite.rotation.y,
                    ) / sprite.radius;
                    if local.abs().max_element() <= 1.0 {
                        let uv = Vec2::new(local.x * 0.5 + 0.5, 0.5 - local.y * 0.5);
                        f(at, &sprite, uv, &mut band[((y - top) * width + x) as usize]);
                    }
                }
            }
        }
    }

    /// `sprite_vertex()` in sprite_vertex.wgsl; `None` when the sprite is hidden.
    pub fn sprite_setup(&self, particle: &Particle, texels_per_pixel: f32) -> Option<SpriteSetup> {
        let system = &self.system;
        let centre = self.view.view_from_world.transform_point3(particle.position);
        let view_depth = -centre.z;
        let amount =
            particle.amount * system.opacity * near_fade(view_depth, system.near_fade_start, system.near_fade_end);
        let visible =
            view_depth > self.view.near && view_depth < self.view.far && particle.radius > 0.0 && amount > 0.0;
        visible.then(|| SpriteSetup {
            centre,
            view_depth,
            radius: particle.radius,
            rotation: Vec2::new(particle.rotation.cos(), particle.rotation.sin()),
            amount,
            lod: sprite_lod(
                system.sprite_size,
                2.0 * particle.radius * self.pixels_per_metre(view_depth) * texels_per_pixel,
            ),
            frames: flipbook_frames(particle.frame, system.frame_count),
        })
    }

    /// Normal (view space) and amount, before the soft fade. `sprite_fragment()` in sprite_vertex.wgsl.
    pub fn sprite_fragment(&self, sprite: &SpriteSetup, uv: Vec2) -> Vec4 {
        let texel = sample_sprite(&self.material.sprite, uv, sprite.frames, sprite.lod);
        let normal = rotate_normal(texel.xyz(), sprite.rotation);
        normal.extend(texel.w * sprite.amount)
    }
}
