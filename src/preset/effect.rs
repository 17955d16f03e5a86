//! Which settings do nothing where they are, and why: one row for each reason.

use glam::{UVec2, Vec3};

use super::environment::{Environment, SceneName};
use super::preset::{Preset, PresetSystem};
use crate::assets::builtin;
use crate::emitter::EmitterShape;
use crate::frame::{Light, LightKind};
use crate::settings::{
    CoverageMode, DiffuseMode, FadeCurve, Order, Path, SoftScatterMode, SpriteAnimation, Technique, Upsample,
};

/// A reason, whether it holds, and what does nothing then: fields, or groups of them.
struct Row<T> {
    reason: &'static str,
    holds: fn(&T, UVec2) -> bool,
    fields: &'static [&'static str],
}

impl<T> Row<T> {
    /// Whether it is about a field.
    fn names(&self, field: &str) -> bool {
        let is_named =
            |name: &&str| field.strip_prefix(*name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        self.fields.iter().any(is_named)
    }
}

const fn row<T>(reason: &'static str, holds: fn(&T, UVec2) -> bool, fields: &'static [&'static str]) -> Row<T> {
    Row { reason, holds, fields }
}

/// The first row that holds is the reason.
const OF_SYSTEMS: &[Row<PresetSystem>] = &[
    row("the particles come from a cache", |s, _| s.cache.is_used(), &["emitter"]),
    row(
        "only with a cache",
        |s, _| !s.cache.is_used(),
        &[
            "cache.units",
            "cache.up",
            "cache.position",
            "cache.fps",
            "cache.start",
            "cache.after",
            "cache.default_radius",
            "cache.default_amount",
            "cache.flipbook_rate",
        ],
    ),
    row(
        "forward only",
        |s, _| !s.settings.is_forward(),
        &["settings.blend_mode", "settings.sprite.age_colour", "material.age_ramp"],
    ),
    row(
        "deferred only",
        |s, _| s.settings.is_forward(),
        &[
            "settings.accumulate.format",
            "settings.accumulate.encoding",
            "settings.accumulate.decode",
            "settings.accumulate.order",
            "settings.accumulate.depth_weight",
            "settings.accumulate.layers",
            "settings.accumulate.scale",
            "settings.accumulate.max_side",
            "settings.accumulate.depth_source",
            "settings.accumulate.depth_downsample",
            "settings.accumulate.upsample",
            "settings.accumulate.lighting_resolution",
            "settings.coverage",
            "settings.diffuse.mode",
            "settings.specular_scatter",
            "material.coverage_ramp",
            "material.specular_ramp",
            "material.motif",
        ],
    ),
    row(
        "only with technique spherical_billboard",
        |s, _| technique(s) != Technique::SphericalBillboard,
        &["settings.spherical_billboard"],
    ),
    row("only with technique density", |s, _| technique(s) != Technique::Density, &["settings.density"]),
    row(
        "only with technique volumetric_hard or volumetric_soft",
        |s, _| !technique(s).is_volumetric(),
        &["settings.volumetric", "material.noise"],
    ),
    row(
        "volumetric techniques show noise in place of the sprite",
        |s, _| technique(s).is_volumetric(),
        &[
            "settings.sprite.animation",
            "settings.sprite.motion",
            "settings.sprite.debug_sprite",
            "material.sprite",
            "material.detail",
            "material.columns",
            "material.rows",
            "material.y_down",
            "emitter.spin",
            "emitter.frame_rate",
            "cache.flipbook_rate",
        ],
    ),
    row(
        "a built-in sprite knows its own",
        |s, _| builtin::find(builtin::SPRITES, &s.material.sprite).is_some(),
        &["material.detail", "material.columns", "material.rows", "material.y_down"],
    ),
    row(
        "only with a technique that fades: soft, soft_linear, depth_sprite_soft, volumetric_soft",
        is_hard,
        &["settings.soft_fade.curve", "settings.soft_fade.contrast_power"],
    ),
    row(
        "at full resolution only with a technique that fades",
        |s, size| is_hard(s, size) && !weighs_depth(s, size),
        &["settings.soft_fade.fade_scale", "settings.soft_fade.epsilon"],
    ),
    row("only with curve contrast or exponential", has_no_power, &["settings.soft_fade.contrast_power"]),
    row("not with curve always", |s, size| shows_through(s) && !weighs_depth(s, size), &["settings.soft_fade.epsilon"]),
    row(
        "only with order weighted",
        |s, _| s.settings.accumulate.order != Order::Weighted,
        &["settings.accumulate.depth_weight"],
    ),
    row(
        "only on the path tiled, with order sorted",
        |s, _| s.settings.path != Path::Tiled || s.settings.accumulate.order != Order::Sorted,
        &["settings.accumulate.layers"],
    ),
    row(
        "only at a scale above 1",
        |s, size| s.settings.accumulate.effective_scale(size) == 1,
        &[
            "settings.accumulate.depth_downsample",
            "settings.accumulate.upsample",
            "settings.accumulate.lighting_resolution",
        ],
    ),
    row(
        "sprite.debug_sprite shows a checkerboard instead",
        |s, _| s.settings.sprite.debug_sprite,
        &["settings.sprite.motion"],
    ),
    row(
        "sprite.debug_sprite shows one checkerboard for all frames",
        is_checked,
        &[
            "settings.sprite.animation",
            "settings.sprite.freeze_animation",
            "emitter.frame_rate",
            "cache.flipbook_rate",
            "material.sprite",
            "material.detail",
            "material.columns",
            "material.rows",
            "material.y_down",
        ],
    ),
    row("only with a depth_sprite technique, or sprite.motion above 0", reads_no_detail, &["material.detail"]),
    row(
        "the sprite has one frame",
        has_one_frame,
        &["settings.sprite.animation", "settings.sprite.freeze_animation", "emitter.frame_rate", "cache.flipbook_rate"],
    ),
    row(
        "only with an animation that blends: flipbook, volume",
        |s, _| matches!(s.settings.sprite.animation, SpriteAnimation::Still | SpriteAnimation::Nearest),
        &["settings.sprite.motion"],
    ),
    row(
        "only with animation flipbook or nearest",
        plays_no_flipbook,
        &["settings.sprite.freeze_animation", "emitter.frame_rate", "cache.flipbook_rate"],
    ),
    row(
        "sprite.freeze_animation holds it",
        |s, _| s.settings.sprite.freeze_animation,
        &["settings.volumetric.scroll_speed", "emitter.frame_rate", "cache.flipbook_rate"],
    ),
    row("nothing moves: frame_rate and scroll_speed are 0", stands_still, &["settings.sprite.freeze_animation"]),
    row("only at an age_colour above 0", |s, _| s.settings.sprite.age_colour <= 0.0, &["material.age_ramp"]),
    row(
        "only at an intensity of diffuse light above 0",
        |s, _| s.settings.diffuse.intensity <= 0.0,
        &["settings.diffuse.mode", "material.diffuse_ramp", "material.motif"],
    ),
    row(
        "diffuse.mode painted_motif takes its light from the motif",
        |s, _| is_painted(s) && !s.settings.is_forward(),
        &["material.diffuse_ramp"],
    ),
    row("only with diffuse.mode painted_motif", |s, _| !is_painted(s), &["material.motif"]),
    row(
        "only at an intensity of soft scatter above 0",
        |s, _| s.settings.soft_scatter.intensity <= 0.0,
        &[
            "settings.soft_scatter.mode",
            "settings.soft_scatter.scatter_amount",
            "settings.soft_scatter.scatter_smooth",
            "settings.soft_scatter.scatter_colour",
            "settings.soft_scatter.ambient_colour",
            "material.soft_scatter_ramp",
        ],
    ),
    row(
        "only with soft_scatter.mode smoothstep",
        |s, _| s.settings.soft_scatter.mode != SoftScatterMode::Smoothstep,
        &[
            "settings.soft_scatter.scatter_amount",
            "settings.soft_scatter.scatter_smooth",
            "settings.soft_scatter.scatter_colour",
            "settings.soft_scatter.ambient_colour",
        ],
    ),
    row(
        "only with soft_scatter.mode ramp",
        |s, _| s.settings.soft_scatter.mode != SoftScatterMode::Ramp,
        &["material.soft_scatter_ramp"],
    ),
    row("only with coverage ramp", |s, _| s.settings.coverage != CoverageMode::Ramp, &["material.coverage_ramp"]),
    row("no ramp is looked up", looks_up_no_ramp, &["settings.ramp_filter"]),
    row(
        "only at an intensity of specular scatter above 0",
        |s, _| s.settings.specular_scatter.intensity <= 0.0,
        &["settings.specular_scatter.size", "material.specular_ramp"],
    ),
    row(
        "only at a turbulence above 0",
        |s, _| s.emitter.turbulence <= 0.0,
        &["emitter.turbulence_scale", "emitter.turbulence_speed"],
    ),
    row("only where the extent is not 0", |s, _| s.emitter.extent == Vec3::ZERO, &["emitter.shape", "emitter.burst"]),
    row("only with buoyancy, or with shape disc", needs_no_up, &["emitter.up"]),
];

const OF_LIGHTS: &[Row<Light>] = &[
    row(
        "the light's intensity is 0",
        |light, _| light.intensity <= 0.0,
        &[
            "kind",
            "position",
            "direction",
            "colour",
            "range",
            "radius",
            "inner_angle",
            "outer_angle",
            "specular_scatter",
        ],
    ),
    row(
        "a directional light shines from infinitely far",
        |light, _| light.kind == LightKind::Directional,
        &["position", "range"],
    ),
    row("a point light shines every way", |light, _| light.kind == LightKind::Point, &["direction"]),
    row("only with kind spot", |light, _| light.kind != LightKind::Spot, &["inner_angle", "outer_angle"]),
];

const OF_ENVIRONMENTS: &[Row<Environment>] =
    &[row("only in the yard", |environment, _| environment.scene != SceneName::Yard, &["lamp", "brazier"])];

impl Preset {
    /// Why a field has no effect as the rest stands; `None` if it has one. `path` is as [`path_of`](crate::settings::path_of)
    /// spells it; `size` is the picture's, in pixels.
    pub fn without_effect(&self, path: &str, size: UVec2) -> Option<&'static str> {
        let item = |list: &str| {
            let (index, field) = path.strip_prefix(list)?.strip_prefix('[')?.split_once("].")?;
            Some((index.parse::<usize>().ok()?, field))
        };
        if let Some((index, field)) = item("systems") {
            return find(OF_SYSTEMS, self.systems.get(index)?, field, size);
        }
        if let Some((index, field)) = item("lights") {
            return find(OF_LIGHTS, self.lights.get(index)?, field, size);
        }
        find(OF_ENVIRONMENTS, &self.environment, path.strip_prefix("environment.")?, size)
    }
}

/// The conditions that a field's effect has, told as such: of a dotted path without places in lists.
#[cfg(feature = "app")]
pub(super) fn conditions(path: &str) -> impl Iterator<Item = &'static str> {
    fn of<T>(rows: &'static [Row<T>], field: Option<&str>) -> Vec<&'static str> {
        let Some(field) = field else { return Vec::new() };
        rows.iter().filter(|row| row.names(field)).map(|row| row.reason).collect()
    }
    let all = [
        of(OF_SYSTEMS, path.strip_prefix("systems.")),
        of(OF_LIGHTS, path.strip_prefix("lights.")),
        of(OF_ENVIRONMENTS, path.strip_prefix("environment.")),
    ];
    let is_condition =
        |reason: &&str| reason.starts_with("only ") || reason.starts_with("not ") || reason.contains(" only");
    all.into_iter().flatten().filter(is_condition)
}

fn find<T>(rows: &[Row<T>], of: &T, field: &str, size: UVec2) -> Option<&'static str> {
    let holds = |row: &&Row<T>| row.names(field) && (row.holds)(of, size);
    rows.iter().find(holds).map(|row| row.reason)
}

