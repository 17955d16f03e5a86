//! Formula tests of `shaders/lib/sprite_vertex.wgsl`.

use glam::{Vec2, Vec3, vec3};
use haze::Particle;
use haze_core::formula::sprite::{animation_frames, flipbook_frames, sprite_uv, trimmed_corner};
use haze_core::settings::{Settings, SpriteAnimation, Technique};
use haze_core::view_setup::ProjectedSprite;
use haze_reference::visible_system::VisibleSystem;

use super::Formula;
use super::fixture::visible_system;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, count, flag, halves, random, test_sprite, v3, with_choices};

/// Settings with the technique of the first number.
pub fn technique(x: &[f32]) -> Settings {
    Settings { technique: Technique::ALL[x[0] as usize], ..Settings::default() }
}

/// The particle of numbers 1 to 8, in motion.
fn particle(x: &[f32]) -> Particle {
    let velocity = Vec3::new(x[5], x[7], x[6]);
    Particle {
        position: v3(&x[1..]),
        radius: x[4],
        rotation: x[5],
        amount: x[6],
        frame: x[7],
        age: x[8],
        velocity,
        ..Particle::default()
    }
}

/// The system with larger spherical billboards, and stretched squares.
fn changed(settings: &Settings) -> VisibleSystem<'_> {
    let mut visible = visible_system(settings);
    let system = &mut visible.system;
    let stretch = if settings.technique.is_sphere() { 0.0 } else { 0.1 };
    system.billboard_radius = 1.3;
    system.stretch = stretch;
    system.stretch_limit = 2.5;
    if settings.technique as u32 % 2 == 1 {
        system.stretch_axis = vec3(4.0, 1.0, -2.0);
    }
    visible
}

/// WGSL of [`technique`], [`particle`] and [`changed`].
macro_rules! with_particle {
    ($wgsl:literal) => {
        concat!(
            "TECHNIQUE = u32(x(0)); STRETCH = !is_sphere(); system.billboard_radius = 1.3; system.stretch = 0.1; \
             if u32(x(0)) % 2u == 1u { system.stretch_axis = vec3f(4.0, 1.0, -2.0); } \
             system.stretch_limit = 2.5; let p = Particle(vec4f(x(1), x(2), x(3), x(4)), \
             vec4f(x(5), x(6), x(7), x(8)), vec3f(x(5), x(7), x(6)), vec4f(1.0)); ",
            $wgsl
        )
    };
}

/// Particles in front of the viewer and around the near plane, of every technique.
fn particles() -> Vec<Vec<f32>> {
    let mut cases = with_choices(
        count(Technique::ALL),
        &[(-2.0, 2.0), (-2.0, 2.0), (-6.0, -2.0), (0.1, 1.0), (-4.0, 4.0), (0.0, 1.5), (-3.0, 9.0), (0.0, 1.0)],
    );
    cases.extend(with_choices(
        count(Technique::ALL),
        &[(-0.5, 0.5), (-0.5, 0.5), (-1.0, 0.6), (0.1, 1.0), (-4.0, 4.0), (0.0, 1.0), (0.0, 3.0), (0.0, 1.0)],
    ));
    cases
}

/// A sprite in view space: radius in number 4, center in numbers 1 to 3.
fn sprite_at(x: &[f32]) -> ProjectedSprite {
    ProjectedSprite {
        center: v3(&x[1..]),
        radius: x[4],
        amount: 1.0,
        frames: flipbook_frames(0.0, 3.0),
        lod: 0.0,
        diameter: 1.0,
        stretch: Vec2::ZERO,
    }
}

fn centers() -> Vec<Vec<f32>> {
    with_choices(count(Technique::ALL), &[(-1.0, 1.0), (-1.0, 1.0), (-6.0, -2.0), (0.1, 1.5)])
}

pub fn formulas() -> Vec<Formula> {
    [techniques(), corners(), projection(), trimming()].into_iter().flatten().collect()
}

