//! Mutation tests of the frame oracles: a mistake in a shader must fail the golden images and the agreement of the two
//! renderers. The mutated shaders are loaded at run time, through [`Sources`].

use std::cell::LazyCell;

use glam::Vec4;
use haze::PathModelSource;
use haze::shader::{self, Sources};
use haze_core::assets::image::Image;
use haze_core::settings::{LightingResolution, RenderPath, SpriteAnimation};
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_preset::builtin;

use crate::goldens;
use crate::gpu::{gpu, is_tiled_available, own_context};
use crate::presets::{offscreen_context, shot, without_smoke};
use crate::psnr::{MIN_PSNR, psnr, psnr_over};

/// Name, shader file, text in it, and its replacement.
type Mutant = (&'static str, &'static str, &'static str, &'static str);

const MUTANTS: &[Mutant] = &[
    (
        // Gives the image of a blend state with the factor SrcAlpha for color.
        "wrong blend factor",
        "accumulate.wgsl",
        "return accumulated_from(accumulated, ",
        "return accumulated_from(vec4f(accumulated.rgb * accumulated.a, accumulated.a), ",
    ),
    // Reversed winding gives the image of the other cull mode.
    ("wrong face culled", "lib/bounding_box.wgsl", "corners[index]", "corners[35u - index]"),
    (
        "missing premultiply",
        "lib/normal.wgsl",
        "return vec4f(normal * (amount * weight), amount);",
        "return vec4f(normal, amount);",
    ),
    ("flipped normal y", "lib/normal.wgsl", "normal.x * rotation.y + normal.y", "-normal.x * rotation.y - normal.y"),
    ("swapped ramp axes", "lib/glow.wgsl", "vec2f(distance_squared, amount)", "vec2f(amount, distance_squared)"),
];

/// Mistakes in frames that transfer_lit draws by tiles.
const TILE_MUTANTS: &[Mutant] = &[
    ("no border of tiles", "lib/smoke_tiles.wgsl", "select(UPSAMPLE_REACH, 0, system.scale == 1u)", "0"),
    (
        "cells of other tiles",
        "lib/smoke_tiles.wgsl",
        "vec2i(0), end) / i32(CELL_SIDE);\n    let high",
        "vec2i(0), end);\n    let high",
    ),
    ("no cell with a slope", "depth_slopes.wgsl", "if any(slope != vec4f(0.0))", "if any(slope > vec4f(9.0e9))"),
];

/// Mistakes in the cells of frames whose texels are drawn.
const CELL_MUTANTS: &[Mutant] = &[
    ("cells of other texels", "mark_cells.wgsl", "vec2u(position.xy) * CELL_SIDE", "vec2u(position.yx) * CELL_SIDE"),
    ("no smoke marked", "mark_cells.wgsl", "amount > 0.0", "amount > 9.0"),
    ("no slope marked", "mark_cells.wgsl", "any(slope > vec4f(0.0))", "any(slope > vec4f(9.0e9))"),
    ("sloped tiles as flat ones", "transfer_lit.wgsl", "(TILES == TILES_SLOPED)", "true"),
];

/// Mistakes in the glow that transfer_lit adds.
const GLOW_MUTANTS: &[Mutant] = &[
    ("glow of the first light only", "lib/lit_pixel.wgsl", "i < glowing.y", "i < min(glowing.y, 1u)"),
    ("glow of near lights left out", "lib/lit_pixel.wgsl", "if reaches &&", "if !reaches &&"),
    ("rows of glows swapped", "light_target.wgsl", "vec2u(light, 1u)", "vec2u(light, 0u)"),
];

/// Mistakes in frames whose pixels are computed.
const PIXEL_MUTANTS: &[Mutant] = &[
    ("centers of pixels", "upsample_lit.wgsl", "+ 0.5, has_slopes", ", has_slopes"),
    ("texels of other workgroups", "upsample_lit.wgsl", "workgroup.xy * SIDE", "workgroup.yx * SIDE"),
    (
        "pixels of other places",
        "transfer_lit.wgsl",
        "vec2i(pixel - system.target_origin * f32(system.scale))",
        "vec2i(0.5 * pixel)",
    ),
];

/// Mistakes in the traversal of a list in parts. It is cooperative, which exact filtering selects on every adapter.
const SPLIT_MUTANTS: &[Mutant] = &[
    ("opaque parts in front", "tile_accumulate.wgsl", "next.transmittance *= slots[0].a", "next.transmittance *= 1.0"),
    ("parts behind unhidden", "tile_accumulate.wgsl", "seen_slots[slot] *= seen", "seen_slots[slot] *= 1.0"),
    ("parts that overlap", "tile_accumulate.wgsl", "min(start + length, entries)", "entries"),
];

/// Mistakes in the traversal of large targets.
const QUAD_MUTANTS: &[Mutant] = &[
    ("the left column twice", "tile_accumulate.wgsl", "Texels(texels.c, texels.d,", "Texels(texels.a, texels.b,"),
    ("fade where sprites cover a tile", "lib/sprite_fragment.wgsl", "fade_before(scene, view_depth) >= 1.0", "true"),
];

