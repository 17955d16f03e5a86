//! Formula tests of `shaders/lib/sprite_fragment.wgsl`.

use glam::{Vec2, Vec3};
use haze_core::formula::depth::{view_depth_from_linear, view_depth_from_ndc_depth};
use haze_core::formula::sprite::{animation_frames, flipbook_frames};
use haze_core::formula::technique::RayInterval;
use haze_core::formula::uniforms::SystemUniform;
use haze_core::settings::{FadeCurve, Grain, Lighting, Settings, SpriteAnimation, Technique};
use haze_reference::sprite::{SpriteFragment, SpriteSetup};

use super::Formula;
use super::fixture::{DEFAULTS, visible_system};
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, random, v2, v3, with_choices};
use super::sprite_vertex::technique;

/// A sprite straight ahead, with frame 0.7 of the flipbook.
fn sprite(center: Vec3, radius: f32, lod: f32) -> SpriteSetup {
    SpriteSetup {
        center,
        view_depth: -center.z,
        radius,
        rotation: Vec2::new(0.6, 0.8),
        stretch: Vec2::new(0.5, -0.3),
        amount: 0.8,
        lod,
        frames: flipbook_frames(0.7, 3.0),
        reach: glam::Vec4::ONE,
        age: 0.5,
        erosion: 0.5,
        fineness: 0.0,
        optical_depths: Vec3::ZERO,
        heat: 0.0,
        tint: Vec3::ONE,
        weight: 1.0,
        min: Vec2::ZERO,
        max: Vec2::ZERO,
    }
}

/// WGSL of [`sprite`]: the center in numbers 1 to 3, the radius in number 4.
macro_rules! with_sprite {
    ($wgsl:literal) => {
        concat!(
            "TECHNIQUE = u32(x(0)); var in: SpriteVertex; in.center_radius = vec4f(x(1), x(2), x(3), x(4)); \
             in.amount_lod_frame_erosion = vec4f(0.8, x(5), 0.7, 0.5); in.rotation = vec2f(0.6, 0.8); in.stretch = vec2f(0.5, -0.3); STRETCH = true; \
             let frames = flipbook_frames(0.7, 3.0); ",
            $wgsl
        )
    };
}

fn numbers(fragment: &SpriteFragment) -> Vec<f32> {
    [&fragment.normal.to_array()[..], &[fragment.amount, fragment.thickness]].concat()
}

/// Settings of a technique with a short fade.
fn settings(x: &[f32]) -> Settings {
    let mut settings = technique(x);
    settings.soft_fade.curve = FadeCurve::Linear;
    settings.volumetric.march_steps = 5;
    settings.volumetric.noise_octaves = 2;
    settings
}

/// Changes of the uniforms that make every technique visible.
fn changed(system: SystemUniform) -> SystemUniform {
    SystemUniform { billboard_density: 1.5, density: 1.2, volume_opacity: 3.0, ..system }
}

macro_rules! changes {
    () => {
        "FADE_CURVE = FADE_CURVE_LINEAR; system.billboard_density = 1.5; system.density = 1.2; \
         system.volume_opacity = 3.0; MARCH_STEPS = 5u; NOISE_OCTAVES = 2u; "
    };
}

pub fn formulas() -> Vec<Formula> {
    [depths(), texels(), techniques(), spheres()].into_iter().flatten().collect()
}