fn technique(system: &PresetSystem) -> Technique {
    system.settings.technique
}

fn is_hard(system: &PresetSystem, _: UVec2) -> bool {
    !technique(system).is_soft()
}

/// True if the way back to full resolution looks at depths: it asks how far sprites fade, whether they do or not.
fn weighs_depth(system: &PresetSystem, size: UVec2) -> bool {
    let accumulate = &system.settings.accumulate;
    let is_reduced = !system.settings.is_forward() && accumulate.effective_scale(size) > 1;
    is_reduced && accumulate.upsample != Upsample::Bilinear
}

fn shows_through(system: &PresetSystem) -> bool {
    system.settings.soft_fade.curve == FadeCurve::Always
}

fn has_no_power(system: &PresetSystem, _: UVec2) -> bool {
    !matches!(system.settings.soft_fade.curve, FadeCurve::Contrast | FadeCurve::Exponential)
}

/// True if the checkerboard is all that is seen of a sprite: depth sprites take their depth from it still.
fn is_checked(system: &PresetSystem, _: UVec2) -> bool {
    let is_read = technique(system).is_volumetric() || technique(system).is_depth_sprite();
    system.settings.sprite.debug_sprite && !is_read
}

fn reads_no_detail(system: &PresetSystem, _: UVec2) -> bool {
    !technique(system).is_depth_sprite() && system.settings.sprite.motion <= 0.0
}