/// Mistakes in the sort of few sprites by GPUs.
const RANK_MUTANTS: &[Mutant] = &[
    ("sorted back to front", "sort.wgsl", "keys[other] < key", "keys[other] > key"),
    ("keys of the first workgroup", "sort.wgsl", "block.x * RANKED_KEYS + ranked", "ranked"),
];

/// Mistakes in the marches of GPUs through the density grid.
const MARCH_MUTANTS: &[Mutant] = &[
    ("no sky", "shadow_march.wgsl", "block < march.light_blocks", "block <= march.light_blocks"),
    ("some rays to the sky", "shadow_march.wgsl", "openness_along(cell, ray,", "openness_along(cell, 2u,"),
    (
        "one light",
        "shadow_march.wgsl",
        "optical_depth_of_light(cell, block, ray)",
        "optical_depth_of_light(cell, block, 0u)",
    ),
];

/// A context with one shader replaced.
fn context((name, file, from, to): &Mutant) -> OffscreenContext {
    let text = shader::source(file).unwrap();
    assert!(text.contains(from), "{name}: {file} has no {from:?}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(file);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text.replacen(from, to, 1)).unwrap();
    offscreen_context().with_shaders(&Sources::from_folder(folder.path()).unwrap()).unwrap()
}

/// A context that a test may change.
fn clean_context() -> OffscreenContext {
    offscreen_context().with_context(own_context())
}

fn drawn(context: &OffscreenContext, shot: &Shot, exact_filtering: bool) -> Image<Vec4> {
    drawn_by(OffscreenRenderer::new(context, exact_filtering).unwrap(), shot)
}

/// As `drawn`, on a device that computes pixels.
fn drawn_from_computed_pixels(context: &OffscreenContext, shot: &Shot, exact_filtering: bool) -> Image<Vec4> {
    let renderer = OffscreenRenderer::new(context, exact_filtering).unwrap();
    let mut model = renderer.renderer().context().path_model();
    model.raster.fragment = 100.0 * model.tiled.fragment;
    model.source = PathModelSource::Host;
    renderer.renderer().context().set_path_model(model).unwrap();
    drawn_by(renderer, shot)
}

/// As `drawn`, with the traversal and the sort of GPUs.
fn drawn_cooperatively(context: &OffscreenContext, shot: &Shot, exact_filtering: bool) -> Image<Vec4> {
    let renderer = OffscreenRenderer::new(context, exact_filtering).unwrap();
    renderer.renderer().context().set_cooperative_traversal(true);
    drawn_by(renderer, shot)
}

fn drawn_by(mut renderer: OffscreenRenderer, shot: &Shot) -> Image<Vec4> {
    renderer.draw(gpu(), shot).unwrap();
    renderer.read(gpu(), shot).unwrap()
}

#[test]
fn mistakes_in_shaders_fail_golden_images_and_agreement() {
    let shots: Vec<_> = builtin::PRESETS.iter().map(|preset| shot(preset.name, goldens::SIZE)).collect();
    // Rendered when needed: most mutants fail at the first presets.
    let on_cpu: Vec<_> = shots.iter().map(|shot| LazyCell::new(|| shot.render_on_cpu().unwrap())).collect();
    let empty: Vec<_> =
        shots.iter().map(|shot| LazyCell::new(|| without_smoke(shot).render_on_cpu().unwrap())).collect();
    for mutant in MUTANTS {
        let context = context(mutant);
        let mut worst_golden = 0.0_f64;
        let mut worst_psnr = f32::INFINITY;
        for (index, shot) in shots.iter().enumerate() {
            let golden = goldens::difference_to_golden(builtin::PRESETS[index].name, &drawn(&context, shot, false));
            worst_golden = worst_golden.max(golden);
            let on_gpu = drawn(&context, shot, true);
            let behind: &Image<Vec4> = &empty[index];
            worst_psnr = worst_psnr.min(psnr_over([&on_gpu, &on_cpu[index]], [behind, behind]));
            if worst_golden > goldens::TOLERANCE && worst_psnr < MIN_PSNR {
                break;
            }
        }
        gpu().check().unwrap();
        println!("{}: {worst_golden:.2} steps from the golden image, {worst_psnr:.1} dB from the CPU", mutant.0);
        assert!(worst_golden > goldens::TOLERANCE, "{} passes the golden images: {worst_golden:.2}", mutant.0);
        assert!(worst_psnr < MIN_PSNR, "{} passes the agreement of the renderers: {worst_psnr:.1} dB", mutant.0);
    }
}

#[test]
fn mistakes_in_drawn_cells_change_the_frame() {
    let mut shot = tiled_shot("campfire", 4);
    shot.preset.systems.iter_mut().for_each(|system| system.settings.path = RenderPath::Raster);
    expect_changes_in(&shot, false, CELL_MUTANTS, drawn);
}

#[test]
fn mistakes_in_smoke_tiles_and_glow_change_the_frame() {
    expect_changes("campfire", false, TILE_MUTANTS, drawn);
    expect_changes("backlit_fog", false, GLOW_MUTANTS, drawn);
}

#[test]
fn mistakes_in_parts_of_lists_change_the_frame() {
    if is_tiled_available() {
        // In eight parts, and, with more tiles, in four.
        expect_changes("backlit_fog", true, SPLIT_MUTANTS, drawn);
        expect_changes_in(&tiled_shot("oil_fire", 1), true, SPLIT_MUTANTS, drawn);
    }
}

/// A shot whose target has enough tiles for four texels an invocation.
fn large_shot() -> Shot {
    let mut shot = shot("inside", glam::UVec2::new(1760, 800));
    let system = &mut shot.preset.systems[0];
    system.settings.path = RenderPath::Tiled;
    system.settings.accumulate.fix_scale(1);
    // A few large sprites suffice, with one lookup a texel, and soft edges where they meet the yard.
    system.emitter.rate = 1.0;
    system.settings.sprite.animation = SpriteAnimation::Still;
    shot
}

#[test]
fn large_targets_are_drawn_as_the_rasterizer_draws_them_and_mistakes_change_them() {
    if !is_tiled_available() {
        return;
    }
    let shot = large_shot();
    let tiled = expect_changes_in(&shot, false, QUAD_MUTANTS, drawn_cooperatively);
    let mut raster = shot.clone();
    raster.preset.systems[0].settings.path = RenderPath::Raster;
    let raster = drawn_cooperatively(&clean_context(), &raster, false);
    let behind = drawn(&clean_context(), &without_smoke(&shot), false);
    let psnr = psnr_over([&tiled, &raster], [&behind, &behind]);
    println!("{psnr:.1} dB");
    assert!(psnr >= MIN_PSNR, "{psnr:.1} dB");
}

#[test]
fn mistakes_in_passes_of_gpus_change_the_frame() {
    expect_changes("campfire", false, PIXEL_MUTANTS, drawn_from_computed_pixels);
    expect_changes("campfire", false, RANK_MUTANTS, drawn_cooperatively);
    expect_changes("column", false, MARCH_MUTANTS, drawn_cooperatively);
}

/// PSNR to the clean frame below which a frame has changed. Two clean frames are equal.
const CHANGED: f32 = 80.0;

/// Draws a shot, with exact filtering or not.
type Draw = fn(&OffscreenContext, &Shot, bool) -> Image<Vec4>;

/// A preset by tiles, lit per texel.
fn tiled_shot(preset: &str, scale: u32) -> Shot {
    let mut shot = shot(preset, glam::UVec2::new(320, 180));
    for system in &mut shot.preset.systems {
        system.settings.path = RenderPath::Tiled;
        system.settings.accumulate.lighting_resolution = LightingResolution::Target;
        system.settings.accumulate.fix_scale(scale);
    }
    shot
}

/// Draws a preset with each mutant by tiles, which must change the frame.
fn expect_changes(preset: &str, exact_filtering: bool, mutants: &[Mutant], drawn: Draw) {
    if is_tiled_available() {
        expect_changes_in(&tiled_shot(preset, 4), exact_filtering, mutants, drawn);
    }
}

/// Returns the clean frame.
fn expect_changes_in(shot: &Shot, exact_filtering: bool, mutants: &[Mutant], drawn: Draw) -> Image<Vec4> {
    let clean = drawn(&clean_context(), shot, exact_filtering);
    for mutant in mutants {
        let psnr = psnr(&drawn(&context(mutant), shot, exact_filtering), &clean);
        println!("{}: {psnr:.1} dB", mutant.0);
        assert!(psnr < CHANGED, "{} leaves the frame as it is: {psnr:.1} dB", mutant.0);
    }
    gpu().check().unwrap();
    clean
}

/// Least agreement of computed pixels with drawn ones, dB: they are rounded to half floats before they are blended.
const MIN_PSNR_OF_COMPUTED: f32 = 70.0;

#[test]
fn computed_pixels_agree_with_drawn_ones() {
    if !is_tiled_available() {
        return;
    }
    let contexts = [clean_context(), clean_context()];
    for (preset, scale) in [("campfire", 2), ("backlit_fog", 2), ("backlit_fog", 3), ("corridor", 4), ("column", 8)] {
        let shot = tiled_shot(preset, scale);
        for exact_filtering in [true, false] {
            let computed = drawn_from_computed_pixels(&contexts[0], &shot, exact_filtering);
            let psnr = psnr(&computed, &drawn(&contexts[1], &shot, exact_filtering));
            println!("{preset}, scale {scale}, exact filtering {exact_filtering}: {psnr:.1} dB");
            assert!(psnr > MIN_PSNR_OF_COMPUTED, "{preset}, scale {scale}: {psnr:.1} dB");
        }
    }
    gpu().check().unwrap();
}
