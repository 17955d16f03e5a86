//! `shaders/forward.wgsl`.

use glam::{Vec2, Vec4, Vec4Swizzles};

use super::accumulate::Grid;
use crate::reference::blending::{forward_blend, forward_fragment};
use crate::reference::lighting::coverage;
use crate::reference::picture::Picture;
use crate::reference::renderer::Draw;

impl Draw<'_> {
    pub fn forward(&self, picture: &mut Picture<Vec4>) {
        let grid = Grid { origin: Vec2::ZERO, scale: 1.0, size: picture.size };
        let mode = self.settings.blend_mode;
        picture.for_bands(|first_row, band| {
            self.for_fragments(&grid, first_row, band, |at, sprite, uv, texel: &mut Vec4| {
                let fade = self.soft_fade(self.scene_view_depth(at) - sprite.view_depth);
                let fragment = self.sprite_fragment(sprite, uv);
                let amount = fragment.w * fade;
                if amount <= 0.0 {
                    return;
                }
                let normal = fragment.xyz() / fragment.xyz().length_squared().max(1.0e-12).sqrt();
                let position = self.view_position(at.as_vec2() + 0.5, sprite.view_depth);
                let diffuse = self.diffuse_from_lights(normal, position) * self.system.diffuse_intensity;
                let light = diffuse + self.soft_scatter(amount);
                let source = forward_fragment(mode, light, coverage(amount, self.system.boost));
                *texel = forward_blend(mode, source, *texel);
            });
        });
    }
}
