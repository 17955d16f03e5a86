//! Compares every WGSL function of `shaders/lib` with the Rust function of the same name. Each WGSL function is also
//! compared after deliberate mistakes (mutants), which must fail: otherwise the comparison proves nothing. Each shader
//! file has a module of the same name here.

mod blending;
mod colour;
mod compute;
mod depth;
mod diffuse_bake;
mod emitter;
mod gradient_noise;
mod hash;
mod inputs;
mod lighting;
mod noise_volume;
mod normal;
mod order;
mod ramp;
mod six_way;
mod soft_fade;
mod sprite;
mod technique;
mod tonemap;
mod upsample;
mod view;

use haze::shader;

use self::inputs::{test_noise, test_ramp, test_sprite};
use crate::gpu::gpu;

/// Largest number of inputs or results of a case.
const WIDTH: usize = 32;

/// One function of `shaders/lib`, with the code that evaluates it in WGSL and in Rust.
struct Formula {
    /// Name of the WGSL function and of its Rust counterpart.
    name: &'static str,
    /// Shader file that defines it.
    file: &'static str,
    /// WGSL statements that read inputs `x(i)` and write results with `y(i, value)`.
    wgsl: &'static str,
    /// The same computation with the Rust function.
    reference: fn(&[f32]) -> Vec<f32>,
    /// Inputs of each case.
    cases: Vec<Vec<f32>>,
    /// Largest allowed difference, relative to max(1, |expected|).
    tolerance: f32,
    /// Deliberate mistakes, as (text in the composed shader, replacement). Each must fail the comparison.
    mutants: &'static [(&'static str, &'static str)],
}

fn formulas() -> Vec<Formula> {
    let all = [
        blending::formulas(),
        colour::formulas(),
        depth::formulas(),
        diffuse_bake::formulas(),
        emitter::formulas(),
        gradient_noise::formulas(),
        hash::formulas(),
        lighting::formulas(),
        noise_volume::formulas(),
        normal::formulas(),
        order::formulas(),
        ramp::formulas(),
        six_way::formulas(),
        soft_fade::formulas(),
        sprite::formulas(),
        technique::formulas(),
        tonemap::formulas(),
        upsample::formulas(),
        view::formulas(),
    ];
    all.into_iter().flatten().collect()
}

/// Runs the formula on the GPU. `mutate` is a (text, replacement) pair that is applied to the composed shader first.
fn run(formula: &Formula, mutate: Option<(&str, &str)>) -> Vec<Vec<f32>> {
    let mut library = format!("#import \"{}\"\n", formula.file);
    if !["lib/sprite.wgsl", "lib/ramp.wgsl", "lib/noise_volume.wgsl"].contains(&formula.file) {
        library.push_str("#import \"lib/ramp.wgsl\"\n");
    }
    let mut source = shader::compose(&library).unwrap();
    if let Some((from, to)) = mutate {
        assert!(source.contains(from), "{}: the shader does not contain {from:?}, the text of a mutant", formula.name);
        source = source.replace(from, to);
    }
    // One case per workgroup, because llvmpipe 22 uses the level of the first invocation for every textureLoad of a
    // SIMD group.
    source.push_str(&format!(
        "@group(0) @binding(0) var<storage, read> inputs: array<f32>;
         @group(0) @binding(1) var<storage, read_write> results: array<f32>;
         @group(0) @binding(2) var test_ramp: texture_2d<f32>;
         @group(0) @binding(3) var test_sprite: texture_2d_array<f32>;
         @group(0) @binding(4) var test_sampler: sampler;
         @group(0) @binding(5) var test_noise: texture_3d<f32>;
         var<private> case_index: u32;
         fn x(i: u32) -> f32 {{ return inputs[case_index * {WIDTH}u + i]; }}
         fn y(i: u32, value: f32) {{ results[case_index * {WIDTH}u + i] = value; }}
         @compute @workgroup_size(1)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             case_index = id.x;
             if case_index * {WIDTH}u >= arrayLength(&inputs) {{ return; }}
             {}
         }}",
        formula.wgsl
    ));
    let results = compute::compute(gpu(), &source, &formula.cases, WIDTH, &test_ramp(), &test_sprite(), test_noise());
    gpu().check().unwrap_or_else(|error| panic!("{}: {error}\n{source}", formula.name));
    results
}

