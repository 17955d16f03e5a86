//! `shaders/accumulate.wgsl`.

use glam::{Vec4, Vec4Swizzles};

use crate::assets::picture::Picture;
use crate::formula::normal::accumulation_from_normal;
use crate::reference::blend_unit::{premultiplied_over, quantise};
use crate::reference::draw::Draw;
use crate::reference::sprite::Grid;

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
}
