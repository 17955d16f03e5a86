//! `shaders/accumulate.wgsl`.

use glam::{Vec4, Vec4Swizzles};

use crate::assets::picture::Picture;
use crate::formula::normal::accumulation_from_normal;
use crate::in_view::Grid;
use crate::reference::blend_unit::{premultiplied_over, quantise, weighted_sum};
use crate::reference::draw::Draw;
use crate::settings::{AccumulationFormat, Order};

impl Draw<'_> {
    pub fn accumulate(&self, reduced_depth: &Picture<f32>, overdraw: bool) -> Picture<Vec4> {
        let accumulate = &self.settings.accumulate;
        self.blend(reduced_depth, |fragment, weight, texel| {
            let blended = if overdraw {
                texel + Vec4::splat(1.0 / 255.0)
            } else {
                let source = accumulation_from_normal(accumulate.encoding, fragment.xyz(), fragment.w, weight);
                match self.settings.order() {
                    Order::Sorted => premultiplied_over(source, texel),
                    Order::Weighted => weighted_sum(source, texel),
                }
            };
            quantise(accumulate.format, blended)
        })
    }

    /// What the weights of the normals sum to, in x, where it is kept.
    pub fn weight_sum(&self, reduced_depth: &Picture<f32>) -> Option<Picture<Vec4>> {
        let sum = |fragment: Vec4, weight, texel| {
            quantise(AccumulationFormat::Rgba16Float, weighted_sum(Vec4::X * (fragment.w * weight), texel))
        };
        self.settings.accumulate.sums_weights().then(|| self.blend(reduced_depth, sum))
    }

    /// Blends `f(normal and amount, weight, texel)` of every fragment into a target.
    fn blend(&self, reduced_depth: &Picture<f32>, f: impl Fn(Vec4, f32, Vec4) -> Vec4 + Sync) -> Picture<Vec4> {
        let mut target = Picture::new(self.in_view.rect.size, Vec4::ZERO);
        let origin = self.in_view.rect.origin.as_vec2();
        let scene = |at| reduced_depth.load(at);
        target.for_bands(|first_row, band| {
            let grid = Grid { origin, scale: self.system.scale, size: self.in_view.rect.size };
            self.for_fragments(&grid, first_row, band, scene, |_, sprite, fragment, texel: &mut Vec4| {
                *texel = f(fragment, sprite.weight, *texel);
            });
        });
        target
    }
}
