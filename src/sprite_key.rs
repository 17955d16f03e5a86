//! What accumulate and forward share: the variants of `shaders/lib/sprite_vertex.wgsl` and `sprite_fragment.wgsl`.

use crate::pass::{Constant, switch, variant};
use crate::settings::{FadeCurve, Settings, SpriteAnimation, Technique};

/// What makes the sprites of one pipeline differ from another's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SpriteKey {
    technique: Technique,
    animation: SpriteAnimation,
    debug_sprite: bool,
    motion: bool,
    curve: FadeCurve,
    linear_depth: bool,
}

impl SpriteKey {
    /// `linear_depth`: the host's depth is linear.
    pub fn new(settings: &Settings, linear_depth: bool) -> Self {
        Self {
            technique: settings.technique,
            animation: settings.sprite.animation,
            debug_sprite: settings.sprite.debug_sprite,
            motion: settings.sprite.motion > 0.0,
            curve: settings.soft_fade.curve,
            linear_depth,
        }
    }

    /// The overrides of the shared files, and a pass's own.
    pub fn constants<const N: usize>(&self, of_pass: [Constant; N]) -> Vec<Constant> {
        let shared = [
            variant!("TECHNIQUE", self.technique),
            variant!("SPRITE_ANIMATION", self.animation),
            switch("DEBUG_SPRITE", self.debug_sprite),
            switch("MOTION", self.motion),
            variant!("FADE_CURVE", self.curve),
            switch("LINEAR_DEPTH", self.linear_depth),
        ];
        shared.into_iter().chain(of_pass).collect()
    }
}