fn has_one_frame(system: &PresetSystem, _: UVec2) -> bool {
    let material = &system.material;
    let is_file = builtin::find(builtin::SPRITES, &material.sprite).is_none();
    let is_one = is_file && (material.columns, material.rows) == (1, 1);
    // A single frame still moves towards itself.
    is_one && system.settings.sprite.motion <= 0.0 && !technique(system).is_volumetric()
}

fn plays_no_flipbook(system: &PresetSystem, _: UVec2) -> bool {
    !technique(system).is_volumetric()
        && matches!(system.settings.sprite.animation, SpriteAnimation::Still | SpriteAnimation::Volume)
}

fn stands_still(system: &PresetSystem, _: UVec2) -> bool {
    let scroll_speed = system.settings.volumetric.scroll_speed;
    if technique(system).is_volumetric() { scroll_speed == 0.0 } else { system.frame_rate() <= 0.0 }
}

fn is_painted(system: &PresetSystem) -> bool {
    system.settings.diffuse.mode == DiffuseMode::PaintedMotif
}

fn looks_up_no_ramp(system: &PresetSystem, _: UVec2) -> bool {
    let settings = &system.settings;
    let (is_forward, is_lit) = (settings.is_forward(), settings.diffuse.intensity > 0.0);
    let by_normal = is_lit && (is_forward || settings.diffuse.mode != DiffuseMode::SphericalHarmonics);
    let by_amount = settings.soft_scatter.intensity > 0.0 && settings.soft_scatter.mode == SoftScatterMode::Ramp;
    let others = if is_forward {
        settings.sprite.age_colour > 0.0
    } else {
        settings.coverage == CoverageMode::Ramp || settings.specular_scatter.intensity > 0.0
    };
    !(by_normal || by_amount || others)
}

