//! Formula tests of `shaders/lib/lit_smoke.wgsl`, `shaders/lib/diffuse.wgsl`, `shaders/lib/accumulated.wgsl`,
//! `shaders/lib/bindings.wgsl` and `shaders/lib/glow.wgsl`.

use glam::{IVec2, Vec2, Vec3, Vec4};
use haze_core::assets::image::Image;
use haze_core::formula::six_way::SixWay;
use haze_core::formula::uniforms::LightUniform;
use haze_core::settings::*;
use haze_reference::accumulated::{AccumulatedTarget, LitTarget};
use haze_reference::pass::transfer::Surface;
use haze_reference::shade::Shade;
use haze_reference::visible_system::VisibleSystem;

use super::Formula;
use super::fixture::{COLORS, DEFAULTS, DEPTHS, SIZE, accumulated_target, visible_system};
use super::inputs::{TRANSCENDENTAL, count, random, unit_vectors, v2, v3, v4, with_choices};

const SIDE: (f32, f32) = (-1.0, 1.0);
/// A position in view space, near the smoke.
const PLACE: [(f32, f32); 3] = [(-2.0, 2.0), (-2.0, 2.0), (-7.0, -5.0)];

/// The reduced depth in metres, as the reference stores it.
fn reduced_depth(visible: &VisibleSystem<'_>) -> Image<f32> {
    let limit = visible.system.depth_limit;
    Image { size: SIZE, texels: DEPTHS.texels.iter().map(|depth| depth * limit).collect() }
}

/// Limits of depth that the red channel of the test ramp crosses.
fn with_limits(visible: &mut VisibleSystem<'_>) {
    visible.system.depth_limit = 8.0;
    visible.system.smoke_depth_limit = 6.0;
}

/// The lit target of the reference. Its light and its slopes are the test ramp.
fn lit_target() -> LitTarget {
    LitTarget { light: COLORS.clone(), slopes: COLORS.clone() }
}

