//! Settings of a system for one frame, without open choices.

use std::iter;
use std::ops::Deref;

use glam::UVec2;

use super::attachment_role::AttachmentSet;
use super::lighting_choice::LightingChoice;
use crate::assets::ramp_steps::RampSteps;
use crate::formula::shadow::LIGHTS_PER_BLOCK;
use crate::settings::{
    BlendOrder, COARSEST_AUTO_SCALE, DepthSource, Lighting, LightingResolution, RenderPath, ScaleMode, Settings,
};

/// Capabilities of a device that settings depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Support {
    /// True if it can light by six-way maps; otherwise normals replace them.
    pub six_way: bool,
    /// True if it can blend the textures of a target in different ways; otherwise `sorted` replaces `weighted` where the target
    /// has several.
    pub independent_blend: bool,
}

impl Support {
    /// Everything, as the CPU renderer supports it.
    pub const ALL: Self = Self { six_way: true, independent_blend: true };
}

/// Settings of a system for one frame, after every choice that depends on the view, the sprite or the device. Both
/// renderers make these choices here, once per frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolvedSettings {
    settings: Settings,
    /// Pixels of the image per texel of the target, along each side; before `auto` has chosen, the fixed scale.
    pub scale: u32,
    /// Finest scale that `auto` may choose.
    pub finest_scale: u32,
    /// Choice of the lighting resolution `auto`; `None` for another.
    pub lighting_choice: Option<LightingChoice>,
}

impl ResolvedSettings {
    /// `particle_scale`: metres per unit of the particles' space; sprite sizes grow by it. `image`: size of the view,
    /// pixels. `frame_count`: number of frames of the sprite. `ramp_steps`: of the material.
    pub fn new(
        settings: &Settings,
        particle_scale: f32,
        image: UVec2,
        frame_count: f32,
        ramp_steps: &RampSteps,
        support: Support,
    ) -> Self {
        let lighting = if support.six_way { settings.lighting } else { Lighting::Normals };
        let mut sprite = settings.sprite.for_frames(frame_count);
        sprite.size *= particle_scale;
        let scale = settings.accumulate.effective_scale(image);
        let finest_scale = settings.accumulate.finest_scale(image);
        let mut settings = Settings { lighting, sprite, ..*settings };
        let has_several = AttachmentSet::of(&settings).iter().count() > 1;
        if has_several && !support.independent_blend {
            settings.accumulate.order = BlendOrder::Sorted;
        }
        let is_auto = settings.accumulate.lighting_resolution == LightingResolution::Auto;
        let lighting_choice = is_auto.then(|| LightingChoice::new(ramp_steps, &settings, scale));
        if let Some(choice) = lighting_choice {
            settings.accumulate.lighting_resolution = choice.resolution;
        }
        Self { settings, scale, finest_scale, lighting_choice }
    }

    /// Returns the same settings with the scale that `auto` chose.
    pub fn with_scale(mut self, scale: u32) -> Self {
        self.scale = scale;
        self.lighting_choice = self.lighting_choice.map(|choice| choice.at_scale(scale));
        if let Some(choice) = self.lighting_choice {
            self.settings.accumulate.lighting_resolution = choice.resolution;
        }
        self
    }

    /// Scales that select different pipelines, of those that may be chosen.
    pub fn candidate_scales(&self) -> impl Iterator<Item = u32> + use<> {
        let adapts = self.adapts_scale();
        let finest = if adapts { self.finest_scale } else { self.scale };
        iter::once(finest).chain((adapts && finest < COARSEST_AUTO_SCALE).then_some(COARSEST_AUTO_SCALE))
    }

    /// True if the scale is chosen for each frame.
    pub fn adapts_scale(&self) -> bool {
        let accumulate = &self.accumulate;
        accumulate.scale_mode == ScaleMode::Auto
            && accumulate.depth_source == DepthSource::Reduced
            && !self.is_forward()
    }

    /// Returns the same settings with the path that `auto` chose.
    pub fn with_path(self, path: RenderPath) -> Self {
        Self { settings: Settings { path, ..self.settings }, ..self }
    }

    /// Number of blocks of lights whose shadow falls on the smoke.
    pub fn shadow_blocks(&self) -> u32 {
        if self.receives_shadow_by_depth() { self.shadow.lights.div_ceil(LIGHTS_PER_BLOCK as u32) } else { 1 }
    }

    /// True if the smoke is lit once per texel, and a texel is larger than a pixel.
    pub fn lights_per_texel(&self) -> bool {
        self.accumulate.lighting_resolution == LightingResolution::Target && self.scale > 1
    }
}

impl Deref for ResolvedSettings {
    type Target = Settings;

    fn deref(&self) -> &Settings {
        &self.settings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_lights_texels_where_steps_of_ramps_are_small_for_the_scale() {
        let lights_per_texel = |step: f32, scale| {
            let mut settings = Settings::default();
            settings.accumulate.downscale = scale;
            let ramps = RampSteps { diffuse: step, ..RampSteps::default() };
            let resolved = ResolvedSettings::new(&settings, 1.0, UVec2::splat(512), 1.0, &ramps, Support::ALL);
            resolved.lights_per_texel()
        };
        assert!([2, 4, 8].into_iter().all(|scale| lights_per_texel(0.1, scale)) && !lights_per_texel(0.11, 8));
        assert!(!lights_per_texel(0.25, 2) && lights_per_texel(0.02, 16));
        assert!(!lights_per_texel(0.0, 1), "a texel is a pixel");
    }

    #[test]
    fn several_textures_are_sorted_where_they_cannot_be_blended_apart() {
        let order = |shadow: f32, independent_blend| {
            let mut settings = Settings::default();
            settings.accumulate.order = BlendOrder::Weighted;
            settings.shadow.strength = shadow;
            let support = Support { independent_blend, ..Support::ALL };
            ResolvedSettings::new(&settings, 1.0, UVec2::splat(512), 1.0, &RampSteps::default(), support).order()
        };
        assert_eq!(order(0.0, false), BlendOrder::Weighted);
        assert_eq!((order(1.0, false), order(1.0, true)), (BlendOrder::Sorted, BlendOrder::Weighted));
    }
}
