//! CPU version of `shaders/forward.wgsl`.

use glam::{Vec2, Vec4};
use haze_core::assets::image::Image;
use haze_core::formula::blending::forward_fragment;
use haze_core::formula::color::bounded_light;
use haze_core::formula::fire::fire_from_moments;
use haze_core::formula::lighting::coverage;
use haze_core::view_setup::TexelGrid;

use crate::blend_unit::forward_blend;
use crate::shade::Shade;
use crate::visible_system::VisibleSystem;

impl VisibleSystem<'_> {
    /// Lights and blends every sprite over the image.
    pub fn forward(&self, image: &mut Image<Vec4>) {
        let grid = TexelGrid { origin: Vec2::ZERO, scale: 1.0, size: image.size };
        let mode = self.settings.blend_mode;
        let system = &self.system;
        image.for_bands(|first_row, band| {
            let scene = |at| self.scene_view_depth(at);
            self.for_fragments(&grid, first_row, band, scene, |at, sprite, fragment, texel: &mut Vec4| {
                let amount = fragment.amount;
                if amount <= 0.0 {
                    return;
                }
                let normal = fragment.normal / fragment.normal.length_squared().max(1.0e-12).sqrt();
                let position = self.view_position(at.as_vec2() + 0.5, sprite.view_depth.max(self.view.near));
                let covered = coverage(amount, system.boost);
                let mut shade = Shade::of_sprites(sprite.optical_depths);
                if self.settings.receives_shadow_by_depth() {
                    let moments = self.moments_of_sprite(sprite.view_depth, sprite.radius);
                    let pixel = at.as_vec2() + 0.5;
                    shade = self.shade_on_ray(sprite.optical_depths, pixel, moments);
                }
                let diffuse = match self.settings.is_six_way() {
                    true => self.diffuse_from_six_way(&fragment.six_way, position, &shade),
                    false => self.diffuse_from_lights(normal, covered, position, &shade),
                };
                let diffuse = diffuse * system.diffuse_intensity;
                let mut light = (diffuse + self.soft_scatter(amount)) * sprite.tint;
                if self.settings.burns() {
                    let heat = self.fragment_heat(&fragment, sprite.heat);
                    light += self.emission(fire_from_moments(Vec2::new(heat, heat * heat)), amount);
                }
                let source = forward_fragment(mode, bounded_light(light), covered);
                *texel = forward_blend(mode, source, *texel);
            });
        });
    }
}
