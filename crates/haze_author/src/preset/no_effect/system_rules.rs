//! Settings of a system that have no effect in their context: one row for each reason.

use glam::Vec3;
use haze_core::settings::{
    Backlight, BlendOrder, CoverageMode, DepthSource, Grain, RenderPath, ScaleMode, SoftScatterMode, SpriteAnimation,
    Technique,
};
use haze_preset::{PresetSystem, builtin};

use super::condition::{
    curve_ignores_power, has_no_animation, has_one_frame, ignores_up, is_at_full_resolution, is_hard, looks_up_no_ramp,
    plays_no_flipbook, reads_no_detail, shows_checkerboard_only, shows_through, technique, upsampling_reads_depth,
    uses_painted_motif,
};
use super::rule::{NoEffectRule, rule};

/// The first row that holds gives the reason.
pub const SYSTEM_RULES: &[NoEffectRule<PresetSystem>] = &[
    rule("the particles come from files", |s, _| s.particle_files.is_used(), &["emitter"]),
    rule(
        "only with particle files",
        |s, _| !s.particle_files.is_used(),
        &[
            "particle_files.units",
            "particle_files.up",
            "particle_files.position",
            "particle_files.fps",
            "particle_files.start",
            "particle_files.after",
            "particle_files.default_radius",
            "particle_files.default_amount",
            "particle_files.flipbook_rate",
        ],
    ),
    rule(
        "deferred only",
        |s, _| s.settings.is_forward(),
        &[
            "settings.accumulate.format",
            "settings.accumulate.encoding",
            "settings.accumulate.decode",
            "settings.accumulate.order",
            "settings.accumulate.depth_weight",
            "settings.accumulate.layers",
            "settings.accumulate.downscale",
            "settings.accumulate.scale_mode",
            "settings.accumulate.max_error",
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
    rule(
        "only with technique spherical_billboard",
        |s, _| technique(s) != Technique::SphericalBillboard,
        &["settings.spherical_billboard"],
    ),
    rule("only with technique density", |s, _| technique(s) != Technique::Density, &["settings.exponential"]),
    rule(
        "only with technique volumetric_hard or volumetric_soft",
        |s, _| !technique(s).is_volumetric(),
        &["settings.volumetric"],
    ),
    rule(
        "only with a volumetric technique, or grain",
        |s, _| !technique(s).is_volumetric() && s.settings.grain_octaves() == 0,
        &["material.noise"],
    ),
    rule("a checkerboard has no grain", |s, _| s.settings.debug.checkerboard, &["settings.grain"]),
    rule(
        "only with an erosion, a dissolve or a bump of the grain above 0",
        |s, _| Grain { erosion: 0.0, dissolve: 0.0, bump: 0.0, ..s.settings.grain } == s.settings.grain,
        &["settings.grain.tiles", "settings.grain.octaves"],
    ),
    rule(
        "volumetric techniques show noise in place of the sprite",
        |s, _| technique(s).is_volumetric(),
        &[
            "settings.sprite.animation",
            "settings.sprite.motion",
            "settings.debug.checkerboard",
            "settings.grain",
            "settings.lighting",
            "settings.diffuse.six_way_color",
            "settings.diffuse.six_way_anisotropy",
            "material.sprite",
            "material.detail",
            "material.six_way",
            "material.columns",
            "material.rows",
            "material.y_down",
            "emitter.spin",
            "emitter.rotation_spread",
            "emitter.frame_rate",
            "particle_files.flipbook_rate",
        ],
    ),
    rule(
        "a built-in sprite has its own",
        |s, _| builtin::find(builtin::SPRITES, &s.material.sprite).is_some(),
        &["material.detail", "material.columns", "material.rows", "material.y_down"],
    ),
    rule(
        "only with a technique that fades: soft, soft_linear, depth_sprite_soft, volumetric_soft",
        is_hard,
        &["settings.soft_fade.curve", "settings.soft_fade.contrast_power"],
    ),
    rule(
        "at full resolution only with a technique that fades",
        |s, size| is_hard(s, size) && !upsampling_reads_depth(s, size),
        &["settings.soft_fade.fade_scale", "settings.soft_fade.epsilon"],
    ),
    rule("only with curve contrast or exponential", curve_ignores_power, &["settings.soft_fade.contrast_power"]),
    rule(
        "not with curve always",
        |s, size| shows_through(s) && !upsampling_reads_depth(s, size),
        &["settings.soft_fade.epsilon"],
    ),
    rule(
        "only with order weighted",
        |s, _| s.settings.accumulate.order != BlendOrder::Weighted,
        &["settings.accumulate.depth_weight"],
    ),
    rule(
        "only on the paths tiled and auto, with order sorted",
        |s, _| {
            !matches!(s.settings.path, RenderPath::Tiled | RenderPath::Auto)
                || s.settings.accumulate.order != BlendOrder::Sorted
        },
        &["settings.accumulate.layers"],
    ),
    rule(
        "only with depth_source reduced",
        |s, _| s.settings.accumulate.depth_source != DepthSource::Reduced,
        &["settings.accumulate.scale_mode", "settings.accumulate.max_error"],
    ),
    rule(
        "only with scale_mode fixed",
        |s, _| {
            let accumulate = &s.settings.accumulate;
            (accumulate.scale_mode, accumulate.depth_source) == (ScaleMode::Auto, DepthSource::Reduced)
        },
        &["settings.accumulate.downscale"],
    ),
    rule(
        "only with scale_mode auto",
        |s, _| s.settings.accumulate.scale_mode != ScaleMode::Auto,
        &["settings.accumulate.max_error"],
    ),
    rule(
        "only at a downscale above 1",
        is_at_full_resolution,
        &[
            "settings.accumulate.depth_downsample",
            "settings.accumulate.upsample",
            "settings.accumulate.lighting_resolution",
        ],
    ),
    rule(
        "debug.checkerboard shows a checkerboard instead",
        |s, _| s.settings.debug.checkerboard,
        &[
            "settings.sprite.motion",
            "settings.lighting",
            "settings.diffuse.six_way_color",
            "settings.diffuse.six_way_anisotropy",
            "material.six_way",
        ],
    ),
    rule(
        "only with lighting normals",
        |s, _| s.settings.is_six_way(),
        &[
            "settings.accumulate.encoding",
            "settings.accumulate.decode",
            "settings.accumulate.layers",
            "settings.diffuse.mode",
            "settings.diffuse.backlight",
            "settings.fire.crust",
            "material.y_down",
            "material.diffuse_ramp",
            "material.backlight_ramp",
            "material.motif",
        ],
    ),
    rule(
        "only with lighting six_way",
        |s, _| !s.settings.is_six_way(),
        &["settings.diffuse.six_way_color", "settings.diffuse.six_way_anisotropy", "material.six_way"],
    ),
    rule(
        "debug.checkerboard shows one checkerboard for all frames",
        shows_checkerboard_only,
        &[
            "settings.sprite.animation",
            "settings.debug.freeze_animation",
            "emitter.frame_rate",
            "particle_files.flipbook_rate",
            "material.sprite",
            "material.detail",
            "material.columns",
            "material.rows",
            "material.y_down",
        ],
    ),
    rule("only with a depth_sprite technique, or sprite.motion above 0", reads_no_detail, &["material.detail"]),
    rule(
        "the sprite has one frame",
        has_one_frame,
        &[
            "settings.sprite.animation",
            "settings.debug.freeze_animation",
            "emitter.frame_rate",
            "particle_files.flipbook_rate",
        ],
    ),
    rule(
        "only with an animation that blends: flipbook, volume",
        |s, _| matches!(s.settings.sprite.animation, SpriteAnimation::Still | SpriteAnimation::Nearest),
        &["settings.sprite.motion"],
    ),
    rule(
        "only with animation flipbook or nearest",
        plays_no_flipbook,
        &["settings.debug.freeze_animation", "emitter.frame_rate", "particle_files.flipbook_rate"],
    ),
    rule(
        "debug.freeze_animation holds it",
        |s, _| s.settings.debug.freeze_animation,
        &["settings.volumetric.scroll_speed", "emitter.frame_rate", "particle_files.flipbook_rate"],
    ),
    rule("nothing moves: frame_rate and scroll_speed are 0", has_no_animation, &["settings.debug.freeze_animation"]),
    rule(
        "only at an intensity of fire above 0",
        |s, _| !s.settings.burns(),
        &[
            "settings.fire.core",
            "settings.fire.crust",
            "settings.fire.light",
            "settings.fire.flicker",
            "material.heat_ramp",
            "material.fire_ramp",
            "emitter.heat_spread",
        ],
    ),
    rule("only at a light of the fire above 0", |s, _| s.settings.fire.light <= 0.0, &["settings.fire.flicker"]),
    rule(
        "only at a sprite.tint above 0",
        |s, _| s.settings.sprite.tint <= 0.0,
        &["emitter.tint", "emitter.other_tint"],
    ),
    rule(
        "spheres are not stretched",
        |s, _| technique(s).is_sphere(),
        &["settings.sprite.stretch", "settings.sprite.stretch_limit", "settings.sprite.stretch_axis"],
    ),
    rule(
        "only at a sprite.stretch above 0",
        |s, _| s.settings.sprite.stretch <= 0.0,
        &["settings.sprite.stretch_limit", "settings.sprite.stretch_axis"],
    ),
    rule(
        "only at a stretch_limit above 1",
        |s, _| s.settings.sprite.stretch_limit <= 1.0,
        &["settings.sprite.stretch", "settings.sprite.stretch_axis"],
    ),
    rule("only at an age_color above 0", |s, _| s.settings.sprite.age_color <= 0.0, &["material.age_ramp"]),
    rule(
        "only at an intensity of diffuse light above 0",
        |s, _| s.settings.diffuse.intensity <= 0.0,
        &[
            "settings.diffuse.mode",
            "settings.diffuse.backlight",
            "settings.diffuse.six_way_color",
            "settings.diffuse.six_way_anisotropy",
            "settings.shadow",
            "settings.ambient",
            "material.diffuse_ramp",
            "material.backlight_ramp",
            "material.shadow_ramp",
            "material.motif",
        ],
    ),
    rule(
        "not with diffuse.mode painted_motif or spherical_harmonics",
        |s, _| !s.settings.can_have_ambient(),
        &["settings.ambient"],
    ),
    rule(
        "only at an intensity of ambient light above 0",
        |s, _| s.settings.ambient.intensity <= 0.0,
        &["settings.ambient.sky_color", "settings.ambient.ground_color"],
    ),
    rule(
        "only with lighting six_way, path forward or diffuse.mode ramp",
        |s, _| !s.settings.can_receive_shadow(),
        &["settings.shadow", "material.shadow_ramp"],
    ),
    rule(
        "only at a shadow.strength above 0",
        |s, _| s.settings.shadow.strength <= 0.0,
        &[
            "settings.shadow.density",
            "settings.shadow.lights",
            "settings.shadow.resolution",
            "settings.shadow.scene",
            "material.shadow_ramp",
        ],
    ),
    rule(
        "with path forward only at a shadow.strength above 0",
        |s, _| s.settings.is_forward() && !s.settings.receives_shadow(),
        &["settings.shadow.by_depth"],
    ),
    rule(
        "diffuse.mode painted_motif takes its light from the motif",
        |s, _| uses_painted_motif(s) && !s.settings.is_forward(),
        &["settings.diffuse.backlight", "material.diffuse_ramp", "material.backlight_ramp"],
    ),
    rule("only with diffuse.mode painted_motif", |s, _| !uses_painted_motif(s), &["material.motif"]),
    rule(
        "only at an intensity of soft scatter above 0",
        |s, _| s.settings.soft_scatter.intensity <= 0.0,
        &[
            "settings.soft_scatter.mode",
            "settings.soft_scatter.scatter_amount",
            "settings.soft_scatter.scatter_smooth",
            "settings.soft_scatter.scatter_color",
            "settings.soft_scatter.ambient_color",
            "material.soft_scatter_ramp",
        ],
    ),
    rule(
        "only with soft_scatter.mode smoothstep",
        |s, _| s.settings.soft_scatter.mode != SoftScatterMode::Smoothstep,
        &[
            "settings.soft_scatter.scatter_amount",
            "settings.soft_scatter.scatter_smooth",
            "settings.soft_scatter.scatter_color",
            "settings.soft_scatter.ambient_color",
        ],
    ),
    rule(
        "only with soft_scatter.mode ramp",
        |s, _| s.settings.soft_scatter.mode != SoftScatterMode::Ramp,
        &["material.soft_scatter_ramp"],
    ),
    rule("only with coverage ramp", |s, _| s.settings.coverage != CoverageMode::Ramp, &["material.coverage_ramp"]),
    rule(
        "only with diffuse.backlight ramp",
        |s, _| s.settings.diffuse.backlight != Backlight::Ramp,
        &["material.backlight_ramp"],
    ),
    rule("no ramp is looked up", looks_up_no_ramp, &["settings.ramp_filter"]),
    rule(
        "only at an intensity of specular scatter above 0",
        |s, _| s.settings.specular_scatter.intensity <= 0.0,
        &["settings.specular_scatter.size", "settings.specular_scatter.falloff", "material.specular_ramp"],
    ),
    rule(
        "only at a turbulence above 0",
        |s, _| s.emitter.turbulence <= 0.0,
        &[
            "emitter.turbulence_scale",
            "emitter.turbulence_detail",
            "emitter.turbulence_travel",
            "emitter.turbulence_speed",
        ],
    ),
    rule(
        "only at a ring_speed above 0",
        |s, _| s.emitter.ring_speed <= 0.0,
        &["emitter.ring_rate", "emitter.ring_size"],
    ),
    rule(
        "only at an attraction other than 0",
        |s, _| s.emitter.attraction == 0.0,
        &["emitter.attractor", "emitter.attractor_size"],
    ),
    rule(
        "only at an obstacle_margin above 0",
        |s, _| s.emitter.obstacle_margin <= 0.0,
        &["emitter.obstacle", "emitter.obstacle_extent"],
    ),
    rule("only at a small_fraction above 0", |s, _| s.emitter.small_fraction <= 0.0, &["emitter.small_size"]),
    rule("only where the extent is not 0", |s, _| s.emitter.extent == Vec3::ZERO, &["emitter.shape", "emitter.burst"]),
    rule(
        "only with buoyancy, a floor, an obstacle, anchor, rings, wind_shear, orbit, or shape disc",
        ignores_up,
        &["emitter.up"],
    ),
    rule(
        "only at a bounce or a floor_margin above 0",
        |s, _| s.emitter.bounce <= 0.0 && s.emitter.floor_margin <= 0.0,
        &["emitter.floor"],
    ),
    rule("only at a duration above 0", |s, _| s.emitter.duration <= 0.0, &["emitter.period", "emitter.rate_curve"]),
];
