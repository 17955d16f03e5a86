//! CPU version of `shaders/screen_shadow.wgsl`.

use glam::{IVec2, Mat4, UVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::depth::{SKY_VIEW_DEPTH, view_depth_from_ndc_depth};
use haze_core::formula::lighting::sample_light;
use haze_core::formula::screen_shadow::{fraction_of_light, scene_normal};
use haze_core::formula::shadow::LIGHTS_PER_BLOCK;
use haze_core::formula::uniforms::{LightUniform, ShadowMapUniform, ViewUniform};
use haze_core::formula::view::{ndc_from_pixel, pixels_per_metre, view_position};
use haze_core::view_setup::{SmokeShadow, ViewGeometry, scene_light_uniforms};

use super::shadow_visibility::map_visibility;
use crate::input::FrameInput;
use crate::scene_shadow::SceneShadow;

/// Shadow of a frame's smoke on an image of the scene.
pub struct ScreenShadow<'a> {
    view: ViewUniform,
    world_from_view: Mat4,
    scene_depth: &'a Image<f32>,
    ambient: Vec3,
    /// View space.
    lights: Vec<LightUniform>,
    /// Maps of the first block of lights.
    maps: [(ShadowMapUniform, &'a [Image<f32>]); LIGHTS_PER_BLOCK],
    world_from_grid: Mat4,
}

impl<'a> ScreenShadow<'a> {
    /// `None` if the frame does not ask for it.
    pub fn new(frame: &FrameInput<'a>, view: &ViewGeometry, shadow: &SmokeShadow) -> Option<Self> {
        let ambient = frame.scene_ambient?;
        let mut lights = Vec::new();
        scene_light_uniforms(view, frame.lights, shadow, &mut lights);
        let of_light = |light: usize| frame.shadow_maps.iter().find(|map| map.projection.light == light);
        let visibility = shadow.visibility(0, |light| of_light(light).map(|map| map.projection));
        let layers = shadow.lights_of_block(0).map(|light| light.and_then(of_light).map_or(&[][..], |map| map.layers));
        Some(Self {
            view: view.uniform(false),
            world_from_view: view.view_from_world.inverse(),
            scene_depth: frame.scene_depth,
            ambient,
            lights,
            maps: std::array::from_fn(|slot| (visibility.maps[slot], layers[slot])),
            world_from_grid: shadow.world_from_grid(),
        })
    }

    /// Multiplies every pixel by the fraction of its light that is left.
    pub fn shade(&self, shadow: &SceneShadow, image: &mut Image<Vec4>) {
        let grid_from_world = self.world_from_grid.inverse();
        image.for_each(|at, texel| {
            let at = at.as_ivec2();
            let point = self.scene_point(at);
            if -point.z >= SKY_VIEW_DEPTH {
                return;
            }
            let beside = |x, y| self.scene_point(at + IVec2::new(x, y));
            let normal = scene_normal(point, beside(-1, 0), beside(1, 0), beside(0, -1), beside(0, 1));
            let world = self.world_from_view.transform_point3(point);
            let ViewUniform { size, ray_scale, orthographic, .. } = self.view;
            let pixels = pixels_per_metre(size.y, ray_scale.y, -point.z, orthographic);
            let above = self.world_from_view.transform_point3(point + normal * (2.0 / pixels));
            let mut full = self.ambient;
            let mut shaded = self.ambient;
            for (index, light) in self.lights.iter().enumerate() {
                let sample = sample_light(light, point);
                let facing = sample.attenuation * normal.dot(sample.direction).clamp(0.0, 1.0);
                if facing <= 0.0 {
                    continue;
                }
                let slot = (light.shadow_slot as usize).wrapping_sub(1);
                let visible = self
                    .maps
                    .get(slot)
                    .map_or(1.0, |(map, layers)| map_visibility(map, layers, grid_from_world.transform_point3(above)));
                let arriving = light.color * (facing * visible);
                full += arriving;
                shaded += arriving * shadow.haze_transmittance(world, index);
            }
            *texel = (texel.xyz() * fraction_of_light(full, shaded)).extend(texel.w);
        });
    }

    fn scene_point(&self, pixel: IVec2) -> Vec3 {
        let size: UVec2 = self.view.size.as_uvec2();
        let inside = pixel.clamp(IVec2::ZERO, size.as_ivec2() - 1);
        let stored = self.scene_depth.load(inside + self.view.origin.as_ivec2());
        let depth = view_depth_from_ndc_depth(stored, self.view.depth_coefficients);
        let ndc: Vec2 = ndc_from_pixel(pixel.as_vec2() + 0.5, self.view.size);
        view_position(ndc * self.view.ray_scale + self.view.ray_offset, depth, self.view.orthographic)
    }
}
