//! CPU version of `shaders/diffuse_bake.wgsl` and `shaders/lib/diffuse.wgsl`.

use glam::{UVec2, Vec2, Vec3};
use half::f16;
use haze_core::assets::image::Image;
use haze_core::assets::ramp::Ramp;
use haze_core::formula::ambient::{hemisphere_coordinate, openness_position, six_way_hemisphere};
use haze_core::formula::color::bounded_light;
use haze_core::formula::depth_moments::{DEPTH_SAMPLES, depth_of_sample};
use haze_core::formula::diffuse_bake::{baked_size_and_layers, cube_direction, motif_normal};
use haze_core::formula::lighting::{backlight_weight, coverage, direction_to_viewer, sample_light};
use haze_core::formula::ramp::{sample_ramp, sample_ramp_2d};
use haze_core::formula::response::{diffuse_response, fire_response, soft_scatter_curve};
use haze_core::formula::saturate;
use haze_core::formula::shadow::{
    LIGHT_BLOCKS, block_of_slot, foreign_optical_depths, own_at_mean_depth, select_slot, shadow_position,
};
use haze_core::formula::six_way::{SixWay, six_way_response};
use haze_core::formula::uniforms::LightUniform;
use haze_core::settings::{Backlight, DiffuseMode, SoftScatterMode};

use crate::optical_depths::OpticalDepths;
use crate::shade::Shade;
use crate::visible_system::VisibleSystem;

