//! Keyframes and flicker of presets: the settings of an entity's smoke at the time of its clock.

use bevy::prelude::*;
use haze::preset::{AnimatedPreset, Preset, PresetSystem};
use haze::{EmitterSnapshot, Settings};

use crate::asset::SmokeAsset;

/// Settings of an entity's smoke that have tracks. Every [`Smoke`](crate::Smoke) has it.
#[derive(Component, Clone, Debug, Default)]
pub(crate) struct SmokeAnimation {
    /// `None` for a preset without tracks.
    preset: Option<AnimatedPreset>,
    /// Seconds that `systems` are of.
    seconds: Option<f64>,
    systems: Vec<SystemState>,
}

/// A particle system at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SystemState {
    /// Unevaluated particles of the emitter.
    pub snapshot: EmitterSnapshot,
    pub settings: Settings,
}

impl SystemState {
    fn new(system: &PresetSystem, seconds: f64) -> Self {
        Self { snapshot: system.emitter_snapshot(seconds), settings: system.settings }
    }

    /// The state with this index; without it, that of the preset's own values.
    pub fn find(states: &[Self], index: usize, system: &PresetSystem, seconds: f64) -> Self {
        states.get(index).copied().unwrap_or_else(|| Self::new(system, seconds))
    }
}

impl SmokeAnimation {
    pub fn new(asset: &SmokeAsset) -> Self {
        if asset.animation.is_empty() {
            return Self::default();
        }
        let systems = asset.systems.iter().map(|system| system.preset.clone()).collect();
        let preset = Preset { systems, animation: asset.animation.clone(), ..Preset::default() };
        Self { preset: Some(AnimatedPreset::new(&preset)), ..Self::default() }
    }

    /// Evaluates the tracks at a time, unless they were evaluated at it.
    pub fn evaluate(&mut self, seconds: f64) {
        let Some(preset) = &mut self.preset else { return };
        if self.seconds.replace(seconds).is_some_and(|last| last.to_bits() == seconds.to_bits()) {
            return;
        }
        self.systems.clear();
        self.systems.extend(preset.evaluate(seconds).systems.iter().map(|system| SystemState::new(system, seconds)));
    }

    /// Systems at the time of the clock; none if the preset has no tracks.
    pub fn systems(&self) -> &[SystemState] {
        &self.systems
    }
}

#[cfg(test)]
mod tests {
    use haze::preset::Track;

    use super::*;

    #[test]
    fn a_time_is_evaluated_once_and_presets_without_tracks_never() {
        let mut asset = SmokeAsset::builtin("column").unwrap();
        let mut plain = SmokeAnimation::new(&asset);
        plain.evaluate(3.0);
        assert!(plain.systems().is_empty());
        asset.animation = vec![Track { setting: "systems[0].settings.boost".into(), ..Track::default() }];
        let mut animation = SmokeAnimation::new(&asset);
        animation.evaluate(3.0);
        assert_eq!(animation.systems().len(), 1);
        animation.systems.clear();
        animation.evaluate(3.0);
        assert!(animation.systems().is_empty());
        animation.evaluate(4.0);
        assert_eq!(animation.systems().len(), 1);
    }
}
