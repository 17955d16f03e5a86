//! Compares every WGSL function of `shaders` with the Rust function of the same name. Each WGSL function is also
//! compared after deliberate mistakes (mutants), which must fail: otherwise the comparison proves nothing. Each shader
//! file has a module of the same name here, or shares one with the files next to it.
//!
//! A test sets what a function reads: [`testable`] turns uniforms, storage buffers and override constants into private
//! variables, which start with the values of [`fixture`], and replaces every texture by a test texture of its kind.

mod ambient;
mod blending;
mod color;
mod compute;
mod curve;
mod depth;
mod diffuse_bake;
mod emitter;
mod fire;
mod fixture;
mod flight;
mod flow;
mod grain;
mod hash;
mod inputs;
mod lighting;
mod lit_smoke;
mod noise_volume;
mod normal;
mod order;
mod ramp;
mod response;
mod shadow;
mod six_way;
mod smoke_extent;
mod smoke_tiles;
mod soft_fade;
mod sprite;
mod sprite_fragment;
mod sprite_vertex;
mod stretch;
mod swirl_noise;
mod technique;
mod testable;
mod tile_sprite;
mod tiles;
mod tonemap;
mod upsample;
mod view;

use haze::shader;

use self::testable::testable;
use crate::gpu::gpu;

/// Largest number of inputs or results of a case.
const WIDTH: usize = 32;

/// Declares two tests for each module of formulas, so that they run side by side.
macro_rules! formula_tests {
    ($($module:ident),* $(,)?) => {
        fn formulas() -> Vec<Formula> {
            [$($module::formulas()),*].into_iter().flatten().collect()
        }

        mod every_wgsl_formula_matches_its_rust_function {
            $(#[test]
            fn $module() {
                super::$module::formulas().iter().for_each(super::assert_match);
            })*
        }

        mod every_mutated_wgsl_formula_fails_the_comparison {
            $(#[test]
            fn $module() {
                super::$module::formulas().iter().for_each(super::assert_mutants_fail);
            })*
        }
    };
}

formula_tests!(
    ambient,
    blending,
    color,
    curve,
    depth,
    diffuse_bake,
    emitter,
    fire,
    flight,
    flow,
    grain,
    hash,
    lighting,
    lit_smoke,
    noise_volume,
    normal,
    order,
    ramp,
    response,
    shadow,
    six_way,
    smoke_extent,
    smoke_tiles,
    soft_fade,
    sprite,
    sprite_fragment,
    sprite_vertex,
    stretch,
    swirl_noise,
    technique,
    tile_sprite,
    tiles,
    tonemap,
    upsample,
    view,
);

/// One function of the shaders, with the code that evaluates it in WGSL and in Rust.
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

