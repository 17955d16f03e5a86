//! Settings that have no counterpart in Godot's particles, in words.

use glam::Vec3;
use haze_core::emitter::EmitterShape;
use haze_core::settings::{BlendMode, Curve, Technique};
use haze_preset::PresetSystem;

use super::process::Process;

/// Settings that the scene of a system changes or leaves out: names and texts.
pub fn left_out(system: &PresetSystem) -> Vec<(&'static str, &'static str)> {
    let emitter = &system.emitter;
    let settings = &system.settings;
    let process = Process::new(system);
    let sprite = &settings.sprite;
    let grain = &settings.grain;
    let ends = emitter.duration > 0.0;
    let is_curved = |curve: Curve| curve != Curve::constant(1.0);
    let is_tilted = emitter.up.normalize_or(Vec3::Y) != Vec3::Y && (emitter.extent.x - emitter.extent.z).abs() > 1.0e-6;
    let rules = [
        (
            emitter.lifetime_spread > 0.0,
            "`lifetime_spread`",
            "lives differ in length; a particle of another than the mean life takes the way of the mean life",
        ),
        (ends && emitter.period > 0.0, "`period`", "emission does not pause; its rate is the mean one"),
        (
            ends && emitter.period == 0.0 && !process.is_one_shot(),
            "`duration`",
            "longer than a life: set *Emitting* to off at its end",
        ),
        (ends && is_curved(emitter.rate_curve), "`rate_curve`", "the rate is the mean one"),
        (
            emitter.shape == EmitterShape::Sphere && emitter.extent != Vec3::ZERO,
            "`shape`",
            "births are denser in the middle of the sphere",
        ),
        (emitter.shape == EmitterShape::Disc && is_tilted, "`extent`", "the disc is round"),
        (
            emitter.velocity_spread > 0.0 && process.is_turbulent(),
            "`velocity_spread`",
            "left out: Godot's turbulence makes it grow from step to step",
        ),
        (
            emitter.velocity_spread > 0.0 && emitter.drag > 0.0 && !process.is_turbulent(),
            "`drag`",
            "of random velocity: a constant *Damping* that leads as far; it is in the curves of all other motion",
        ),
        (emitter.burst != 0.0, "`burst`", "leads away from the middle at each moment, not only at birth"),
        (
            process.is_turbulent(),
            "`turbulence`",
            "Godot's, of the same size: it turns the motion by a fraction, and does not add to it",
        ),
        (
            emitter.turbulence > 0.0 && !process.is_turbulent(),
            "`turbulence`",
            "left out: random velocity leads further, which Godot's turbulence would make grow from step to step",
        ),
        (emitter.ring_speed > 0.0, "`ring_speed`", "no rings"),
        (emitter.attraction != 0.0, "`attraction`", "no attractor: add a `GPUParticlesAttractorSphere3D`"),
        (
            emitter.floor_margin > 0.0 || emitter.bounce > 0.0,
            "`bounce`, `floor_margin`",
            "no floor: add a `GPUParticlesCollisionBox3D`, and set *Collision > Mode* of the process material",
        ),
        (
            emitter.obstacle_margin > 0.0,
            "`obstacle`",
            "no obstacle: add a `GPUParticlesCollisionBox3D`, and set *Collision > Mode* of the process material",
        ),
        (emitter.small_fraction > 0.0, "`small_fraction`", "all particles have the size of the larger ones"),
        (emitter.spin > 0.0 && emitter.drag > 0.0, "`spin`", "slowed by drag as for a particle of the mean life"),
        (settings.burns() && emitter.heat_spread > 0.0, "`heat_spread`", "all particles of an age have the mean heat"),
        (settings.is_stretched(), "`sprite.stretch`", "sprites are not stretched"),
        (sprite.motion > 0.0, "`sprite.motion`", "frames are blended without motion"),
        (settings.grain_octaves() > 0, "`grain`", "no grain"),
        (grain.erosion > 0.0 || grain.dissolve > 0.0, "`grain.erosion`, `grain.dissolve`", "smoke is denser without"),
        (
            settings.technique != Technique::Hard,
            "`technique`",
            "flat sprites, which end in a hard edge where they meet the scene",
        ),
        (
            settings.technique.is_sphere() || settings.technique == Technique::Density,
            "`technique`",
            "opacity is that of the sprite's image, not of smoke of some thickness: it may be much thinner",
        ),
        (settings.blend_mode != BlendMode::Alpha, "`blend_mode`", "blended by alpha"),
    ];
    rules.into_iter().filter(|(holds, ..)| *holds).map(|(_, name, text)| (name, text)).collect()
}
