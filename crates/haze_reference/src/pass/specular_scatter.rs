//! CPU version of `shaders/specular_scatter.wgsl`.

use glam::{Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::color::bounded_light;
use haze_core::formula::depth::SKY_VIEW_DEPTH;
use haze_core::formula::lighting::{
    VISIBILITY_TAPS, cone_attenuation, direction_to_viewer, glow_falloff, range_window, specular_scatter_fade,
    visibility_tap,
};
use haze_core::formula::ramp::sample_ramp_2d;
use haze_core::formula::uniforms::LightUniform;
use haze_core::formula::view::{pixel_from_ndc, pixels_per_metre};

use crate::accumulated::AccumulatedTarget;

/// Quad of a light that glows.
pub struct GlowQuad<'a> {
    light: &'a LightUniform,
    /// Pixels.
    center: Vec2,
    /// Before the specular ramp and the range are applied.
    color: Vec3,
}

impl AccumulatedTarget<'_> {
    /// Adds the glow of all lights to the image.
    pub fn specular_scatter(&self, image: &mut Image<Vec4>) {
        for glow in self.visible.lights.iter().filter_map(|light| self.glow_quad(light)) {
            image.for_each(|at, texel| {
                if let Some((_, specular)) = self.sample_glow(&glow, at.as_vec2() + 0.5) {
                    *texel += specular.extend(0.0);
                }
            });
        }
    }

    /// Quad of the light, if any of it is visible.
    pub fn glow_quad<'a>(&self, light: &'a LightUniform) -> Option<GlowQuad<'a>> {
        let visible = self.visible;
        let size = visible.system.specular_scatter_size;
        let view = &visible.view;
        let directional = light.directional > 0.5;
        let homogeneous = if directional { (-light.direction).extend(0.0) } else { light.position.extend(1.0) };
        let clip = view.clip_from_view * homogeneous;
        let depth = if directional { SKY_VIEW_DEPTH } else { -light.position.z };
        let fade = specular_scatter_fade(depth, visible.system.smoke_near, visible.system.smoke_far);
        let cone = cone_attenuation(light, direction_to_viewer(light.position, view.orthographic));
        let to_smoke = visible.system.center - light.position;
        let falloff = if directional { 0.0 } else { visible.system.specular_scatter_falloff };
        let arriving = glow_falloff(to_smoke.length_squared(), light.radius, falloff);
        let strength = light.specular_scatter * visible.system.specular_scatter_intensity * fade * cone * arriving;
        if clip.w <= 0.0 || depth <= view.near || strength <= 0.0 {
            return None;
        }
        let center = pixel_from_ndc(clip.xy() / clip.w, view.size);
        if (center - 0.5 * view.size).abs().cmpgt(0.5 * view.size + size).any() {
            return None;
        }
        let body = (light.radius * pixels_per_metre(view.size.y, view.ray_scale.y, depth, view.orthographic)).max(1.5);
        let compared_depth = (depth - 2.0 * light.radius).min(0.99 * view.far);
        let visibility = self.light_visibility(center, body, compared_depth);
        (visibility > 0.0).then(|| GlowQuad { light, center, color: light.color * strength * visibility })
    }

    /// Lookup coordinate of the specular ramp at a pixel, and the light found there; `None` outside the quad and where
    /// there is no smoke.
    pub fn sample_glow(&self, glow: &GlowQuad<'_>, pixel: Vec2) -> Option<(Vec2, Vec3)> {
        let visible = self.visible;
        let uv = (pixel - glow.center) / visible.system.specular_scatter_size;
        let distance_squared = uv.length_squared();
        if distance_squared >= 1.0 {
            return None;
        }
        let amount = if self.is_lit { self.sample_lit(pixel).w } else { self.sample_accumulated(pixel).w };
        // A coarse target may have smoke at a thin surface that is in front of all smoke.
        let is_in_front =
            visible.system.scale > 1 && visible.scene_view_depth(pixel.floor().as_ivec2()) < visible.system.smoke_near;
        if amount <= 0.0 || is_in_front {
            return None;
        }
        let coordinate = Vec2::new(distance_squared, amount);
        let found = sample_ramp_2d(&visible.material.specular_ramp, visible.settings.ramp_filter, coordinate);
        let to_light = glow.light.position - visible.view_position(pixel, -visible.system.center.z);
        let window = range_window(to_light.length_squared(), glow.light.inverse_range);
        Some((coordinate, bounded_light(found * glow.color * window)))
    }

    /// Fraction of a light's body that the scene leaves visible.
    pub fn light_visibility(&self, pixel: Vec2, radius: f32, light_depth: f32) -> f32 {
        let visible = |i: u32| {
            self.visible.scene_view_depth((pixel + visibility_tap(i, radius)).floor().as_ivec2()) >= light_depth
        };
        (0..VISIBILITY_TAPS).filter(|&i| visible(i)).count() as f32 / VISIBILITY_TAPS as f32
    }
}