/// Returns the largest difference from the Rust function, relative to max(1, |expected|).
fn error(formula: &Formula, results: &[Vec<f32>]) -> f32 {
    let mut worst = 0.0_f32;
    for (case, result) in formula.cases.iter().zip(results) {
        for (expected, found) in (formula.reference)(case).into_iter().zip(result) {
            assert!(expected.is_finite(), "{}: the Rust function returns {expected} for {case:?}", formula.name);
            let difference = (expected - found).abs() / expected.abs().max(1.0);
            worst = worst.max(if difference.is_nan() { f32::INFINITY } else { difference });
        }
    }
    worst
}

#[test]
fn every_wgsl_formula_matches_its_rust_function() {
    for formula in formulas() {
        let worst = error(&formula, &run(&formula, None));
        println!("{}: {worst:e}", formula.name);
        assert!(worst <= formula.tolerance, "{}: WGSL and Rust differ by {worst:e}", formula.name);
    }
}

#[test]
fn every_mutated_wgsl_formula_fails_the_comparison() {
    for formula in formulas() {
        assert!(!formula.mutants.is_empty(), "{} has no mutants", formula.name);
        for &mutant in formula.mutants {
            let worst = error(&formula, &run(&formula, Some(mutant)));
            assert!(worst > 10.0 * formula.tolerance, "{}: the mutant {mutant:?} passes ({worst:e})", formula.name);
        }
    }
}

/// Functions without a [`Formula`]: either a tested formula calls them, or they read the bindings of a pass and are
/// covered by tests of whole frames.
const INDIRECT: &[&str] = &[
    "load_sprite_bilinear",
    "sample_sprite_frame",
    "last_level",
    "sample_at_level",
    "sprite_corner",
    "sprite_vertex",
    "project_sprite",
    "diffuse",
    "diffuse_from_lights",
    "diffuse_from_six_way",
    "surface_from_accumulation",
    "attachments_from_fragment",
    "accumulated_from",
    "add_attachments",
    "slots_from_attachments",
    "attachments_from_slots",
    "sample_attachments",
    "load_attachments",
    "sample_flipbook",
    "smoke_coverage",
    "light_visibility",
    "stored_depth",
    "soft_scatter",
    "scene_view_depth",
    "clamped_texel",
    "sample_target",
    "shading_position",
    "load_noise_volume",
    "load_scene_depth",
    "target_colour",
    "is_sphere",
    "is_volumetric",
    "sprite_thickness",
    "sprite_front",
    "sphere_corner",
    "reads_scene",
    "fragment_frames",
    "technique_fragment",
    "host_view_depth",
    "fade_before",
    "sprite_texel",
    "sphere_fragment",
    "volumetric_fragment",
    // Covered by the whole frames of tests/suite/tiled.rs.
    "inclusive_sum",
    "packed_rect",
    "rects_meet",
    "run_count",
    "is_visible",
    "front_to_back_bits",
    "ray_through_texel",
    "texel_of_ray",
    "texel_of_ndc",
    "uv_in_square",
    "reach_in_square",
    "square_fills",
    "packed_frames",
    "frames_of",
    "lod_of",
    "alpha_bounds_texel",
    "trimmed_extent",
    "filled_cells",
    "cell_at",
    "is_filled",
    "is_filled_between",
    "bytes_below",
    "touches",
    "fragment_of",
    "digit_of",
    "rounds",
    "total_and_before",
    "low_of_bin",
    "touched_bins",
    "list_fits",
    "bin_list",
    "bits_of",
    "bits_below",
    "refine_words",
    "tested_view_depth",
    "farthest_visible_depth",
    "visible_parts",
    "init_texel",
    "accumulate_sprite",
    "is_opaque",
    "is_opaque_or_occluded",
    "approximate_amount",
    "is_flat",
    "write_texel",
    "sprite_index",
    "covers",
];

#[test]
fn every_wgsl_function_has_a_formula_or_is_listed_as_indirect() {
    let formulas = formulas();
    for (file, text) in shader::sources() {
        let mut before = "";
        for line in text.lines() {
            // Attributes (@vertex, @fragment, @compute) stand on the line before an entry point.
            let is_entry_point = before.starts_with('@');
            before = line;
            let Some(name) = line.strip_prefix("fn ").and_then(|rest| rest.split('(').next()) else { continue };
            if is_entry_point {
                continue;
            }
            let tested = formulas.iter().any(|formula| formula.name == name && formula.file == *file);
            assert!(tested || INDIRECT.contains(&name), "{file}: {name} has no Formula and is not in INDIRECT");
        }
    }
    for name in INDIRECT {
        let is_there = |text: &str| text.contains(&format!("\nfn {name}("));
        assert!(
            shader::sources().iter().any(|(_, text)| is_there(text)),
            "INDIRECT lists {name}, but no shader file defines it"
        );
    }
}