fn needs_no_up(system: &PresetSystem, _: UVec2) -> bool {
    system.emitter.buoyancy == 0.0 && system.emitter.shape != EmitterShape::Disc
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::values;

    #[test]
    fn every_row_names_fields_that_there_are() {
        let preset =
            Preset { lights: vec![Light::default()], systems: vec![PresetSystem::default()], ..Preset::default() };
        let paths: Vec<_> = values(&preset).into_iter().map(|(path, _)| path).collect();
        let systems = OF_SYSTEMS.iter().flat_map(|row| row.fields).map(|field| format!("systems[0].{field}"));
        let lights = OF_LIGHTS.iter().flat_map(|row| row.fields).map(|field| format!("lights[0].{field}"));
        let environments =
            OF_ENVIRONMENTS.iter().flat_map(|row| row.fields).map(|field| format!("environment.{field}"));
        for field in systems.chain(lights).chain(environments) {
            let group = format!("{field}.");
            assert!(paths.iter().any(|path| *path == field || path.starts_with(&group)), "{field}");
        }
    }

    #[test]
    fn a_reason_is_told_once_and_only_for_what_it_is_about() {
        let preset = Preset { systems: vec![PresetSystem::default()], ..Preset::default() };
        let reason = |path: &str| preset.without_effect(path, UVec2::new(640, 360));
        assert_eq!(reason("systems[0].settings.blend_mode"), Some("forward only"));
        assert_eq!(reason("systems[0].settings.boost"), None);
        assert_eq!(reason("systems[1].settings.blend_mode"), None);
        assert_eq!(reason("camera.fov"), None);
        let mut reasons: Vec<_> = OF_SYSTEMS.iter().map(|row| row.reason).collect();
        reasons.sort_unstable();
        assert!(reasons.windows(2).all(|pair| pair[0] != pair[1]));
    }
}
