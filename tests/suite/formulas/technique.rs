//! Formula tests of `shaders/lib/technique.wgsl`.

use glam::vec3;
use haze_core::formula::technique;

use super::Formula;
use super::inputs::{ARITHMETIC, TRANSCENDENTAL, random, unit_vectors, v2, v3};

pub fn formulas() -> Vec<Formula> {
    [flat_sprites(), spheres(), volumes()].into_iter().flatten().collect()
}

fn flat_sprites() -> Vec<Formula> {
    vec![
        Formula {
            name: "hard_fade",
            file: "lib/technique.wgsl",
            wgsl: "y(0, hard_fade(x(0)));",
            reference: |x| vec![technique::hard_fade(x[0])],
            cases: random(50, &[(-1.0, 1.0)]),
            tolerance: 0.0,
            mutants: &[("distance >= 0.0", "distance <= 0.0")],
        },
        Formula {
            name: "depth_sprite_depth",
            file: "lib/technique.wgsl",
            wgsl: "y(0, depth_sprite_depth(x(0), x(1), x(2)));",
            reference: |x| vec![technique::depth_sprite_depth(x[0], x[1], x[2])],
            cases: random(50, &[(1.0, 9.0), (-1.0, 1.0), (0.0, 2.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("- offset * radius", "+ offset * radius"), ("offset * radius", "offset")],
        },
    ]
}

fn spheres() -> Vec<Formula> {
    vec![
        Formula {
            name: "ray_sphere",
            file: "lib/technique.wgsl",
            wgsl: "let v = ray_sphere(vec3f(0.1, 0.2, 0.3), vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5)), x(6), x(7), \
                   x(7) + x(8)); y(0, v.enter); y(1, v.leave); y(2, v.axis.x); y(3, v.axis.y); y(4, v.axis.z);",
            reference: |x| {
                let origin = vec3(0.1, 0.2, 0.3);
                let found = technique::ray_sphere(origin, v3(x), v3(&x[3..]), x[6], x[7], x[7] + x[8]);
                vec![found.enter, found.leave, found.axis.x, found.axis.y, found.axis.z]
            },
            // Rays that miss, rays that hit, and rays whose chord is cut at either end.
            cases: unit_vectors(
                random(
                    300,
                    &[
                        (-0.3, 0.3),
                        (-0.3, 0.3),
                        (-1.0, -0.5),
                        (-1.0, 1.0),
                        (-1.0, 1.0),
                        (-6.0, 0.5),
                        (0.0, 2.0),
                        (0.1, 4.0),
                        (0.0, 6.0),
                    ],
                ),
                0,
            ),
            // Near the rim, the half chord is the root of a small difference of squares: an error of 1e-7 under the
            // root becomes 3e-4.
            tolerance: 5e-4,
            mutants: &[
                ("max(middle - half_chord, near)", "middle - half_chord"),
                ("min(middle + half_chord, scene)", "middle + half_chord"),
                ("radius * radius - dot(axis, axis)", "radius * radius"),
            ],
        },
        Formula {
            name: "spherical_billboard_amount",
            file: "lib/technique.wgsl",
            wgsl: "y(0, spherical_billboard_amount(x(0), x(1), x(2), x(3)));",
            reference: |x| vec![technique::spherical_billboard_amount(x[0], x[1], x[2], x[3])],
            cases: {
                let mut cases = random(100, &[(0.0, 4.0), (0.0, 1.5), (0.5, 1.5), (-0.5, 2.0)]);
                cases.push(vec![1.0, 0.0, 0.0, 1.0]);
                cases
            },
            tolerance: TRANSCENDENTAL,
            mutants: &[("1.0 - axis_distance / max", "axis_distance / max"), ("max(stretch, 0.0)", "stretch")],
        },
        Formula {
            name: "sphere_axis_bounds",
            file: "lib/technique.wgsl",
            wgsl: "let v = sphere_axis_bounds(vec2f(x(0), x(1)), x(2), x(3)); y(0, v.x); y(1, v.y);",
            reference: |x| technique::sphere_axis_bounds(v2(x), x[2], x[3]).to_array().to_vec(),
            cases: {
                let mut cases = random(300, &[(-3.0, 3.0), (0.3, 6.0), (0.05, 2.0), (0.1, 0.3)]);
                // Spheres entirely nearer than the near plane are not drawn.
                cases.retain(|x| x[1] + x[2] > x[3]);
                cases
            },
            // Tangents that touch close to the near plane are steep and meet it far from the center of the sphere.
            tolerance: 2e-3,
            mutants: &[
                ("vec2f(center.x - cut, center.x + cut)", "vec2f(center.x, center.x)"),
                ("cosine * center.x - sine * center.y", "cosine * center.x + sine * center.y"),
                ("!clipped || upper.y", "upper.y < 0.0 || upper.y"),
            ],
        },
    ]
}

fn volumes() -> Vec<Formula> {
    vec![
        Formula {
            name: "density_thickness",
            file: "lib/technique.wgsl",
            wgsl: "y(0, density_thickness(x(0), x(1), x(2), x(3)));",
            reference: |x| vec![technique::density_thickness(x[0], x[1], x[2], x[3])],
            cases: random(200, &[(0.1, 4.0), (0.0, 2.0), (0.1, 2.0), (0.1, 6.0)]),
            tolerance: ARITHMETIC,
            mutants: &[
                ("min(scene, view_depth + radius)", "(view_depth + radius)"),
                ("max(near, view_depth - radius)", "(view_depth - radius)"),
            ],
        },
        Formula {
            name: "visible_slab_fraction",
            file: "lib/technique.wgsl",
            wgsl: "y(0, visible_slab_fraction(x(0), x(1), x(2)));",
            reference: |x| vec![technique::visible_slab_fraction(x[0], x[1], x[2])],
            cases: random(100, &[(-2.0, 3.0), (0.1, 2.0), (0.05, 0.5)]),
            tolerance: ARITHMETIC * 10.0,
            mutants: &[
                ("radius - near)", "radius)"),
                ("saturate((view_depth + radius - near)", "((view_depth + radius - near)"),
            ],
        },
        Formula {
            name: "density_amount",
            file: "lib/technique.wgsl",
            wgsl: "y(0, density_amount(x(0), x(1)));",
            reference: |x| vec![technique::density_amount(x[0], x[1])],
            cases: random(50, &[(0.0, 4.0), (0.0, 2.0)]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("1.0 - exp(-density * thickness)", "density * thickness")],
        },
        Formula {
            name: "volumetric_falloff",
            file: "lib/technique.wgsl",
            wgsl: "y(0, volumetric_falloff(vec3f(x(0), x(1), x(2))));",
            reference: |x| vec![technique::volumetric_falloff(v3(x))],
            cases: random(100, &[(-1.0, 1.0); 3]),
            tolerance: ARITHMETIC,
            mutants: &[("dot(position, position)", "length(position)"), ("saturate(1.0", "(1.0")],
        },
        Formula {
            name: "volumetric_density",
            file: "lib/technique.wgsl",
            wgsl: "y(0, volumetric_density(x(0), x(1)));",
            reference: |x| vec![technique::volumetric_density(x[0], x[1])],
            cases: random(100, &[(0.0, 1.0); 2]),
            tolerance: ARITHMETIC,
            mutants: &[("2.0 * noise - 1.0 + falloff", "noise"), ("* falloff;", ";")],
        },
        Formula {
            name: "march_boundary",
            file: "lib/technique.wgsl",
            wgsl: "y(0, march_boundary(x(0)));",
            reference: |x| vec![technique::march_boundary(x[0])],
            cases: random(100, &[(0.0, 1.0)]),
            tolerance: ARITHMETIC,
            mutants: &[("squared * squared", "squared"), ("2.0 * done - 1.0", "done")],
        },
        Formula {
            name: "volumetric_normal",
            file: "lib/technique.wgsl",
            wgsl: "let v = volumetric_normal(vec3f(x(0), x(1), x(2)), vec3f(x(3), x(4), x(5))); \
                   y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| technique::volumetric_normal(v3(x), v3(&x[3..])).to_array().to_vec(),
            cases: random(100, &[(-1.0, 1.0); 6]),
            tolerance: TRANSCENDENTAL,
            mutants: &[("position + 2.0 * gradient", "position - 2.0 * gradient"), ("max(normal.z, 0.1)", "normal.z")],
        },
    ]
}
