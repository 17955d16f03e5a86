//! Shadow of the smoke on the scene. WGSL: `shaders/lib/haze_transmittance.wgsl`.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use haze_core::assets::ramp::Ramp;
use haze_core::formula::ramp::sample_ramp_2d;
use haze_core::formula::saturate;
use haze_core::formula::scene_shadow::{grid_entry, transmitted_light};
use haze_core::formula::shadow::LIGHTS_PER_BLOCK;
use haze_core::formula::uniforms::SceneShadowUniform;
use haze_core::settings::RampFilter;
use haze_core::view_setup::SmokeShadow;

use super::input::FrameInput;
use super::optical_depths::OpticalDepths;

/// Shadow of a frame's smoke on the scene.
pub struct SceneShadow {
    uniform: SceneShadowUniform,
    depths: Arc<OpticalDepths>,
    ramp: Ramp,
}

impl SceneShadow {
    /// `None` if no shadow falls on the scene.
    pub fn new(frame: &FrameInput<'_>, shadow: &SmokeShadow, depths: &Arc<OpticalDepths>) -> Option<Self> {
        let (system, strength) = shadow.on_scene?;
        let ramp = frame.systems.get(system)?.material.shadow_ramp.clone();
        (strength > 0.0).then(|| Self { uniform: shadow.scene_uniform(), depths: depths.clone(), ramp })
    }

    /// Indices in the frame of the lights that cast shadow. The three brightest come first.
    pub fn lights(&self) -> impl Iterator<Item = usize> {
        self.uniform.indices.into_iter().filter(|index| *index != u32::MAX).map(|index| index as usize)
    }

    /// Fraction of a light that reaches a point of the world through the smoke. `light`: its index in the frame.
    pub fn haze_transmittance(&self, world_position: Vec3, light: usize) -> Vec3 {
        let SceneShadowUniform { origin, cells_per_metre, extent, strength, lights, indices } = self.uniform;
        let found = lights.iter().zip(indices).position(|(_, index)| index as usize == light);
        let Some((slot, &march)) = found.and_then(|slot| Some((slot, lights.get(slot)?))) else { return Vec3::ONE };
        let entry = grid_entry(march, (world_position - origin) * cells_per_metre, extent);
        if entry.w < 0.5 {
            return Vec3::ONE;
        }
        let optical_depth = self.depths.sample(slot / LIGHTS_PER_BLOCK, entry.truncate())[slot % LIGHTS_PER_BLOCK];
        let coordinate = Vec2::new(saturate(1.0 - (-optical_depth).exp2()), 1.0);
        let painted = sample_ramp_2d(&self.ramp, RampFilter::Bilinear, coordinate);
        Vec3::ONE.lerp(transmitted_light(optical_depth, painted), strength)
    }
}
