//! CPU version of `shaders/light_target.wgsl`.

use glam::{IVec2, Vec4};
use haze_core::assets::image::Image;
use haze_core::formula::color::bounded_light;
use haze_core::settings::AccumulationFormat;

use crate::accumulated::AccumulatedTarget;
use crate::blend_unit::quantise;

impl AccumulatedTarget<'_> {
    /// Lit target: light times amount, and amount.
    pub fn light_target(&self) -> Image<Vec4> {
        let mut lit = Image::new(self.visible.setup.rect.size, Vec4::ZERO);
        lit.for_each(|at, texel| *texel = self.lit_texel(at.as_ivec2()));
        lit
    }

    /// Texel of the lit target. Positions outside are clamped to the nearest texel inside.
    pub fn lit_texel(&self, at: IVec2) -> Vec4 {
        let visible = self.visible;
        let system = &self.visible.system;
        let at = at.clamp(IVec2::ZERO, visible.setup.rect.size.as_ivec2() - 1);
        let accumulated = self.first_texture().map_or(Vec4::ZERO, |texture| texture.load(at));
        let amount = accumulated.w;
        if amount <= 0.0 {
            return Vec4::ZERO;
        }
        let pixel = (at.as_vec2() + system.target_origin + 0.5) * system.scale as f32;
        let surface = self.shaded_surface(&self.attachments(accumulated, |texture| texture.load(at)), pixel);
        let position = self.lit_position(&surface, pixel);
        let reflected = self.diffuse(&surface, amount, position) + visible.soft_scatter(amount) * surface.tint;
        let light = bounded_light(reflected + self.fire_light(&surface, amount));
        quantise(AccumulationFormat::Rgba16Float, light.extend(1.0) * amount)
    }
}