impl VisibleSystem<'_> {
    /// Smoke and scene before a pixel of the smoke. `accumulated`: optical depths that its sprites found towards the lights of
    /// the first block. `moments`: those of its depth.
    pub fn shade_on_ray(&self, accumulated: Vec3, pixel: Vec2, moments: Vec2) -> Shade {
        let mut shade = Shade::of_sprites(accumulated);
        shade.openness = self.openness(pixel, moments);
        let blocks = self.settings.shadow_blocks() as usize;
        for (block, visible) in shade.visible.iter_mut().enumerate().take(blocks) {
            *visible = self.mean_along_ray(pixel, moments, |volume, position| volume.sample_visible(block, position));
        }
        if let Some(volume) = self.optical_depths.as_ref().filter(|_| blocks > 1) {
            let position = self.mean_cell(pixel, moments);
            let own = own_at_mean_depth(volume.sample(0, position), accumulated);
            for (block, depths) in shade.optical_depths.iter_mut().enumerate().take(blocks).skip(1) {
                *depths = foreign_optical_depths(volume.sample(block, position), own);
            }
        }
        shade
    }

    /// Point of the smoke at a pixel at its mean depth, view space.
    pub fn mean_position(&self, pixel: Vec2, moments: Vec2) -> Vec3 {
        let system = &self.system;
        let depth = system.smoke_near + (system.smoke_far - system.smoke_near) * saturate(moments.x);
        self.view_position(pixel, depth)
    }

    /// The same in cells.
    fn mean_cell(&self, pixel: Vec2, moments: Vec2) -> Vec3 {
        self.system.grid_from_view.transform_point3(self.mean_position(pixel, moments))
    }

    /// Openness of the smoke at a pixel to sky and ground.
    fn openness(&self, pixel: Vec2, moments: Vec2) -> Vec2 {
        self.mean_along_ray(pixel, moments, OpticalDepths::sample_openness).truncate()
    }

    fn mean_along_ray(&self, pixel: Vec2, moments: Vec2, sample: impl Fn(&OpticalDepths, Vec3) -> Vec3) -> Vec3 {
        let (Some(volume), system) = (&self.optical_depths, &self.system) else { return Vec3::ONE };
        let sample = |index| {
            let depth = depth_of_sample(index, moments, system.smoke_near, system.smoke_far);
            sample(volume, system.grid_from_view.transform_point3(self.view_position(pixel, depth)))
        };
        (0..DEPTH_SAMPLES).map(sample).sum::<Vec3>() / DEPTH_SAMPLES as f32
    }

    /// Light from sky and ground, after the smoke between them.
    fn hemispheres(&self, openness: Vec2) -> [Vec3; 2] {
        let system = &self.system;
        let shadow = |openness| {
            if system.shadow_strength <= 0.0 {
                return Vec3::ONE;
            }
            let at = openness_position(openness);
            let painted = sample_ramp_2d(&self.material.shadow_ramp, self.settings.ramp_filter, at);
            Vec3::ONE.lerp(painted, system.shadow_strength)
        };
        [system.sky_color * shadow(openness.x), system.ground_color * shadow(openness.y)]
    }

    /// Light from sky and ground through the diffuse ramp.
    pub fn ambient_from_ramp(&self, normal: Vec3, covered: f32, openness: Vec2) -> Vec3 {
        let [sky, ground] = self.hemispheres(openness);
        let look_up = |axis| {
            let at = Vec2::new(hemisphere_coordinate(normal, axis), covered);
            sample_ramp_2d(&self.material.diffuse_ramp, self.settings.ramp_filter, at)
        };
        sky * look_up(self.system.up) + ground * look_up(-self.system.up)
    }

    /// Light from sky and ground through six-way maps.
    pub fn ambient_from_six_way(&self, six_way: &SixWay, openness: Vec2) -> Vec3 {
        let [sky, ground] = self.hemispheres(openness);
        let response = |axis| six_way_hemisphere(six_way.positive, six_way.negative, axis);
        let light = sky * response(self.system.up) + ground * response(-self.system.up);
        light * self.system.six_way_color
    }

    /// Samples a ramp of one row with the filter of the settings.
    pub fn sample_ramp(&self, ramp: &Ramp, u: f32) -> Vec3 {
        sample_ramp(ramp, self.settings.ramp_filter, u)
    }

    /// Sum of all lights through the diffuse ramp.
    pub fn diffuse_from_lights(&self, normal: Vec3, covered: f32, position: Vec3, shade: &Shade) -> Vec3 {
        let of_light = |light| self.diffuse_from_light(light, normal, covered, position, shade);
        let lights: Vec3 = self.lights.iter().map(of_light).sum();
        match self.settings.has_ambient() {
            true => lights + self.ambient_from_ramp(normal, covered, shade.openness),
            false => lights,
        }
    }

    /// Contribution of a light through the diffuse ramp.
    pub fn diffuse_from_light(
        &self,
        light: &LightUniform,
        normal: Vec3,
        covered: f32,
        position: Vec3,
        shade: &Shade,
    ) -> Vec3 {
        let sample = sample_light(light, position);
        let ramps = [&self.material.diffuse_ramp, &self.material.backlight_ramp];
        let against = self.backlight_fraction(sample.direction, position);
        let filter = self.settings.ramp_filter;
        let response = diffuse_response(ramps, filter, normal, sample.direction, covered, against);
        response * light.color * sample.attenuation * self.shadow_on_light(light, sample.direction, position, shade)
    }

    /// Fraction of the backlight ramp in a light, 0 to 1; the rest comes from the diffuse ramp.
    pub fn backlight_fraction(&self, to_light: Vec3, position: Vec3) -> f32 {
        match self.settings.diffuse.backlight {
            Backlight::Ramp => backlight_weight(to_light, direction_to_viewer(position, self.view.orthographic)),
            _ => 0.0,
        }
    }

    /// Fraction of a light that comes through the smoke in front of it.
    pub fn shadow_on_light(&self, light: &LightUniform, to_light: Vec3, position: Vec3, shade: &Shade) -> Vec3 {
        if self.system.shadow_strength <= 0.0 || light.shadow_slot < 0.5 {
            return Vec3::ONE;
        }
        let at = self.shadow_position(light, to_light, position, shade);
        let painted = sample_ramp_2d(&self.material.shadow_ramp, self.settings.ramp_filter, at);
        Vec3::ONE.lerp(painted, self.system.shadow_strength)
            * select_slot(light.shadow_slot, shade.visible[block_of(light)])
    }

    /// Place on the shadow ramp of a light with shadow.
    pub fn shadow_position(&self, light: &LightUniform, to_light: Vec3, position: Vec3, shade: &Shade) -> Vec2 {
        let to_viewer = direction_to_viewer(position, self.view.orthographic);
        shadow_position(select_slot(light.shadow_slot, shade.optical_depths[block_of(light)]), to_light, to_viewer)
    }

    /// Sum of all lights through six-way maps.
    pub fn diffuse_from_six_way(&self, six_way: &SixWay, position: Vec3, shade: &Shade) -> Vec3 {
        let lights: Vec3 =
            self.lights.iter().map(|light| self.six_way_from_light(light, six_way, position, shade)).sum();
        match self.settings.has_ambient() {
            true => lights + self.ambient_from_six_way(six_way, shade.openness),
            false => lights,
        }
    }

    /// Contribution of a light through six-way maps.
    pub fn six_way_from_light(&self, light: &LightUniform, six_way: &SixWay, position: Vec3, shade: &Shade) -> Vec3 {
        let sample = sample_light(light, position);
        let response =
            six_way_response(six_way.positive, six_way.negative, sample.direction, self.system.six_way_anisotropy);
        let shadow = self.shadow_on_light(light, sample.direction, position, shade);
        light.color * (response * sample.attenuation) * self.system.six_way_color * shadow
    }

    /// Place on the fire ramp. `fire`: as from [`fire_from_moments`](haze_core::formula::fire::fire_from_moments).
    pub fn fire_position(&self, fire: Vec2, amount: f32) -> Vec2 {
        Vec2::new(fire.x, coverage(amount * fire.y, self.system.boost))
    }

    /// Light that hot smoke gives, per fraction of the scene that all smoke hides. `fire`: as from
    /// [`fire_from_moments`](haze_core::formula::fire::fire_from_moments).
    pub fn emission(&self, fire: Vec2, amount: f32) -> Vec3 {
        let system = &self.system;
        let ramp = &self.material.fire_ramp;
        fire_response(ramp, self.settings.ramp_filter, fire, amount, system.boost) * system.fire_intensity
    }

    /// Even backlight of smoke by its amount.
    pub fn soft_scatter(&self, amount: f32) -> Vec3 {
        let system = &self.system;
        let color = match self.settings.soft_scatter.mode {
            SoftScatterMode::Ramp => self.sample_ramp(&self.material.soft_scatter_ramp, amount),
            SoftScatterMode::Smoothstep => soft_scatter_curve(
                amount,
                system.scatter_color,
                system.ambient_color,
                system.scatter_amount,
                system.scatter_smooth,
            ),
        };
        color * system.soft_scatter_intensity
    }

    /// Faces of the cubemap, or the motif; the first row is at −1.
    pub fn diffuse_bake(&self) -> Vec<Image<Vec3>> {
        let mode = self.settings.diffuse.mode;
        let Some((side, layers)) = baked_size_and_layers(mode) else { return Vec::new() };
        let face = |face: i32| {
            let mut baked = Image::new(UVec2::splat(side), Vec3::ZERO);
            baked.for_each(|at, texel| {
                let position = at.as_vec2() / (side - 1) as f32 * 2.0 - 1.0;
                let normal = match mode {
                    DiffuseMode::Motif => motif_normal(position),
                    _ => cube_direction(face, position).normalize(),
                };
                let light = bounded_light(self.diffuse_from_lights(normal, 1.0, self.system.center, &Shade::NONE));
                *texel = Vec3::from(light.to_array().map(|channel| f16::from_f32(channel).to_f32()));
            });
            baked
        };
        (0..layers as i32).map(face).collect()
    }
}

/// Index of the block of a light with shadow.
fn block_of(light: &LightUniform) -> usize {
    (block_of_slot(light.shadow_slot) as usize).min(LIGHT_BLOCKS - 1)
}
