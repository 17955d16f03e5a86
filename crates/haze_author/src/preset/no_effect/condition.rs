//! Longer conditions under which settings of a system have no effect.

use glam::{UVec2, Vec3};

use haze_core::emitter::EmitterShape;
use haze_core::settings::{
    CoverageMode, DiffuseMode, FadeCurve, ScaleMode, SoftScatterMode, SpriteAnimation, Technique, Upsample,
};
use haze_preset::{PresetSystem, builtin};

pub fn technique(system: &PresetSystem) -> Technique {
    system.settings.technique
}

pub fn is_hard(system: &PresetSystem, _: UVec2) -> bool {
    !technique(system).is_soft()
}

/// True if a texel is a pixel, whatever the smoke is like.
pub fn is_at_full_resolution(system: &PresetSystem, size: UVec2) -> bool {
    let accumulate = &system.settings.accumulate;
    accumulate.effective_scale(size) == 1 && accumulate.scale_mode == ScaleMode::Fixed
}

/// True if the upsampling compares depths. It then uses the length of the fade, whether sprites fade or not.
pub fn upsampling_reads_depth(system: &PresetSystem, size: UVec2) -> bool {
    let is_reduced = !system.settings.is_forward() && !is_at_full_resolution(system, size);
    is_reduced && system.settings.accumulate.upsample != Upsample::Bilinear
}

pub fn shows_through(system: &PresetSystem) -> bool {
    system.settings.soft_fade.curve == FadeCurve::Always
}

pub fn curve_ignores_power(system: &PresetSystem, _: UVec2) -> bool {
    !matches!(system.settings.soft_fade.curve, FadeCurve::Contrast | FadeCurve::Exponential)
}

/// True if the checkerboard replaces everything of a sprite. Depth sprites still read depth from it.
pub fn shows_checkerboard_only(system: &PresetSystem, _: UVec2) -> bool {
    let is_read = technique(system).is_volumetric() || technique(system).is_depth_sprite();
    system.settings.debug.checkerboard && !is_read
}

pub fn reads_no_detail(system: &PresetSystem, _: UVec2) -> bool {
    !technique(system).is_depth_sprite() && system.settings.sprite.motion <= 0.0
}

pub fn has_one_frame(system: &PresetSystem, _: UVec2) -> bool {
    let material = &system.material;
    let is_file = builtin::find(builtin::SPRITES, &material.sprite).is_none();
    let is_one = is_file && (material.columns, material.rows) == (1, 1);
    // A single frame still moves towards itself.
    is_one && system.settings.sprite.motion <= 0.0 && !technique(system).is_volumetric()
}

pub fn plays_no_flipbook(system: &PresetSystem, _: UVec2) -> bool {
    !technique(system).is_volumetric()
        && matches!(system.settings.sprite.animation, SpriteAnimation::Still | SpriteAnimation::Volume)
}

pub fn has_no_animation(system: &PresetSystem, _: UVec2) -> bool {
    let scroll_speed = system.settings.volumetric.scroll_speed;
    if technique(system).is_volumetric() { scroll_speed == 0.0 } else { system.frame_rate() <= 0.0 }
}

pub fn uses_painted_motif(system: &PresetSystem) -> bool {
    system.settings.diffuse.mode == DiffuseMode::PaintedMotif
}

pub fn looks_up_no_ramp(system: &PresetSystem, _: UVec2) -> bool {
    let settings = &system.settings;
    let is_forward = settings.is_forward();
    let is_lit = settings.diffuse.intensity > 0.0;
    let by_normal =
        is_lit && !settings.is_six_way() && (is_forward || settings.diffuse.mode != DiffuseMode::SphericalHarmonics);
    let by_amount = settings.soft_scatter.intensity > 0.0 && settings.soft_scatter.mode == SoftScatterMode::Ramp;
    let deferred = settings.coverage == CoverageMode::Ramp || settings.specular_scatter.intensity > 0.0;
    let by_age = settings.sprite.age_color > 0.0 || settings.burns();
    let by_shadow = is_lit && settings.receives_shadow();
    !(by_normal || by_amount || by_shadow || by_age || deferred && !is_forward)
}

pub fn ignores_up(system: &PresetSystem, _: UVec2) -> bool {
    let emitter = &system.emitter;
    let is_anchored = emitter.anchor > 0.0;
    let is_flowing = emitter.wind_shear != Vec3::ZERO || emitter.orbit != 0.0 || emitter.ring_speed > 0.0;
    let is_disc = emitter.shape == EmitterShape::Disc;
    let has_walls = emitter.bounce > 0.0 || emitter.floor_margin > 0.0 || emitter.obstacle_margin > 0.0;
    emitter.buoyancy == 0.0 && !has_walls && !is_anchored && !is_flowing && !is_disc
}