fn with_target<T>(
    settings: &Settings,
    change: impl Fn(&mut VisibleSystem<'_>),
    f: impl Fn(&AccumulatedTarget<'_>) -> T,
) -> T {
    let mut visible = visible_system(settings);
    change(&mut visible);
    let depth = reduced_depth(&visible);
    f(&accumulated_target(&visible, &depth))
}

/// Settings with values that the shader reads as override constants.
fn changed(change: impl Fn(&mut Settings)) -> Settings {
    let mut settings = Settings::default();
    change(&mut settings);
    settings
}

pub fn formulas() -> Vec<Formula> {
    [accumulated(), lit_targets(), diffuse(), surfaces(), lit_surfaces(), specular_scatter()]
        .into_iter()
        .flatten()
        .collect()
}

fn accumulated() -> Vec<Formula> {
    vec![
        Formula {
            name: "load_scene_depth",
            file: "lib/bindings.wgsl",
            wgsl: "view.origin = vec2f(2.0, 1.0); y(0, load_scene_depth(vec2i(i32(x(0)), i32(x(1)))));",
            reference: |x| vec![DEPTHS.load(IVec2::new(x[0] as i32 + 2, x[1] as i32 + 1))],
            cases: random(30, &[(0.0, 5.9), (0.0, 2.9)]),
            tolerance: 1e-5,
            mutants: &[("pixel + vec2i(view.origin)", "pixel")],
        },
        Formula {
            name: "scene_view_depth",
            file: "lib/accumulated.wgsl",
            wgsl: "y(0, scene_view_depth(vec2f(x(0), x(1))));",
            reference: |x| vec![visible_system(&DEFAULTS).scene_view_depth(v2(x).as_ivec2())],
            cases: random(30, &[(0.0, 7.9), (0.0, 3.9)]),
            tolerance: 1e-3,
            mutants: &[(
                "view_depth_from_ndc_depth(load_scene_depth(vec2i(pixel)), view.depth_coefficients)",
                "load_scene_depth(vec2i(pixel))",
            )],
        },
        Formula {
            name: "clamped_texel",
            file: "lib/accumulated.wgsl",
            wgsl: "let at = clamped_texel(vec2i(floor(vec2f(x(0), x(1))))); y4(0, textureLoad(test_ramp, at, 0));",
            reference: |x| COLORS.load(v2(x).floor().as_ivec2()).to_array().to_vec(),
            cases: random(50, &[(-5.0, 14.0), (-5.0, 9.0)]),
            tolerance: 1e-5,
            mutants: &[
                ("vec2i(system.target_size) - 1)", "vec2i(system.target_size) - 2)"),
                ("clamp(texel, vec2i(0),", "clamp(texel, vec2i(1),"),
            ],
        },
        Formula {
            name: "guide",
            file: "lib/accumulated.wgsl",
            wgsl: "system.depth_limit = 8.0; system.smoke_depth_limit = 6.0; y(0, guide(vec2i(i32(x(0)), i32(x(1)))));",
            reference: |x| with_target(&DEFAULTS, with_limits, |target| vec![target.guide(v2(x).as_ivec2())]),
            cases: random(40, &[(0.0, 7.9), (0.0, 3.9)]),
            tolerance: 1e-4,
            mutants: &[
                ("* system.depth_limit, system.smoke_depth_limit)", "* system.depth_limit, 1.0e6)"),
                ("0).r * system.depth_limit", "0).r"),
            ],
        },
        Formula {
            name: "sample_target",
            file: "lib/accumulated.wgsl",
            wgsl: "UPSAMPLE = u32(x(0)); system.scale = select(2u, 1u, x(3) < 0.2); system.depth_limit = 8.0; \
                   system.smoke_depth_limit = 6.0; y4(0, sample_target(test_ramp, vec2f(x(1), x(2))));",
            reference: |x| {
                let settings = changed(|s| s.accumulate.upsample = Upsample::ALL[x[0] as usize]);
                let change = |visible: &mut VisibleSystem<'_>| {
                    with_limits(visible);
                    visible.system.scale = if x[3] < 0.2 { 1 } else { 2 };
                };
                let pixel = v2(&x[1..]);
                with_target(&settings, change, |target| target.sample_target(&COLORS, pixel).to_array().to_vec())
            },
            cases: with_choices(count(Upsample::ALL), &[(-0.5, 7.9), (-0.5, 3.9), (0.0, 1.0)]),
            tolerance: 2e-3,
            mutants: &[
                ("let corner = texel - 0.5;", "let corner = texel;"),
                ("if any(texel < vec2f(0.0)) ||", "if"),
                ("clamped_texel(base + vec2i(1, 0))", "clamped_texel(base)"),
                ("let offset = vec2i(i % 4, i / 4) - 1;", "let offset = vec2i(i % 4, i / 4);"),
            ],
        },
        Formula {
            name: "shading_position",
            file: "lib/accumulated.wgsl",
            wgsl: "view.orthographic = f32(x(2) > 0.5); y3(0, shading_position(vec2f(x(0), x(1))));",
            reference: |x| {
                let mut visible = visible_system(&DEFAULTS);
                visible.view.orthographic = f32::from(x[2] > 0.5);
                visible.view_position(v2(x), -visible.system.center.z).to_array().to_vec()
            },
            cases: random(60, &[(0.0, 8.0), (0.0, 4.0), (0.0, 1.0)]),
            tolerance: 1e-5,
            mutants: &[("-system.center.z, view.orthographic", "1.0, view.orthographic")],
        },
    ]
}

fn lit_targets() -> Vec<Formula> {
    vec![
        Formula {
            name: "sample_lit",
            file: "lib/lit_target.wgsl",
            wgsl: "UPSAMPLE = u32(x(0)); system.scale = select(2u, 1u, x(3) < 0.2); system.depth_limit = 8.0; \
                   system.smoke_depth_limit = 6.0; y4(0, sample_lit(vec2f(x(1), x(2)), filter_texel_size()));",
            reference: |x| {
                let settings = changed(|s| s.accumulate.upsample = Upsample::ALL[x[0] as usize]);
                let change = |visible: &mut VisibleSystem<'_>| {
                    with_limits(visible);
                    visible.system.scale = if x[3] < 0.2 { 1 } else { 2 };
                };
                let mut visible = visible_system(&settings);
                change(&mut visible);
                let depth = reduced_depth(&visible);
                let target = AccumulatedTarget { lit: Some(lit_target()), ..accumulated_target(&visible, &depth) };
                // Other modes sample the first texture, which is the lit one in both.
                target.sample_lit(v2(&x[1..])).to_array().to_vec()
            },
            cases: with_choices(count(Upsample::ALL), &[(-0.5, 7.9), (-0.5, 3.9), (0.0, 1.0)]),
            tolerance: 2e-3,
            mutants: &[
                ("UPSAMPLE != UPSAMPLE_GUIDED || system.scale == 1u", "system.scale == 1u"),
                ("textureLoad(depth_slopes, at[1], 0)", "vec4f(0.0)"),
                ("mix(mean_of_sixteen(base, fraction, depth), four, weight)", "four"),
                (
                    "if any(texel < vec2f(0.0)) || any(texel >= system.target_size) {\n        return vec4f(0.0);\n    }\n    if !EXACT",
                    "if !EXACT",
                ),
            ],
        },
        Formula {
            name: "mean_of_sixteen",
            file: "lib/lit_target.wgsl",
            wgsl: "system.depth_limit = 8.0; system.smoke_depth_limit = 6.0; \
                   y4(0, mean_of_sixteen(vec2i(i32(x(0)), i32(x(1))), vec2f(x(2), x(3)), x(4)));",
            reference: |x| {
                let base = v2(x).as_ivec2();
                let fraction = v2(&x[2..]);
                let mean = |target: &AccumulatedTarget<'_>| {
                    target.mean_of_sixteen(|at| COLORS.load(at), base, fraction, x[4]).to_array().to_vec()
                };
                with_target(&DEFAULTS, with_limits, mean)
            },
            cases: random(60, &[(0.0, 7.9), (0.0, 3.9), (0.0, 1.0), (0.0, 1.0), (1.0, 7.0)]),
            tolerance: 1e-4,
            mutants: &[
                (
                    "vec2i(i % 4, i / 4) - 1;\n        let at = clamped_texel(base + offset);\n        let weight",
                    "vec2i(i % 4, i / 4);\n        let at = clamped_texel(base + offset);\n        let weight",
                ),
                ("return sum / total", "return sum / 4.0"),
                ("guide(at) - depth), depth);\n        sum", "0.0), depth);\n        sum"),
            ],
        },
    ]
}

