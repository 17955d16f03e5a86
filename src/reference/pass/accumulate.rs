//! `shaders/accumulate.wgsl`.

use glam::{IVec2, UVec2, Vec2, Vec4, Vec4Swizzles};

use crate::reference::blending::{premultiplied_over, quantise};
use crate::reference::normal::accumulation_from_normal;
use crate::reference::picture::Picture;
use crate::reference::renderer::Draw;
use crate::reference::sprite_fragment::SpriteSetup;

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
        let scene = |at| reduced_depth.load(at);
        accumulation.for_bands(|first_row, band| {
            let grid = Grid { origin, scale: self.system.scale, size: self.in_view.rect.size };
            self.for_fragments(&grid, first_row, band, scene, |_, _, fragment, texel: &mut Vec4| {
                let blended = if overdraw {
                    *texel + Vec4::splat(1.0 / 255.0)
                } else {
                    let source = accumulation_from_normal(accumulate.encoding, fragment.xyz(), fragment.w);
                    premultiplied_over(source, *texel)
                };
                *texel = quantise(accumulate.format, blended);
            });
        });
        accumulation
    }

    /// Calls `f(texel position, sprite, normal and amount, texel)` for every fragment of every sprite in a band of rows,
    /// in order. `scene` is the scene's view depth at a texel.
    pub fn for_fragments<T>(
        &self,
        grid: &Grid,
        first_row: u32,
        band: &mut [T],
        scene: impl Fn(IVec2) -> f32,
        f: impl Fn(IVec2, &SpriteSetup, Vec4, &mut T),
    ) {
        let width = grid.size.x as i32;
        let rows = band.len() as i32 / width;
        let (top, bottom) = (first_row as i32, first_row as i32 + rows);
        let loops = 0..self.settings.sprite.debug_loop;
        for particle in loops.flat_map(|_| &self.particles) {
            let Some(sprite) = self.sprite_setup(particle, 1.0 / grid.scale) else { continue };
            let texel = |pixel: Vec2| pixel / grid.scale - grid.origin;
            let min = texel(sprite.min).floor().as_ivec2().max(IVec2::new(0, top));
            let max = texel(sprite.max).ceil().as_ivec2().min(IVec2::new(width, bottom));
            for y in min.y..max.y {
                for x in min.x..max.x {
                    let at = IVec2::new(x, y);
                    let pixel = (at.as_vec2() + 0.5 + grid.origin) * grid.scale;
                    if let Some(fragment) = self.technique_fragment(&sprite, pixel, scene(at)) {
                        f(at, &sprite, fragment, &mut band[((y - top) * width + x) as usize]);
                    }
                }
            }
        }
    }
}
