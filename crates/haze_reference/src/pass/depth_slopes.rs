//! CPU version of `shaders/depth_slopes.wgsl`.

use glam::{IVec2, Vec4};
use haze_core::assets::image::Image;
use haze_core::formula::upsample::{DepthLine, add_to_line, depth_slope, guided_weight, is_shallow};
use haze_core::settings::AccumulationFormat;

use crate::accumulated::AccumulatedTarget;
use crate::blend_unit::quantise;

impl AccumulatedTarget<'_> {
    /// Change of the lit smoke with depth around each texel.
    pub fn depth_slopes(&self, light: &Image<Vec4>) -> Image<Vec4> {
        let mut slopes = Image::new(light.size, Vec4::ZERO);
        slopes.for_each(|at, texel| *texel = self.slope_texel(|at| light.load(at), at.as_ivec2()));
        slopes
    }

    /// Texel of the slopes. `light` returns texels of the lit target. Positions outside are clamped to the nearest texel
    /// inside.
    pub fn slope_texel(&self, light: impl Fn(IVec2) -> Vec4, at: IVec2) -> Vec4 {
        let at = at.clamp(IVec2::ZERO, self.visible.setup.rect.size.as_ivec2() - 1);
        let depth = self.guide(at);
        let fade = 1.0 / self.visible.system.fade_scale;
        let cross = [IVec2::NEG_X, IVec2::ZERO, IVec2::X, IVec2::NEG_Y, IVec2::Y];
        let depths = cross.map(|offset| self.guide(at + offset));
        let (nearest, farthest) = depths.iter().fold((depth, depth), |(low, high), &d| (low.min(d), high.max(d)));
        if is_shallow(nearest, farthest, fade) {
            return Vec4::ZERO;
        }
        let line = cross.iter().zip(depths).fold(DepthLine::default(), |line, (&offset, around)| {
            let z = around - depth;
            add_to_line(&line, z, guided_weight(offset.as_vec2().extend(z), depth), light(at + offset))
        });
        quantise(AccumulationFormat::Rgba16Float, depth_slope(&line, fade))
    }
}