/// The system, with or without shadow.
fn shaded_system(settings: &Settings, has_shadow: bool) -> VisibleSystem<'_> {
    let mut visible = visible_system(settings);
    visible.system.shadow_strength = if has_shadow { 0.8 } else { 0.0 };
    visible
}

const FRACTION: (f32, f32) = (0.0, 1.0);

/// Sky and ground, before the test's own lines. `x[6..9]` is up.
macro_rules! sky {
    ($lines:literal) => {
        concat!(
            "SHADOW = x(0) > 0.5; system.shadow_strength = select(0.0, 0.8, SHADOW); system.up = vec3f(x(6), x(7), x(8)); \
             system.sky_color = vec3f(0.2, 0.5, 0.9); system.ground_color = vec3f(0.7, 0.4, 0.1);",
            $lines
        )
    };
}

/// The system under a sky, with or without shadow.
fn under_a_sky(has_shadow: bool, up: Vec3) -> VisibleSystem<'static> {
    let mut visible = shaded_system(&DEFAULTS, has_shadow);
    visible.system.sky_color = Vec3::new(0.2, 0.5, 0.9);
    visible.system.ground_color = Vec3::new(0.7, 0.4, 0.1);
    visible.system.up = up;
    visible
}

fn diffuse() -> Vec<Formula> {
    vec![
        Formula {
            name: "diffuse_from_lights",
            file: "lib/diffuse.wgsl",
            wgsl: "BACKLIGHT = u32(x(0)); \
                   SHADOW = x(8) > 0.5; system.shadow_strength = select(0.0, 0.8, SHADOW); \
                   var shade = shade_of_sprites(vec3f(0.3, 0.8, x(8))); shade.visible = vec3f(1.0, 0.5, 0.9); \
                   y3(0, diffuse_from_lights(vec3f(x(1), x(2), x(3)), x(4), vec3f(x(5), x(6), x(7)), shade));",
            reference: |x| {
                let settings = changed(|s| s.diffuse.backlight = Backlight::ALL[x[0] as usize]);
                let visible = shaded_system(&settings, x[8] > 0.5);
                let shade = shade(Vec3::new(0.3, 0.8, x[8]));
                visible.diffuse_from_lights(v3(&x[1..]), x[4], v3(&x[5..]), &shade).to_array().to_vec()
            },
            cases: unit_vectors(
                with_choices(
                    count(Backlight::ALL),
                    &[SIDE, SIDE, SIDE, (0.0, 1.0), PLACE[0], PLACE[1], PLACE[2], (0.0, 3.0)],
                ),
                1,
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("lights[i].color * light.attenuation * shadow;", "lights[i].color * shadow;"),
                ("lights[i].color * light.attenuation * shadow;", "lights[i].color * light.attenuation;"),
                ("light.direction, covered, against", "light.direction, 0.5, against"),
                (
                    "for (var i = 0u; i < system.light_count; i++) {\n        of_block = shade_of_block(lights[i].shadow_slot, shade, of_block);\n        let light = sample_light(lights[i], position);\n        let against",
                    "for (var i = 0u; i < 1u; i++) {\n        of_block = shade_of_block(lights[i].shadow_slot, shade, of_block);\n        let light = sample_light(lights[i], position);\n        let against",
                ),
            ],
        },
        Formula {
            name: "diffuse_from_six_way",
            file: "lib/diffuse.wgsl",
            wgsl: "let s = SixWay(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))); \
                   system.six_way_color = vec3f(0.9, 0.7, 0.5); \
                   SHADOW = x(0) > 0.5; system.shadow_strength = select(0.0, 0.8, SHADOW); \
                   var shade = shade_of_sprites(vec3f(0.3, 0.8, x(1))); shade.visible = vec3f(1.0, 0.5, 0.9); \
                   y3(0, diffuse_from_six_way(s, vec3f(x(6), x(7), x(8)), shade));",
            reference: |x| {
                let mut visible = shaded_system(&DEFAULTS, x[0] > 0.5);
                visible.system.six_way_color = Vec3::new(0.9, 0.7, 0.5);
                let six_way = SixWay { positive: v3(x), negative: v3(&x[3..]) };
                let shade = shade(Vec3::new(0.3, 0.8, x[1]));
                visible.diffuse_from_six_way(&six_way, v3(&x[6..]), &shade).to_array().to_vec()
            },
            cases: random(
                100,
                &[(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), PLACE[0], PLACE[1], PLACE[2]],
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("return sum * system.six_way_color", "return sum"),
                ("(response * light.attenuation)", "response"),
                ("(response * light.attenuation) * shadow;", "(response * light.attenuation);"),
            ],
        },
        Formula {
            name: "shadow_on_light",
            file: "lib/diffuse.wgsl",
            wgsl: "SHADOW = true; system.shadow_strength = 0.8; let position = vec3f(x(7), x(8), x(9)); \
                   let to_viewer = direction_to_viewer(position, view.orthographic); \
                   var shade = shade_of_sprites(vec3f(x(1), x(2), x(3))); shade.visible = vec3f(0.9, 0.5, 0.7); \
                   y3(0, shadow_on_light(x(0), first_block(shade), vec3f(x(4), x(5), x(6)), to_viewer));",
            reference: |x| {
                let visible = shaded_system(&DEFAULTS, true);
                let light = LightUniform { shadow_slot: x[0], ..visible.lights[0] };
                let mut shade = Shade::of_sprites(v3(&x[1..]));
                shade.visible[0] = Vec3::new(0.9, 0.5, 0.7);
                visible.shadow_on_light(&light, v3(&x[4..]), v3(&x[7..]), &shade).to_array().to_vec()
            },
            cases: unit_vectors(
                with_choices(4, &[(0.0, 3.0), (0.0, 3.0), (0.0, 3.0), SIDE, SIDE, SIDE, PLACE[0], PLACE[1], PLACE[2]]),
                4,
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                (
                    "shadow_position(select_slot(slot, shade.optical_depths), to_light",
                    "shadow_position(select_slot(slot, shade.optical_depths), -to_light",
                ),
                ("|| slot < 0.5", ""),
                (", system.shadow_strength);", ", 1.0);"),
                ("through * select_slot(slot, shade.visible)", "through"),
            ],
        },
        Formula {
            name: "ambient_from_ramp",
            file: "lib/diffuse.wgsl",
            wgsl: sky!("y3(0, ambient_from_ramp(vec3f(x(3), x(4), x(5)), x(2), vec2f(x(0), x(1))));"),
            reference: |x| {
                let visible = under_a_sky(x[0] > 0.5, v3(&x[6..]));
                visible.ambient_from_ramp(v3(&x[3..]), x[2], v2(x)).to_array().to_vec()
            },
            cases: unit_vectors(
                unit_vectors(random(100, &[FRACTION, FRACTION, FRACTION, SIDE, SIDE, SIDE, SIDE, SIDE, SIDE]), 3),
                6,
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("hemisphere_coordinate(normal, -system.up)", "hemisphere_coordinate(normal, system.up)"),
                (
                    "system.ground_color * shadow_on_hemisphere(openness.y)",
                    "system.ground_color * shadow_on_hemisphere(openness.x)",
                ),
                ("return light.sky * sample_ramp_2d", "return light.ground * sample_ramp_2d"),
            ],
        },
        Formula {
            name: "ambient_from_six_way",
            file: "lib/diffuse.wgsl",
            wgsl: sky!(
                "let s = SixWay(vec3f(x(2), x(3), x(4)), vec3f(x(4), x(2), x(3))); \
                 y3(0, ambient_from_six_way(s, vec2f(x(0), x(1))));"
            ),
            reference: |x| {
                let mut visible = under_a_sky(x[0] > 0.5, v3(&x[6..]));
                // Both renderers multiply the sum of all light.
                visible.system.six_way_color = Vec3::ONE;
                let six_way = SixWay { positive: Vec3::new(x[2], x[3], x[4]), negative: Vec3::new(x[4], x[2], x[3]) };
                visible.ambient_from_six_way(&six_way, v2(x)).to_array().to_vec()
            },
            cases: unit_vectors(
                random(100, &[FRACTION, FRACTION, FRACTION, FRACTION, FRACTION, FRACTION, SIDE, SIDE, SIDE]),
                6,
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("six_way.negative, -system.up)", "six_way.negative, system.up)"),
                ("painted, system.shadow_strength", "painted, 1.0"),
            ],
        },
        Formula {
            name: "soft_scatter",
            file: "lib/diffuse.wgsl",
            wgsl: "SOFT_SCATTER_MODE = u32(x(0)); system.soft_scatter_intensity = 0.7; y3(0, soft_scatter(x(1)));",
            reference: |x| {
                let settings = changed(|s| s.soft_scatter.mode = SoftScatterMode::ALL[x[0] as usize]);
                let mut visible = visible_system(&settings);
                visible.system.soft_scatter_intensity = 0.7;
                visible.soft_scatter(x[1]).to_array().to_vec()
            },
            cases: with_choices(count(SoftScatterMode::ALL), &[(0.0, 1.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("system.scatter_color, system.ambient_color,", "system.ambient_color, system.scatter_color,"),
                ("linear_sampler, amount) * system.soft_scatter_intensity", "linear_sampler, amount)"),
            ],
        },
    ]
}

fn shade(optical_depths: Vec3) -> Shade {
    let mut shade = Shade::of_sprites(optical_depths);
    shade.visible[0] = Vec3::new(1.0, 0.5, 0.9);
    shade
}

fn surfaces() -> Vec<Formula> {
    vec![
        Formula {
            name: "smoke_coverage",
            file: "lib/coverage.wgsl",
            wgsl: "COVERAGE_MODE = u32(x(0)); y(0, smoke_coverage(x(1)));",
            reference: |x| {
                let settings = changed(|s| s.coverage = CoverageMode::ALL[x[0] as usize]);
                vec![with_target(&settings, |_| {}, |target| target.coverage(x[1]))]
            },
            cases: with_choices(count(CoverageMode::ALL), &[(0.0, 1.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("let covered = coverage(amount, system.boost)", "let covered = amount"),
                ("if COVERAGE_MODE == COVERAGE_MODE_RAMP", "if false"),
            ],
        },
        Formula {
            name: "surface_from_accumulation",
            file: "lib/lit_smoke.wgsl",
            wgsl: "NORMAL_DECODE = u32(x(0)); SIX_WAY_SLOT = u32(x(9) > 0.7); WEIGHTS_SLOT = u32(x(9) < 0.3); OPTICAL_DEPTHS_SLOT = 1u; DEPTH_SLOT = 1u; HEAT_SLOT = 1u; \
                   NORMAL_ENCODING = select(NORMAL_ENCODING_SIGNED, NORMAL_ENCODING_BIASED, x(9) < 0.3); \
                   let s = surface_from_accumulation(vec4f(x(1), x(2), x(3), x(4)), \
                   Attachments(vec4f(x(5), x(6), x(7), x(8)), x(5), vec4f(x(1), x(2), x(3), x(4)), vec4f(x(5), x(6), x(7), x(8)), vec4f(x(2), x(4), x(6), x(8)), vec4f(0.0))); \
                   y3(0, s.normal); y3(3, s.six_way.positive); y3(6, s.six_way.negative); y3(9, s.shade.optical_depths); y(12, s.depth.x); y(13, s.depth.y); y(14, s.heat.x); y(15, s.heat.y);",
            reference: |x| {
                let settings = changed(|s| {
                    s.accumulate.decode = NormalDecode::ALL[x[0] as usize];
                    s.accumulate.encoding = NormalEncoding::Signed;
                    if x[9] > 0.7 {
                        s.lighting = Lighting::SixWay;
                    }
                    if x[9] < 0.3 {
                        s.accumulate.order = BlendOrder::Weighted;
                        s.accumulate.encoding = NormalEncoding::Biased;
                    }
                });
                let heat = Vec4::new(x[2], x[4], x[6], x[8]);
                let attachments = [v4(&x[1..]), v4(&x[5..]), v4(&x[5..]), v4(&x[1..]), v4(&x[5..]), heat, Vec4::ZERO];
                let surface = with_target(&settings, |_| {}, |target| target.surface(&attachments));
                let SixWay { positive, negative } = surface.six_way;
                let vectors = [surface.normal, positive, negative, surface.shade.optical_depths[0]];
                let pairs = [surface.depth, surface.heat];
                vectors.iter().flat_map(Vec3::to_array).chain(pairs.iter().flat_map(|pair| pair.to_array())).collect()
            },
            cases: with_choices(
                count(NormalDecode::ALL),
                &[SIDE, SIDE, (0.0, 1.0), (0.1, 1.0), (0.1, 1.0), SIDE, SIDE, (0.1, 1.0), (0.0, 1.0)],
            ),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("weights = attachments.weights;", "weights = accumulated.a * 2.0;"),
                ("depths.rgb / max(depths.a, 1.0e-6)", "depths.rgb"),
                // Heat that is not premultiplied.
                ("vec2f(0.0)) / max(attachments.heat.a, 1.0e-6)", "vec2f(0.0))"),
                ("max(accumulated.rgb, vec3f(0.0)) * scale", "accumulated.rgb * scale"),
                (
                    "normal_from_six_way(surface.six_way.positive, surface.six_way.negative)",
                    "normal_from_six_way(surface.six_way.negative, surface.six_way.positive)",
                ),
            ],
        },
    ]
}

fn lit_surfaces() -> Vec<Formula> {
    // Modes of diffuse light that read no baked texture: ramp, painted motif and spherical harmonics.
    let modes = |mut case: Vec<f32>| {
        case[0] = [DiffuseMode::Ramp, DiffuseMode::PaintedMotif, DiffuseMode::SphericalHarmonics][case[0] as usize]
            as u32 as f32;
        case
    };
    vec![Formula {
        name: "diffuse",
        file: "lib/lit_smoke.wgsl",
        wgsl: "DIFFUSE_MODE = u32(x(0)); SIX_WAY_SLOT = u32(x(8) > 0.8); system.diffuse_intensity = 0.6; \
                   for (var i = 0u; i < 9u; i++) { system.spherical_harmonics[i] = vec4f(0.3, 0.2, 0.1, 0.0) * f32(i); } \
                   let s = Surface(vec3f(x(1), x(2), x(3)), SixWay(vec3f(0.2, 0.4, 0.6), vec3f(0.1, 0.3, 0.5)), shade_of_sprites(vec3f(0.0)), vec2f(0.0), vec2f(0.0), vec3f(0.9, 0.8, x(4))); \
                   y3(0, diffuse(s, x(4), vec3f(x(5), x(6), x(7))));",
        reference: |x| {
            let settings = changed(|s| {
                s.diffuse.mode = DiffuseMode::ALL[x[0] as usize];
                if x[8] > 0.8 {
                    s.lighting = Lighting::SixWay;
                }
            });
            let change = |visible: &mut VisibleSystem<'_>| {
                visible.system.diffuse_intensity = 0.6;
                visible.system.spherical_harmonics = std::array::from_fn(|i| Vec4::new(0.3, 0.2, 0.1, 0.0) * i as f32);
            };
            let six_way = SixWay { positive: Vec3::new(0.2, 0.4, 0.6), negative: Vec3::new(0.1, 0.3, 0.5) };
            let depth = Vec2::ZERO;
            let heat = Vec2::ZERO;
            let tint = Vec3::new(0.9, 0.8, x[4]);
            let surface = Surface { normal: v3(&x[1..]), six_way, shade: Shade::NONE, depth, heat, tint };
            with_target(&settings, change, |target| target.diffuse(&surface, x[4], v3(&x[5..])).to_array().to_vec())
        },
        cases: unit_vectors(
            with_choices(3, &[SIDE, SIDE, SIDE, (0.0, 1.0), PLACE[0], PLACE[1], PLACE[2], (0.0, 1.0)])
                .into_iter()
                .map(modes)
                .collect(),
            1,
        ),
        tolerance: TRANSCENDENTAL,
        mutants: &[
            ("return light * system.diffuse_intensity * surface.tint;", "return light * surface.tint;"),
            ("return light * system.diffuse_intensity * surface.tint;", "return light * system.diffuse_intensity;"),
            ("motif_position(normal) * 0.5 + 0.5", "motif_position(normal)"),
            (
                "diffuse_from_six_way(surface.six_way, position, surface.shade) * system.diffuse_intensity",
                "diffuse_from_six_way(surface.six_way, position, surface.shade)",
            ),
            ("coverage(amount, system.boost), position,", "amount, position,"),
        ],
    }]
}

fn specular_scatter() -> Vec<Formula> {
    vec![Formula {
        name: "light_visibility",
        file: "lib/glow.wgsl",
        wgsl: "y(0, light_visibility(vec2f(x(0), x(1)), x(2), x(3)));",
        reference: |x| vec![with_target(&DEFAULTS, |_| {}, |target| target.light_visibility(v2(x), x[2], x[3]))],
        cases: random(100, &[(0.0, 8.0), (0.0, 4.0), (0.5, 3.0), (0.1, 0.6)]),
        tolerance: 1e-5,
        mutants: &[("pixel + visibility_tap(i, radius)", "pixel"), (">= light_depth", "< light_depth")],
    }]
}
