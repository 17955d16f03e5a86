//! CPU version of `shaders/accumulate.wgsl`.

use glam::Vec4;

use crate::blend_unit::{premultiplied_over, quantise, weighted_sum};
use crate::sprite::SpriteFragment;
use crate::visible_system::VisibleSystem;
use haze::assets::image::Image;
use haze::formula::normal::accumulation_from_normal;
use haze::settings::{AccumulationFormat, BlendOrder};
use haze::view_setup::TexelGrid;

impl VisibleSystem<'_> {
    /// Returns the accumulation target. `overdraw`: counts layers instead, in steps of 1/255.
    pub fn accumulate(&self, reduced_depth: &Image<f32>, overdraw: bool) -> Image<Vec4> {
        let accumulate = &self.settings.accumulate;
        self.blend(reduced_depth, |fragment, weight, texel| {
            let SpriteFragment { normal, six_way, amount } = fragment;
            let blended = if overdraw {
                texel + Vec4::splat(1.0 / 255.0)
            } else {
                let source = if self.settings.is_six_way() {
                    (six_way.positive * (amount * weight)).extend(amount)
                } else {
                    accumulation_from_normal(accumulate.encoding, normal, amount, weight)
                };
                match self.settings.order() {
                    BlendOrder::Sorted => premultiplied_over(source, texel),
                    BlendOrder::Weighted => weighted_sum(source, texel),
                }
            };
            quantise(accumulate.format, blended)
        })
    }

    /// Second target: the sum of the normals' weights in x; or, for six-way maps, light from left, bottom and back, and
    /// the sum of weights.
    pub fn extra_attachment(&self, reduced_depth: &Image<f32>) -> Option<Image<Vec4>> {
        let accumulate = &self.settings.accumulate;
        if self.settings.is_six_way() {
            let light = |fragment: SpriteFragment, weight: f32, texel: Vec4| {
                let weight = fragment.amount * weight;
                let source = (fragment.six_way.negative * weight).extend(weight);
                let blended = match self.settings.order() {
                    BlendOrder::Sorted => premultiplied_over(source, texel),
                    BlendOrder::Weighted => source + texel,
                };
                quantise(accumulate.format, blended)
            };
            return Some(self.blend(reduced_depth, light));
        }
        let sum = |fragment: SpriteFragment, weight: f32, texel| {
            quantise(AccumulationFormat::Rgba16Float, weighted_sum(Vec4::X * (fragment.amount * weight), texel))
        };
        accumulate.sums_weights().then(|| self.blend(reduced_depth, sum))
    }

    /// Blends `f(fragment, weight, texel)` of every fragment into a target.
    fn blend(&self, reduced_depth: &Image<f32>, f: impl Fn(SpriteFragment, f32, Vec4) -> Vec4 + Sync) -> Image<Vec4> {
        let mut target = Image::new(self.setup.rect.size, Vec4::ZERO);
        let origin = self.setup.rect.origin.as_vec2();
        let scene = |at| reduced_depth.load(at);
        target.for_bands(|first_row, band| {
            let grid = TexelGrid { origin, scale: self.system.scale, size: self.setup.rect.size };
            self.for_fragments(&grid, first_row, band, scene, |_, sprite, fragment, texel: &mut Vec4| {
                *texel = f(fragment, sprite.weight, *texel);
            });
        });
        target
    }
}