/// Runs the formula on the GPU. `mutate` is a (text, replacement) pair that is applied to the composed shader first.
fn run(formula: &Formula, mutate: Option<(&str, &str)>) -> Vec<Vec<f32>> {
    let mut library = format!("#import \"{}\"\n", formula.file);
    if !["lib/sprite.wgsl", "lib/ramp.wgsl", "lib/response.wgsl", "lib/noise_volume.wgsl"].contains(&formula.file) {
        library.push_str("#import \"lib/ramp.wgsl\"\n");
    }
    let mut source = shader::compose(&library).unwrap();
    if let Some((from, to)) = mutate {
        assert!(source.contains(from), "{}: the shader does not contain {from:?}, the text of a mutant", formula.name);
        source = source.replace(from, to);
    }
    let (mut source, start) = testable(&source);
    // Functions with barriers run in a whole workgroup; `local_index` is the number of the invocation.
    let invocations = if formula.wgsl.contains("local_index") { 256 } else { 1 };
    // One case per workgroup, because llvmpipe 22 uses the level of the first invocation for every textureLoad of a
    // SIMD group.
    source.push_str(&format!(
        "@group(0) @binding(0) var<storage, read> inputs: array<f32>;
         @group(0) @binding(1) var<storage, read_write> results: array<f32>;
         @group(0) @binding(2) var test_ramp: texture_2d<f32>;
         @group(0) @binding(3) var test_sprite: texture_2d_array<f32>;
         @group(0) @binding(4) var test_sampler: sampler;
         @group(0) @binding(5) var test_noise: texture_3d<f32>;
         @group(0) @binding(6) var test_alpha_bounds: texture_2d<u32>;
         var<private> case_index: u32;
         fn x(i: u32) -> f32 {{ return inputs[case_index * {WIDTH}u + i]; }}
         fn y(i: u32, value: f32) {{ results[case_index * {WIDTH}u + i] = value; }}
         fn y2(i: u32, v: vec2f) {{ y(i, v.x); y(i + 1u, v.y); }}
         fn y3(i: u32, v: vec3f) {{ y2(i, v.xy); y(i + 2u, v.z); }}
         fn y4(i: u32, v: vec4f) {{ y2(i, v.xy); y2(i + 2u, v.zw); }}
         fn word(i: u32) -> u32 {{ return (u32(x(i)) << 16u) | u32(x(i + 1u)); }}
         fn y_word(i: u32, value: u32) {{ y(i, f32(value >> 16u)); y(i + 1u, f32(value & 0xffffu)); }}
         @compute @workgroup_size({invocations})
         fn main(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local_index: u32) {{
             case_index = workgroup.x;
             {start}
             {}
         }}",
        formula.wgsl
    ));
    let results = compute::compute(&source, &formula.cases, WIDTH);
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

fn assert_match(formula: &Formula) {
    let worst = error(formula, &run(formula, None));
    println!("{}: {worst:e}", formula.name);
    assert!(worst <= formula.tolerance, "{}: WGSL and Rust differ by {worst:e}", formula.name);
}

fn assert_mutants_fail(formula: &Formula) {
    assert!(!formula.mutants.is_empty(), "{} has no mutants", formula.name);
    for &mutant in formula.mutants {
        let worst = error(formula, &run(formula, Some(mutant)));
        assert!(worst > 10.0 * formula.tolerance, "{}: the mutant {mutant:?} passes ({worst:e})", formula.name);
    }
}

/// Functions without a [`Formula`], and why. Tests of whole frames cover them.
const INDIRECT: &[(&str, &str)] = &[
    ("add_up", "adds up the values of a workgroup; the comparison of buffers with slices covers it"),
    ("sized_particle", "reads the particles of the pass"),
    ("amount_of", "reads the particles of the pass"),
    ("write_texel", "writes storage textures, whose formats the test does not bind"),
    ("total_and_before", "counts the keys of other workgroups; tests of the sort cover it"),
    ("visible_parts", "reads depths that the workgroup has gathered"),
    ("init_texel", "fills a struct from tested functions"),
    ("first_texel", "places the texels of an invocation; whole frames of the path tiled cover it"),
    ("traverse_part", "waits for its workgroup; mutants of the parts of a list cover it"),
    ("traverse_parts", "waits for its workgroup; mutants of the parts of a list cover it"),
    ("slots_of", "calls slots_from_attachments"),
    ("with_behind", "adds a struct member by member; mutants of the parts of a list cover it"),
    ("write_pair", "calls write_texel"),
    ("accumulate_sprite", "calls technique_fragment or unfaded_fragment for a struct of init_texel"),
    ("are_opaque", "calls is_opaque for each texel of an invocation"),
    ("unfaded_fragment", "calls sprite_texel; mutants of large targets cover it"),
    ("is_unfaded", "calls hard_fade or fade_before; mutants of large targets cover it"),
    ("detail_at", "calls sample_detail; technique_fragment covers it"),
    ("reads_scene", "decides only whether the scene's depth is read, not a value"),
    ("attachments_from_fragment", "fills a struct from tested functions; whole frames compare every role"),
    ("accumulated_from", "maps a struct to the outputs of the pass"),
    ("add_attachments", "adds structs member by member; tests of the tiled path cover it"),
    ("slots_from_attachments", "maps roles to texture slots by override constants"),
    ("attachments_from_slots", "maps texture slots to roles by override constants"),
    ("cross_offset", "offsets of a cross; whole frames lit per texel cover it"),
    ("quad_cell", "numbers the cells of a workgroup; whole frames of the path tiled cover it"),
    ("quad_position", "places the cells of a workgroup; whole frames of the path tiled cover it"),
    ("is_drawn", "calls tile_has; whole frames lit per texel cover it"),
    ("cells_have", "reads cells of light_target and depth_slopes; whole frames of the path tiled cover it"),
    ("tile_has", "calls cells_have; whole frames of the path tiled cover it"),
    ("lit_pixel", "calls tested functions; whole frames lit per texel cover it"),
    ("filtered_position", "clamps a place; whole frames lit per texel cover it"),
    ("filter_texel_size", "reads the size of the texture; whole frames lit per texel cover it"),
    ("tile_corner", "places a corner of a tile; whole frames of the path tiled cover it"),
    ("lights_that_reach", "reads the lights of the pass; whole frames of the path tiled cover it"),
    ("glow_of_lights", "adds up glow_in_smoke; whole frames of the path tiled cover it"),
    ("glow_of_light", "fills a struct from tested functions; whole frames cover it"),
    ("glow_in_smoke", "calls sample_ramp_2d and range_window; whole frames cover it"),
    ("box_position", "projects a corner of the box; whole frames cover it"),
    ("sample_attachments", "reads the pass's textures by the tested sample_target"),
    ("load_attachments", "reads the pass's textures"),
    ("load_map", "reads a host's shadow map; whole frames with shadow maps cover it"),
    ("lit_texel", "calls tested functions; whole frames lit per texel cover it"),
    ("slope_at", "calls tested functions; whole frames lit per texel cover it"),
    ("kept_depth", "loops over depths; whole frames at each scale cover it"),
    ("octant_visibility", "calls map_visibility; whole frames with shadow maps cover it"),
    ("cell_visibility", "calls map_visibility; whole frames with shadow maps cover it"),
    ("channels_with_light", "reads the lights of the pass; debug views of shadow cover it"),
    ("fractions_of_lights", "calls exp2; debug views of shadow cover it"),
    ("cell_pattern", "draws lines of a debug view; debug views of shadow cover it"),
    ("slice_of_light", "reads the volume of the shadow; debug views of shadow cover it"),
    ("slice_vertex", "covers a render target; whole frames with shadow on OpenGL cover it"),
    ("optical_depth_of_light", "calls optical_depth_towards"),
    ("inside_map", "clamps to a host's shadow map; whole frames with shadow maps cover it"),
    ("map_size", "reads the size of a host's shadow map; whole frames with shadow maps cover it"),
    ("map_visibility", "reads a host's shadow map; whole frames with shadow maps cover it"),
    ("sample_volume", "reads the volume of the shadow; whole frames with shadow cover it"),
    ("mean_along_ray", "reads the volume of the shadow; whole frames with shadow maps cover it"),
    ("mean_position", "calls view_position; whole frames with shadow maps cover it"),
    ("mean_cell", "calls mean_position; whole frames with many lights cover it"),
    ("shade_on_ray", "reads the volume of the shadow; whole frames with shadow maps and many lights cover it"),
    ("first_block", "fills a struct; shadow_on_light covers it"),
    ("shade_of_block", "reads the volume of the shadow; whole frames with many lights cover it"),
    ("scene_visibility", "calls mean_along_ray"),
    ("scene_point", "reads the scene's depth; whole frames with a shaded scene cover it"),
    ("scene_fraction", "reads a host's shadow map; whole frames with a shaded scene cover it"),
    ("shade_of_sprites", "fills a struct; whole frames with shadow cover it"),
    ("openness", "calls mean_along_ray"),
    ("openness_along", "reads the density grid; whole frames with ambient light cover it"),
    ("shadow_on_hemisphere", "looks up the shadow ramp; ambient_from_ramp and ambient_from_six_way cover it"),
    ("hemispheres", "calls shadow_on_hemisphere; ambient_from_ramp and ambient_from_six_way cover it"),
    ("moments_of_sprite", "calls depth_moments with a sprite; whole frames with shadow maps cover it"),
    ("shaded_surface", "adds scene_visibility and openness to a tested surface"),
    ("lit_position", "chooses a depth; whole frames with shadow maps cover it"),
    ("ray_of_pixel", "calls ndc_from_pixel; shading_position covers it"),
    ("ray_through", "divides by the depth; whole frames of the path forward cover it"),
    ("density_radius", "scales a particle's radius; whole frames with shadow cover it"),
    ("sprite_optical_depth", "calls mean_optical_depth with a particle's amount; whole frames with shadow cover it"),
    ("optical_depths_of", "reads the volume of optical depths; whole frames with shadow cover it"),
    ("load_density", "reads the density grid; whole frames with shadow cover it"),
    ("sample_density", "reads the density grid; whole frames with shadow cover it"),
    ("optical_depth_towards", "reads the density grid; whole frames with shadow cover it"),
    ("haze_transmittance", "reads the volume of optical depths; presets cover it, whose scene is shaded by smoke"),
    ("heat_of", "calls painted_fraction with a ramp lookup; whole frames with fire cover it"),
    ("fragment_heat", "calls heat_at with a fragment"),
    ("fire_light", "calls emission with fire_from_moments"),
    ("has_values", "decides only whether a buffer is read; tests of the tiled path cover it"),
    ("tint_of", "calls sample_ramp; whole frames with colors cover it"),
    ("stretch_of", "calls sprite_stretch; project_sprite covers it"),
    ("erosion_of", "calls sprite_erosion with the system's settings"),
    ("grain_of", "calls sample_grain; sprite_texel covers it"),
    ("clean_texel", "sprite_texel covers it"),
    ("blend_and_erosion", "packed_blend covers it"),
    ("load_particle", "reads the particles of the pass"),
    ("unpack_signed", "swirl_noise covers it"),
    ("corner_curl", "swirl_noise covers it"),
    ("turned", "orbiting_flight covers it"),
    ("flow_at_step", "carried_by_flow covers it"),
    ("advance_flow_step", "carried_by_flow covers it"),
    ("values_of", "reads a buffer; tests of the tiled path with shadow cover it"),
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
            assert!(
                tested || INDIRECT.iter().any(|(indirect, _)| *indirect == name),
                "{file}: {name} has no Formula and is not in INDIRECT"
            );
        }
    }
    for (name, _) in INDIRECT {
        let is_there = |text: &str| text.contains(&format!("\nfn {name}("));
        assert!(
            shader::sources().iter().any(|(_, text)| is_there(text)),
            "INDIRECT lists {name}, but no shader file defines it"
        );
    }
}