fn techniques() -> Vec<Formula> {
    let all = || with_choices(count(Technique::ALL), &[(0.1, 2.0)]);
    vec![
        Formula {
            name: "is_sphere",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "TECHNIQUE = u32(x(0)); y(0, f32(is_sphere()));",
            reference: |x| flag(technique(x).technique.is_sphere()),
            cases: all(),
            tolerance: 0.0,
            mutants: &[("TECHNIQUE_SPHERICAL_BILLBOARD || is_volumetric()", "TECHNIQUE_SPHERICAL_BILLBOARD")],
        },
        Formula {
            name: "is_volumetric",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "TECHNIQUE = u32(x(0)); y(0, f32(is_volumetric()));",
            reference: |x| flag(technique(x).technique.is_volumetric()),
            cases: all(),
            tolerance: 0.0,
            mutants: &[("== TECHNIQUE_VOLUMETRIC_SOFT", "== TECHNIQUE_DENSITY")],
        },
        Formula {
            name: "is_flat",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "TECHNIQUE = u32(x(0)); y(0, f32(is_flat()));",
            reference: |x| flag(technique(x).technique.is_flat()),
            cases: all(),
            tolerance: 0.0,
            mutants: &[("|| TECHNIQUE == TECHNIQUE_SOFT_LINEAR", "")],
        },
        Formula {
            name: "sprite_thickness",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "TECHNIQUE = u32(x(0)); y(0, sprite_thickness(x(1)));",
            reference: |x| vec![visible_system(&technique(x)).projector().sprite_thickness(x[1])],
            cases: all(),
            tolerance: 0.0,
            mutants: &[("select(radius, 0.0, is_flat())", "radius")],
        },
    ]
}

fn corners() -> Vec<Formula> {
    vec![
        Formula {
            name: "sprite_front",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "TECHNIQUE = u32(x(0)); y(0, sprite_front(vec4f(x(1), x(2), x(3), x(4))));",
            reference: |x| vec![visible_system(&technique(x)).projector().sprite_front(&sprite_at(x))],
            cases: with_choices(count(Technique::ALL), &[(-1.0, 1.0), (-1.0, 1.0), (-3.0, 0.5), (0.1, 1.5)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("- sprite_thickness(center_radius.w), view.near", ", view.near"),
                (", view.near);\n}", ", 0.0);\n}"),
            ],
        },
        Formula {
            name: "sphere_corner",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "view.orthographic = f32(x(0) > 4.0); let c = vec4f(x(1), x(2), x(3), x(4)); \
                   y2(0, pixel_from_ndc(sphere_corner(c, vec2f(-1.0, 1.0), 0.5), view.size)); \
                   y2(2, pixel_from_ndc(sphere_corner(c, vec2f(1.0, -1.0), 0.5), view.size));",
            reference: |x| {
                let settings = technique(x);
                let mut visible = visible_system(&settings);
                visible.view.orthographic = f32::from(x[0] > 4.0);
                let (low, high) = visible.projector().sphere_rectangle(&sprite_at(x), 0.5);
                [low.to_array(), high.to_array()].concat()
            },
            cases: centers(),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("vec2f(x.y, y.y), corner", "vec2f(x.x, y.y), corner"),
                ("center.xy + corner * radius", "center.xy"),
                (
                    "clamp((ray - view.ray_offset) / view.ray_scale, -edge, edge)",
                    "(ray - view.ray_offset) / view.ray_scale",
                ),
            ],
        },
    ]
}

