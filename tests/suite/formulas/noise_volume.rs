//! Formula tests of `shaders/lib/noise_volume.wgsl`.

use haze_core::formula::noise_volume;

use super::Formula;
use super::inputs::{ARITHMETIC, random, test_noise, v3, with_choices};

pub fn formulas() -> Vec<Formula> {
    vec![
        Formula {
            name: "load_noise_volume",
            file: "lib/noise_volume.wgsl",
            wgsl: "let size = vec3i(textureDimensions(test_noise)); \
                   y4(0, load_noise_volume(test_noise, vec3i(floor(vec3f(x(0), x(1), x(2)))), size));",
            reference: |x| noise_volume::load_noise_volume(test_noise(), v3(x).floor().as_ivec3()).to_array().to_vec(),
            cases: random(100, &[(-20.0, 20.0); 3]),
            tolerance: 1e-6,
            mutants: &[("((texel % size) + size) % size", "clamp(texel, vec3i(0), size - 1)")],
        },
        Formula {
            name: "sample_noise_volume",
            file: "lib/noise_volume.wgsl",
            wgsl: "let v = sample_noise_volume(test_noise, test_sampler, vec3f(x(0), x(1), x(2))); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| noise_volume::sample_noise_volume(test_noise(), v3(x)).to_array().to_vec(),
            cases: random(200, &[(-2.0, 2.0); 3]),
            // `fract` has an error of 1e-7; times 8 texels, times the steepest slope between two texels, 2.
            tolerance: 2e-5,
            mutants: &[
                ("((texel % size) + size) % size", "clamp(texel, vec3i(0), size - 1)"),
                ("fract(coordinate) * vec3f(size) - 0.5", "fract(coordinate) * vec3f(size)"),
                ("mix(near, far, f.z)", "near"),
            ],
        },
        Formula {
            name: "sample_noise_octaves",
            file: "lib/noise_volume.wgsl",
            wgsl: "let v = sample_noise_octaves(test_noise, test_sampler, vec3f(x(1), x(2), x(3)), 1u + u32(x(0))); \
                   y(0, v.x); y(1, v.y); y(2, v.z); y(3, v.w);",
            reference: |x| {
                let octaves = 1 + x[0] as u32;
                noise_volume::sample_noise_octaves(test_noise(), v3(&x[1..]), octaves).to_array().to_vec()
            },
            cases: with_choices(4, &[(-1.0, 1.0); 3]),
            // The rounding error of a coordinate is multiplied by 27 in the fourth octave.
            tolerance: 2e-4,
            mutants: &[
                ("position *= 3.0", "position *= 2.0"),
                ("weight *= 0.5", "weight *= 1.0"),
                ("sum / total", "sum"),
                ("texel.rgb * 2.0 - 1.0", "texel.rgb"),
            ],
        },
        Formula {
            name: "noise_coordinate",
            file: "lib/noise_volume.wgsl",
            wgsl: "let v = noise_coordinate(vec3f(x(0), x(1), x(2)), x(3), vec3f(x(4), x(5), x(6))); y(0, v.x); y(1, v.y); y(2, v.z);",
            reference: |x| noise_volume::noise_coordinate(v3(x), x[3], v3(&x[4..])).to_array().to_vec(),
            cases: random(50, &[(-9.0, 9.0), (-9.0, 9.0), (-9.0, 9.0), (0.5, 4.0), (0.0, 2.0), (0.0, 2.0), (0.0, 2.0)]),
            // Coordinates are as large as 20.
            tolerance: ARITHMETIC * 10.0,
            mutants: &[("from_eye + noise_offset", "from_eye - noise_offset"), ("/ noise_size", "* noise_size")],
        },
    ]
}
