//! Lit target of a system, read at full resolution. WGSL: `shaders/lib/lit_target.wgsl`.

use glam::{IVec2, Mat4, Vec2, Vec4};
use haze_core::formula::upsample::{
    carried_value, four_texels_weight, guided_weight, surface_weights, upsample_weights,
};
use haze_core::settings::Upsample;

use super::accumulated::AccumulatedTarget;

impl AccumulatedTarget<'_> {
    /// Samples the lit smoke at a pixel of the view.
    pub fn sample_lit(&self, pixel: Vec2) -> Vec4 {
        match &self.lit {
            Some(lit) => self.sample_carried(|at| lit.light.load(at), |at| lit.slopes.load(at), pixel),
            None => {
                self.sample_carried(|at| self.lit_texel(at), |at| self.slope_texel(|at| self.lit_texel(at), at), pixel)
            }
        }
    }

    /// `sample_lit()` in lit_target.wgsl. `light` and `slope` return texels of the two textures.
    fn sample_carried(&self, light: impl Fn(IVec2) -> Vec4, slope: impl Fn(IVec2) -> Vec4, pixel: Vec2) -> Vec4 {
        let system = &self.visible.system;
        if self.visible.settings.accumulate.upsample != Upsample::Guided || system.scale == 1 {
            return self.sample_texels(light, pixel);
        }
        let texel = pixel / system.scale as f32 - system.target_origin;
        if texel.cmplt(Vec2::ZERO).any() || texel.cmpge(system.target_size).any() {
            return Vec4::ZERO;
        }
        let corner = texel - 0.5;
        let base = corner.floor().as_ivec2();
        let fraction = corner - corner.floor();
        let taps = [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].map(|offset| base + offset);
        let columns = |[a, b, c, d]: [Vec4; 4]| Mat4::from_cols(a, b, c, d);
        let values = columns(taps.map(&light));
        let slopes = columns(taps.map(slope));
        if slopes == Mat4::ZERO {
            return values * upsample_weights(Upsample::Bilinear, fraction, Vec4::ZERO, 0.0);
        }
        let depths = Vec4::from(taps.map(|tap| self.guide(tap)));
        let depth = self.visible.scene_view_depth(pixel.as_ivec2()).min(system.smoke_depth_limit);
        let weights = surface_weights(fraction, depths, depth);
        let four = carried_value(weights, values, slopes, depths, depth, 1.0 / system.fade_scale);
        let weight = four_texels_weight(weights.element_sum());
        self.mean_of_sixteen(light, base, fraction, depth).lerp(four, weight)
    }

    /// Mean of the sixteen texels around a pixel, mostly of those near its depth.
    pub fn mean_of_sixteen(&self, light: impl Fn(IVec2) -> Vec4, base: IVec2, fraction: Vec2, depth: f32) -> Vec4 {
        let (sum, total) = (0..16).fold((Vec4::ZERO, 0.0), |(sum, total), i| {
            let offset = IVec2::new(i % 4, i / 4) - 1;
            let at = base + offset;
            let weight = guided_weight((offset.as_vec2() - fraction).extend(self.guide(at) - depth), depth);
            (sum + light(at) * weight, total + weight)
        });
        sum / total
    }
}
