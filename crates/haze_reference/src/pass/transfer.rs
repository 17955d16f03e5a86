//! CPU version of `shaders/transfer.wgsl`.

use glam::{IVec2, Vec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::blending::deferred_fragment;
use haze_core::formula::color::{bounded_light, overdraw_color};
use haze_core::formula::diffuse_bake::{cube_coordinate, motif_position, sample_baked, spherical_harmonics};
use haze_core::formula::fire::fire_from_moments;
use haze_core::formula::lighting::{coverage, painted_fraction};
use haze_core::formula::normal::normal_from_accumulation;
use haze_core::formula::ramp::sample_ramp_2d;
use haze_core::formula::saturate;
use haze_core::formula::six_way::{SixWay, normal_from_six_way};
use haze_core::formula::uniforms::LightUniform;
use haze_core::settings::{BlendMode, CoverageMode, DebugView, DiffuseMode};
use haze_core::view_setup::AttachmentRole;

use crate::accumulated::{AccumulatedTarget, Attachments};
use crate::blend_unit::premultiplied_over;
use crate::shade::Shade;

/// Surface that light falls on.
pub struct Surface {
    /// Unit length, view space.
    pub normal: Vec3,
    /// From six-way maps.
    pub six_way: SixWay,
    /// Smoke and scene before it.
    pub shade: Shade,
    /// Moments of its depth, if the system accumulates them.
    pub depth: Vec2,
    /// Means of heat and of its square, if the system burns.
    pub heat: Vec2,
    /// Mean color of the particles.
    pub tint: Vec3,
}

impl AccumulatedTarget<'_> {
    /// Diffuse light on a surface, by the system's mode.
    pub fn diffuse(&self, surface: &Surface, amount: f32, position: Vec3) -> Vec3 {
        let visible = self.visible;
        let normal = surface.normal;
        let shade = &surface.shade;
        if visible.settings.is_six_way() {
            let light = visible.diffuse_from_six_way(&surface.six_way, position, shade);
            return light * visible.system.diffuse_intensity * surface.tint;
        }
        let light = match visible.settings.diffuse.mode {
            DiffuseMode::Ramp => {
                visible.diffuse_from_lights(normal, coverage(amount, visible.system.boost), position, shade)
            }
            DiffuseMode::Cubemap => {
                let cube = cube_coordinate(normal);
                sample_baked(&self.baked[cube.face as usize], cube.position)
            }
            DiffuseMode::Motif => sample_baked(&self.baked[0], motif_position(normal)),
            DiffuseMode::PaintedMotif => {
                let filter = visible.settings.ramp_filter;
                sample_ramp_2d(&visible.material.motif, filter, motif_position(normal) * 0.5 + 0.5)
            }
            DiffuseMode::SphericalHarmonics => spherical_harmonics(&visible.system.spherical_harmonics, normal),
        };
        light * visible.system.diffuse_intensity * surface.tint
    }

    /// Lights the smoke, or shows a debug view of it, and blends it over the image.
    pub fn transfer(&self, debug_view: DebugView, image: &mut Image<Vec4>) {
        image.for_each(|at, texel| {
            let pixel = at.as_vec2() + 0.5;
            if self.covers_pixel(at.as_ivec2(), pixel)
                && let Some(source) = self.transfer_fragment(debug_view, pixel)
            {
                *texel = premultiplied_over(source, *texel);
            }
        });
    }

    /// True if the face of the box that the transfer draws covers the pixel and passes the depth test.
    pub fn covers_pixel(&self, at: IVec2, pixel: Vec2) -> bool {
        let visible = self.visible;
        // The ray is parametrised by view depth: from the eye, or straight ahead.
        let start = visible.view_position(pixel, 0.0);
        let end = visible.view_position(pixel, 1.0);
        let origin = visible.world_from_view.transform_point3(start);
        let direction = visible.world_from_view.transform_vector3(end - start);
        let t0 = (visible.system.bounds_min - origin) / direction;
        let t1 = (visible.system.bounds_max - origin) / direction;
        let enter = t0.min(t1).max_element();
        let exit = t0.max(t1).min_element();
        if visible.setup.back_faces {
            enter <= exit && exit > 0.0
        } else {
            enter <= exit && enter <= visible.scene_view_depth(at)
        }
    }

    /// Premultiplied light and coverage at a pixel, or their debug view; `None` without smoke.
    pub fn transfer_fragment(&self, debug_view: DebugView, pixel: Vec2) -> Option<Vec4> {
        let system = &self.visible.system;
        if debug_view == DebugView::ReducedDepth {
            let depth = self.reduced_depth.load((pixel / system.scale as f32 - system.target_origin).as_ivec2());
            let gray = 1.0 - saturate((depth - system.bounds_near) / (system.depth_limit - system.bounds_near));
            return Some(Vec3::splat(gray).extend(1.0));
        }
        if debug_view == DebugView::ShadowSlice {
            return Some(self.visible.slice_of_light(pixel));
        }
        let accumulated = if self.is_lit { self.sample_lit(pixel) } else { self.sample_accumulated(pixel) };
        let amount = accumulated.w;
        if amount <= 0.0 {
            return None;
        }
        match debug_view {
            DebugView::Overdraw => return Some(overdraw_color(amount * 255.0).extend(1.0)),
            // White smoke: over black, the amount of all systems.
            DebugView::Amount => return Some(Vec4::splat(amount)),
            _ => {}
        }
        let covered = self.coverage(amount);
        if self.is_lit {
            return Some(self.blended(bounded_light(accumulated.xyz() / amount.max(1.0e-6)), covered));
        }
        let surface = self.surface_at(accumulated, pixel);
        if debug_view == DebugView::Normals {
            return Some((surface.normal * 0.5 + 0.5).extend(1.0) * covered);
        }
        if debug_view == DebugView::Shadow {
            let fractions = self.visible.fractions_of_lights(surface.shade.optical_depths[0], surface.shade.visible[0]);
            return Some(fractions.extend(1.0) * covered);
        }
        let mut light = Vec3::ZERO;
        if debug_view != DebugView::SoftScatter {
            light += self.diffuse(&surface, amount, self.lit_position(&surface, pixel));
        }
        if debug_view != DebugView::Diffuse {
            light += self.visible.soft_scatter(amount) * surface.tint;
        }
        if !matches!(debug_view, DebugView::SoftScatter | DebugView::Diffuse) {
            light += self.fire_light(&surface, amount);
        }
        Some(self.blended(bounded_light(light), covered))
    }

    /// Premultiplied light and coverage as the blend unit gets them.
    pub fn blended(&self, light: Vec3, covered: f32) -> Vec4 {
        deferred_fragment(self.visible.settings.blend_mode == BlendMode::Additive, light, covered)
    }

    /// Fraction of the scene that the smoke hides.
    pub fn coverage(&self, amount: f32) -> f32 {
        let visible = self.visible;
        let linear = coverage(amount, visible.system.boost);
        match visible.settings.coverage {
            CoverageMode::Linear => linear,
            CoverageMode::Ramp => painted_fraction(visible.sample_ramp(&visible.material.coverage_ramp, linear)),
        }
    }

    fn surface_at(&self, accumulated: Vec4, pixel: Vec2) -> Surface {
        self.shaded_surface(&self.attachments(accumulated, |texture| self.sample_target(texture, pixel)), pixel)
    }

    /// Surface at a pixel, past the scene's shadow.
    pub fn shaded_surface(&self, attachments: &Attachments, pixel: Vec2) -> Surface {
        let mut surface = self.surface(attachments);
        if self.visible.settings.receives_shadow_by_depth() {
            surface.shade = self.visible.shade_on_ray(surface.shade.optical_depths[0], pixel, surface.depth);
        }
        surface
    }

    /// Point of the smoke that is lit at a pixel, view space: at its mean depth, or on the plane of the system's center.
    pub fn lit_position(&self, surface: &Surface, pixel: Vec2) -> Vec3 {
        let visible = self.visible;
        match AttachmentRole::Depth.is_used(&visible.settings) {
            true => visible.mean_position(pixel, surface.depth),
            false => visible.view_position(pixel, -visible.system.center.z),
        }
    }

    /// `surface_from_accumulation()` in lit_smoke.wgsl.
    pub fn surface(&self, attachments: &Attachments) -> Surface {
        let settings = self.visible.settings;
        let accumulate = &settings.accumulate;
        let [accumulated, six_way, weights, depths, moments, heat, tint] = *attachments;
        let shade = Shade::of_sprites(depths.xyz() / depths.w.max(1.0e-6));
        let depth = moments.xy() / moments.w.max(1.0e-6);
        let tint = match AttachmentRole::Tint.is_used(&settings) {
            true => tint.xyz().max(Vec3::ZERO) / tint.w.max(1.0e-6),
            false => Vec3::ONE,
        };
        let heat = heat.xy().max(Vec2::ZERO) / heat.w.max(1.0e-6);
        if AttachmentRole::SixWay.is_used(&settings) {
            let scale = 1.0 / six_way.w.max(1.0e-6);
            let [positive, negative] = [accumulated, six_way].map(|light| light.xyz().max(Vec3::ZERO) * scale);
            let normal = normal_from_six_way(positive, negative);
            return Surface { normal, six_way: SixWay { positive, negative }, shade, depth, heat, tint };
        }
        let weights = if AttachmentRole::Weights.is_used(&settings) { weights.x } else { accumulated.w };
        let normal = normal_from_accumulation(accumulate.encoding, accumulate.decode, accumulated.xyz(), weights);
        Surface { normal, six_way: SixWay::default(), shade, depth, heat, tint }
    }

    /// Amount and surface at a pixel.
    pub fn amount_and_surface(&self, pixel: Vec2) -> (f32, Surface) {
        let accumulated = self.sample_accumulated(pixel);
        (accumulated.w, self.surface_at(accumulated, pixel))
    }

    /// Light that the smoke gives at a point.
    pub fn fire_light(&self, surface: &Surface, amount: f32) -> Vec3 {
        match self.visible.settings.burns() {
            true => self.visible.emission(fire_from_moments(surface.heat), amount),
            false => Vec3::ZERO,
        }
    }

    /// Light from sky and ground, if the system has it and does not bake it.
    pub fn ambient(&self, surface: &Surface, covered: f32) -> Option<Vec3> {
        let visible = self.visible;
        let openness = surface.shade.openness;
        let light = match visible.settings.is_six_way() {
            true => visible.ambient_from_six_way(&surface.six_way, openness),
            false => visible.ambient_from_ramp(surface.normal, covered, openness),
        };
        let is_shown = visible.settings.has_ambient() && visible.settings.can_receive_shadow();
        is_shown.then_some(light * visible.system.diffuse_intensity * surface.tint)
    }

    /// Contribution of a light if none is baked.
    pub fn diffuse_from_light(&self, light: &LightUniform, surface: &Surface, covered: f32, position: Vec3) -> Vec3 {
        match self.visible.settings.is_six_way() {
            true => self.visible.six_way_from_light(light, &surface.six_way, position, &surface.shade),
            false => self.visible.diffuse_from_light(light, surface.normal, covered, position, &surface.shade),
        }
    }
}