fn projection() -> Vec<Formula> {
    vec![
        Formula {
            name: "project_sprite",
            file: "lib/sprite_vertex.wgsl",
            wgsl: with_particle!(
                "let s = project_sprite(p, 0.5); if s.hidden { return; } y(0, 1.0); y4(1, s.center_radius); \
                 y2(5, s.amount_lod_frame_erosion.xy); \
                 let f = flipbook_frames(s.amount_lod_frame_erosion.z, system.frame_count); \
                 y3(7, vec3f(f32(f.first), f32(f.second), f.blend)); y2(10, s.stretch);"
            ),
            reference: |x| {
                let settings = technique(x);
                let sprite = changed(&settings).projector().project(&particle(x), 0.5);
                sprite.map_or(vec![0.0; 12], |sprite| {
                    let ProjectedSprite { center, radius, amount, frames, lod, stretch, .. } = sprite;
                    let frames = [frames.first as f32, frames.second as f32, frames.blend];
                    [&[1.0][..], &center.to_array(), &[radius, amount, lod], &frames, &stretch.to_array()].concat()
                })
            },
            cases: particles(),
            tolerance: TRANSCENDENTAL,
            mutants: &[
                ("radius *= system.billboard_radius", "radius *= 1.0"),
                ("saturate(particle.rotation_amount_frame_age.y)", "particle.rotation_amount_frame_age.y"),
                ("near_fade(back,", "near_fade(view_depth,"),
                ("back > view.near && view_depth", "view_depth > view.near && view_depth"),
                ("max(view_depth, view.near), view.orthographic", "1.0, view.orthographic"),
                ("vec4f(particle.velocity, 0.0)", "vec4f(particle.velocity.zyx, 0.0)"),
                ("system.stretch, radius, system.stretch_limit", "system.stretch, radius, 1000.0"),
                ("vec4f(system.stretch_axis, 0.0)", "vec4f(system.stretch_axis.zyx, 0.0)"),
                ("if any(system.stretch_axis != vec3f(0.0))", "if false"),
            ],
        },
        Formula {
            name: "sprite_vertex",
            file: "lib/sprite_vertex.wgsl",
            wgsl: with_particle!(
                "system.alive_count = 7u; let v = sprite_vertex(p, u32(x(10)), u32(x(9)), vec4f(1.0, 1.0, 0.0, 0.0), 0.5); \
                 if v.position.x == 2.0 && v.position.w == 1.0 { return; } \
                 y2(0, pixel_from_ndc(v.position.xy / v.position.w, view.size)); y2(2, v.uv); y(4, v.position.w);"
            ),
            reference: |x| {
                let settings = technique(x);
                let visible = changed(&settings);
                let projector = visible.projector();
                let index = x[9] as usize;
                let sprite = projector.project(&particle(x), 0.5).filter(|_| (x[10] as u32) < 7);
                let Some(sprite) = sprite else { return vec![0.0; 5] };
                if settings.technique.is_sphere() {
                    let (low, high) = projector.sphere_rectangle(&sprite, 0.5);
                    let corner = [Vec2::new(low.x, high.y), high, low, Vec2::new(high.x, low.y)][index];
                    return vec![corner.x, corner.y, 0.0, 0.0, 1.0];
                }
                let reach = projector.trimmed_extent(&sprite);
                let pixel = projector.corners(&sprite, reach, x[5])[[2, 3, 1, 0][index]];
                let corner = haze_core::formula::sprite::sprite_corner(index as u32);
                let uv = sprite_uv(trimmed_corner(corner, reach));
                vec![pixel.x, pixel.y, uv.x, uv.y, -projector.clamped_to_near_plane(sprite.center).z]
            },
            cases: {
                let corners = random(particles().len() as u32, &[(0.0, 3.99), (0.0, 8.99)]);
                particles().into_iter().zip(corners).map(|(case, corner)| [case, corner].concat()).collect()
            },
            // Corners close to the near plane are far outside the view.
            tolerance: 1e-3,
            mutants: &[
                ("position.x * out.rotation.x - position.y", "position.x * out.rotation.x + position.y"),
                ("turned = stretched(turned, out.stretch)", "turned = unstretched(turned, out.stretch)"),
                ("min(center.z, -view.near)", "center.z"),
                (" || index >= system.alive_count", ""),
                ("let position = trimmed_corner(corner, ", "let position = trimmed_corner(corner, 0.5 * "),
            ],
        },
    ]
}

fn trimming() -> Vec<Formula> {
    vec![
        Formula {
            name: "alpha_bounds_texel",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "CHECKERBOARD = x(2) > 0.7; MOTION = x(3) > 0.7; let t = alpha_bounds_texel(i32(x(0)), x(1)); \
                   y_word(0, t.x); y_word(2, t.y); y_word(4, t.z);",
            reference: |x| {
                if x[2] > 0.7 || x[3] > 0.7 {
                    return vec![65535.0; 6];
                }
                let bounds = test_sprite().alpha_bounds(None);
                let words: Vec<u32> = bytemuck::pod_collect_to_vec(bounds.bytes());
                let level = (x[1] as u32).min(bounds.size().x - 1);
                let at = 4 * (x[0] as u32 * bounds.size().x + level) as usize;
                words[at..at + 3].iter().flat_map(|&word| halves(word)).collect()
            },
            cases: random(100, &[(0.0, 2.99), (0.0, 6.0), (0.0, 1.0), (0.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("if CHECKERBOARD || MOTION", "if CHECKERBOARD"), ("vec2i(level, frame +", "vec2i(0, frame +")],
        },
        Formula {
            name: "trimmed_extent",
            file: "lib/sprite_vertex.wgsl",
            wgsl: "y4(0, trimmed_extent(animation_frames(u32(x(0)), x(1), 3.0), x(2)));",
            reference: |x| {
                let settings = Settings::default();
                let frames = animation_frames(SpriteAnimation::ALL[x[0] as usize], x[1], 3.0);
                let sprite = ProjectedSprite { frames, lod: x[2], ..sprite_at(&[0.0; 5]) };
                visible_system(&settings).projector().trimmed_extent(&sprite).to_array().to_vec()
            },
            cases: with_choices(count(SpriteAnimation::ALL), &[(0.0, 3.0), (0.0, 5.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("unpack4x8unorm(alpha_bounds_texel(frames.first, lod).z)", "vec4f(1.0)")],
        },
    ]
}
