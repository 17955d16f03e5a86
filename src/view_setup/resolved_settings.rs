//! Settings of a system for one frame, without open choices.

use std::ops::Deref;

use glam::UVec2;

use crate::settings::{Lighting, LightingResolution, RenderPath, Settings};

/// Settings of a system for one frame, after every choice that depends on the view, the sprite or the device. Both
/// renderers make these choices here, once per frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolvedSettings {
    settings: Settings,
    /// Pixels of the picture per texel of the target, along each side.
    pub scale: u32,
}

impl ResolvedSettings {
    /// `particle_scale`: metres per unit of the particles' space; sprite sizes grow by it. `picture`: size of the view,
    /// pixels. `frame_count`: number of frames of the sprite. `has_six_way`: false if the
    /// device cannot light by six-way maps; normals replace them.
    pub fn new(settings: &Settings, particle_scale: f32, picture: UVec2, frame_count: f32, has_six_way: bool) -> Self {
        let lighting = if has_six_way { settings.lighting } else { Lighting::Normals };
        let mut sprite = settings.sprite.for_frames(frame_count);
        sprite.size *= particle_scale;
        let scale = settings.accumulate.effective_scale(picture);
        Self { settings: Settings { lighting, sprite, ..*settings }, scale }
    }

    /// Returns the same settings with the path that `auto` chose.
    pub fn with_path(self, path: RenderPath) -> Self {
        Self { settings: Settings { path, ..self.settings }, ..self }
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