fn depths() -> Vec<Formula> {
    vec![
        Formula {
            name: "host_view_depth",
            file: "lib/sprite_fragment.wgsl",
            wgsl: "LINEAR_DEPTH = x(0) > 0.5; view.depth_offset = x(2); y(0, host_view_depth(x(1)));",
            reference: |x| {
                let coefficients = visible_system(&DEFAULTS).view.depth_coefficients;
                vec![match x[0] > 0.5 {
                    true => view_depth_from_linear(x[1] + x[2]),
                    false => view_depth_from_ndc_depth(x[1], coefficients),
                }]
            },
            cases: random(60, &[(0.0, 1.0), (0.0, 0.99), (-2.0, 2.0)]),
            tolerance: 1e-4,
            mutants: &[("texel + view.depth_offset", "texel"), ("if LINEAR_DEPTH {", "if !LINEAR_DEPTH {")],
        },
        Formula {
            name: "fragment_frames",
            file: "lib/sprite_fragment.wgsl",
            wgsl: "SPRITE_ANIMATION = u32(x(0)); var in: SpriteVertex; in.amount_lod_frame_erosion.z = x(1); \
                   let f = fragment_frames(in); y3(0, vec3f(f32(f.first), f32(f.second), f.blend));",
            reference: |x| {
                let frames = animation_frames(SpriteAnimation::ALL[x[0] as usize], x[1], 3.0);
                vec![frames.first as f32, frames.second as f32, frames.blend]
            },
            cases: with_choices(count(SpriteAnimation::ALL), &[(0.0, 9.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("in.amount_lod_frame_erosion.z, system.frame_count);\n}", "0.0, system.frame_count);\n}")],
        },
        Formula {
            name: "fade_before",
            file: "lib/sprite_fragment.wgsl",
            wgsl: "FADE_CURVE = u32(x(0)); y(0, fade_before(x(1), x(2)));",
            reference: |x| {
                let mut settings = Settings::default();
                settings.soft_fade.curve = FadeCurve::ALL[x[0] as usize];
                vec![visible_system(&settings).fade_before(x[1], x[2])]
            },
            cases: with_choices(count(FadeCurve::ALL), &[(4.0, 6.0), (4.0, 6.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("scene - view_depth, system.fade_scale", "view_depth - scene, system.fade_scale")],
        },
    ]
}

fn texels() -> Vec<Formula> {
    vec![Formula {
        name: "sprite_texel",
        file: "lib/sprite_fragment.wgsl",
        wgsl: with_sprite!(
            "CHECKERBOARD = x(0) == 1.0; SIX_WAY = x(0) == 2.0 || x(0) == 4.0; \
             GRAIN_OCTAVES = select(0u, 2u, x(0) > 2.0); system.grain_bump = 0.8; system.grain_tiles = 0.5; system.grain_fineness = 0.1; \
             if SIX_WAY { system.frame_count = 1.0; } \
             let f = sprite_texel(in, vec2f(x(6), x(7)), flipbook_frames(select(0.7, 0.0, SIX_WAY), \
             system.frame_count), vec2f(x(8), x(9))); y3(0, f.normal); y(3, f.amount); y(4, f.thickness); y3(5, f.six_way.positive); \
             y3(8, f.six_way.negative);"
        ),
        reference: |x| {
            let mut settings = Settings::default();
            settings.debug.checkerboard = x[0] == 1.0;
            if x[0] == 2.0 || x[0] == 4.0 {
                settings.lighting = Lighting::SixWay;
            }
            if x[0] > 2.0 {
                settings.grain = Grain { erosion: 0.5, octaves: 2, ..Grain::default() };
            }
            let mut visible = visible_system(&settings);
            let system = &mut visible.system;
            system.grain_bump = 0.8;
            system.grain_tiles = 0.5;
            system.grain_fineness = 0.1;
            let mut sprite = sprite(v3(&x[1..]), x[4], x[5]);
            sprite.fineness = visible.fineness_of(sprite.radius, sprite.view_depth, 1.0);
            if settings.is_six_way() {
                visible.system.frame_count = 1.0;
                sprite.frames = flipbook_frames(0.0, 1.0);
            }
            let fragment = visible.sprite_texel(&sprite, v2(&x[6..]), v2(&x[8..]));
            let six_way = [fragment.six_way.positive.to_array(), fragment.six_way.negative.to_array()].concat();
            [numbers(&fragment), six_way].concat()
        },
        cases: with_choices(
            5,
            &[
                (-1.0, 1.0),
                (-1.0, 1.0),
                (-6.0, -2.0),
                (0.1, 1.0),
                (0.0, 3.0),
                (0.0, 1.0),
                (0.0, 1.0),
                (-0.1, 0.1),
                (-0.1, 0.1),
            ],
        ),
        tolerance: 1e-5,
        mutants: &[
            ("offset_frames(frames, 2 * count)", "offset_frames(frames, count)"),
            ("rotate_normal(normal, in.rotation)", "normal"),
            ("tilted_normal(normal, tilt)", "normal"),
            ("tilted_six_way(light, tilt)", "light"),
            ("1.0 - vec3f(tilt, 0.0)", "1.0 + vec3f(tilt, 0.0)"),
            ("eroded(fragment.amount, grain.z, in.amount_lod_frame_erosion.w)", "fragment.amount"),
            ("fragment.thickness = fragment.amount;", ""),
            ("(f32(frames.first) + frames.blend) / system.frame_count", "f32(frames.first) / system.frame_count"),
            ("* distance / in.center_radius.w", "* in.center_radius.w"),
            ("stretched_normal(normal, in.stretch)", "normal"),
            ("if !CHECKERBOARD {", "if true {"),
            ("uv, frames, motion, lod);\n    }\n    var normal", "uv, frames, -motion, lod);\n    }\n    var normal"),
        ],
    }]
}

/// Center, radius, mip level, pixel and scene depth.
const RANGES: [(f32, f32); 8] =
    [(-0.3, 0.3), (-0.3, 0.3), (-5.0, -1.0), (1.0, 2.5), (0.0, 1.0), (2.0, 6.0), (1.0, 3.0), (1.0, 7.0)];
/// Center, radius, mip level, entry and length of the interval on the ray, and scene depth.
const MARCH: [(f32, f32); 8] =
    [(-0.3, 0.3), (-0.3, 0.3), (-5.0, -3.0), (1.0, 2.0), (0.0, 1.0), (1.5, 3.0), (0.5, 2.0), (1.0, 7.0)];

fn techniques() -> Vec<Formula> {
    let visible_fragment: fn(&[f32]) -> Vec<f32> = |x| {
        let settings = settings(x);
        let mut visible = visible_system(&settings);
        visible.system = changed(visible.system);
        let sprite = sprite(v3(&x[1..]), x[4], x[5]);
        let fragment = visible.technique_fragment(&sprite, v2(&x[6..]), x[8]);
        fragment.map_or(vec![0.0; 4], |fragment| numbers(&fragment))
    };
    vec![Formula {
        name: "technique_fragment",
        file: "lib/sprite_fragment.wgsl",
        // Squares: the position in the sprite, from the pixel. The reference leaves out pixels outside of it.
        wgsl: concat!(
            changes!(),
            with_sprite!(
                "\
                let ray = ndc_from_pixel(vec2f(x(6), x(7)), view.size) * view.ray_scale + view.ray_offset; \
                in.view_position = view_position(ray, 1.0, view.orthographic); \
                let depth = max(-in.center_radius.z, view.near); \
                let offset = unstretched(ray * depth - in.center_radius.xy, in.stretch); \
                let local = unrotate(offset, in.rotation) / in.center_radius.w; \
                in.uv = sprite_uv(local); \
                if !is_sphere() && any(abs(local) > vec2f(1.0)) { return; } \
                let f = technique_fragment(in, frames, x(8)); if f.hidden { return; } y3(0, f.normal); y(3, f.amount); y(4, f.thickness);"
            )
        ),
        reference: visible_fragment,
        cases: with_choices(count(Technique::ALL), &RANGES),
        tolerance: 1e-3,
        mutants: &[
            ("amount *= visible_slab_fraction(view_depth, radius, view.near);", ""),
            ("fade = hard_fade(scene - texel_depth)", "fade = hard_fade(scene - view_depth)"),
            ("default: { fade = fade_before(scene, texel_depth); }", "default: { fade = 1.0; }"),
            ("fragment.amount *= amount * fade", "fragment.amount *= fade"),
            ("system.density * fragment.amount * amount", "system.density * amount"),
            ("depth_sprite_depth(view_depth, texel.x, radius)", "view_depth"),
        ],
    }]
}

fn spheres() -> Vec<Formula> {
    vec![
        Formula {
            name: "sphere_fragment",
            file: "lib/sprite_fragment.wgsl",
            wgsl: concat!(
                changes!(),
                with_sprite!(
                    "\
                TECHNIQUE = TECHNIQUE_SPHERICAL_BILLBOARD; view.orthographic = x(9); \
                let ray = ndc_from_pixel(vec2f(x(6), x(7)), view.size) * view.ray_scale + view.ray_offset; \
                in.view_position = view_position(ray, 1.0, view.orthographic); \
                let f = sphere_fragment(in, frames, x(8)); if f.hidden { return; } y3(0, f.normal); y(3, f.amount); y(4, f.thickness);"
                )
            ),
            reference: |x| {
                let settings = settings(&[Technique::SphericalBillboard as u32 as f32]);
                let mut visible = visible_system(&settings);
                visible.system = changed(visible.system);
                visible.view.orthographic = x[9];
                let fragment = visible.sphere_fragment(&sprite(v3(&x[1..]), x[4], x[5]), v2(&x[6..]), x[8]);
                fragment.map_or(vec![0.0; 4], |fragment| numbers(&fragment))
            },
            cases: {
                let numbered = |(index, case): (usize, Vec<f32>)| [case, vec![(index % 2) as f32]].concat();
                with_choices(1, &RANGES).into_iter().chain(with_choices(2, &RANGES)).enumerate().map(numbered).collect()
            },
            tolerance: 1e-3,
            mutants: &[
                (
                    "spherical_billboard_amount(density, length(interval.axis)",
                    "spherical_billboard_amount(density, 0.0",
                ),
                (
                    "let position = unrotate(interval.axis.xy, in.rotation) / radius;",
                    "let position = interval.axis.xy / radius;",
                ),
                ("in.view_position.xy * view.orthographic, 0.0", "vec2f(0.0), 0.0"),
            ],
        },
        Formula {
            name: "volumetric_fragment",
            file: "lib/sprite_fragment.wgsl",
            wgsl: concat!(
                changes!(),
                with_sprite!(
                    "\
                TECHNIQUE = select(TECHNIQUE_VOLUMETRIC_HARD, TECHNIQUE_VOLUMETRIC_SOFT, x(0) > 0.5); \
                let along = normalize(vec3f(0.1, -0.05, -1.0)); \
                let f = volumetric_fragment(in, x(8), vec3f(0.0), along, RayInterval(x(6), x(6) + x(7), vec3f(0.0))); \
                y3(0, f.normal); y(3, f.amount); y(4, f.thickness);"
                )
            ),
            reference: |x| {
                let technique = if x[0] > 0.5 { Technique::VolumetricSoft } else { Technique::VolumetricHard };
                let settings = settings(&[technique as u32 as f32]);
                let mut visible = visible_system(&settings);
                visible.system = changed(visible.system);
                let along = Vec3::new(0.1, -0.05, -1.0).normalize();
                let interval = RayInterval { enter: x[6], leave: x[6] + x[7], axis: Vec3::ZERO };
                let sprite = sprite(v3(&x[1..]), x[4], x[5]);
                numbers(&visible.volumetric_fragment(&sprite, x[8], Vec3::ZERO, along, interval))
            },
            cases: with_choices(2, &MARCH),
            tolerance: 1e-3,
            mutants: &[
                ("if TECHNIQUE == TECHNIQUE_VOLUMETRIC_SOFT {", "if false {"),
                ("transmittance *= 1.0 - amount;", ""),
                ("normal / max(total, 1.0e-6)", "normal"),
                ("0.5 * (begin + end) * span", "end * span"),
                ("opacity * (end - begin)", "opacity * end"),
                ("        begin = end;\n", ""),
                ("entry.z + along.z * distance", "entry.z"),
            ],
        },
    ]
}
