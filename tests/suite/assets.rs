//! Checks that committed images match their committed recipes, and that generated pages match the program.

use std::path::{Path, PathBuf};

use glam::UVec2;
use haze_author::noise_recipe::NoiseRecipe;
use haze_author::ramp::RampRecipe;
use haze_author::ramp::motif::MotifRecipe;
use haze_author::ramp::template::TEMPLATES;
use haze_author::sprite::bake::SpriteRecipe;
use haze_author::sprite::detail::{bake_detail_frame, optical_flow};
use haze_core::assets::image::read_png;
use haze_core::settings::CoverageMode;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::tonemap;
use haze_preset::{builtin, write_baked_png};
use image::{Rgba, RgbaImage, imageops};

fn file(folder: &str, name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join(name)
}

#[test]
fn committed_ramps_and_motifs_match_their_recipes() {
    for ramp in builtin::RAMPS {
        let committed = read_png(&file("ramps", &format!("{}.png", ramp.name))).unwrap().to_rgb16();
        let recipe = RampRecipe::load(&file("ramps", &format!("{}.ramp.json", ramp.name))).unwrap();
        // The bake is plain arithmetic and bit-exact on every platform.
        assert!(
            committed == recipe.bake().unwrap().to_rgb16(),
            "{}.png differs from its recipe; bake it again",
            ramp.name
        );
    }
    for motif in builtin::MOTIFS {
        let committed = read_png(&file("ramps", &format!("{}.png", motif.name))).unwrap().to_rgb16();
        let recipe = MotifRecipe::load(&file("ramps", &format!("{}.motif.json", motif.name))).unwrap();
        assert!(
            committed == recipe.bake().unwrap().to_rgb16(),
            "{}.png differs from its recipe; bake it again",
            motif.name
        );
    }
}

#[test]
fn builtin_ramps_named_after_a_template_equal_it() {
    let mut found = 0;
    for template in TEMPLATES {
        // Template names are unique, and a diffuse template is already called "neutral".
        let name = if template.name == "neutral_glow" { "neutral" } else { template.name };
        let name = format!("{}_{name}", template.role.name());
        if builtin::find(builtin::RAMPS, &name).is_some() {
            let recipe = RampRecipe::load(&file("ramps", &format!("{name}.ramp.json"))).unwrap();
            assert_eq!(recipe, template.recipe(), "{name}.ramp.json differs from the template");
            found += 1;
        }
    }
    assert_eq!(found, 12);
}

#[test]
fn soft_coverage_ramp_equals_linear_coverage() {
    let ramp = RampRecipe::load(&file("ramps", "coverage_soft.ramp.json")).unwrap();
    let pixels = ramp.bake().unwrap().to_rgb16();
    assert!(pixels.enumerate_pixels().all(|(x, _, pixel)| pixel.0 == [257 * x as u16; 3]));
    let image = |coverage| {
        let mut shot = Shot::load("column", UVec2::new(160, 90)).unwrap();
        shot.preset.systems[0].settings.coverage = coverage;
        shot.preset.systems[0].material.coverage_ramp = "coverage_soft".into();
        let shot = Shot::new(shot.preset, Path::new("column"), shot.size).unwrap();
        tonemap(&shot.render_on_cpu().unwrap(), &shot)
    };
    let linear = image(CoverageMode::Linear);
    let ramp = image(CoverageMode::Ramp);
    // Ramp texels are half floats, so an 8-bit value may round to the neighbouring step.
    assert!(linear.iter().zip(ramp.iter()).all(|(a, b)| a.abs_diff(*b) <= 1));
}

#[test]
fn committed_sprites_match_their_recipes() {
    for sprite in builtin::SPRITES {
        let committed = read_png(&file("sprites", &format!("{}.png", sprite.name))).unwrap().to_rgba8();
        let recipe = SpriteRecipe::load(&file("sprites", &format!("{}.sprite.json", sprite.name))).unwrap();
        // Checks one frame, other than the first.
        let frame = 3;
        let frame_of = |sheet: &RgbaImage, size: u32| {
            let origin = (frame % recipe.columns * size, frame / recipe.columns * size);
            imageops::crop_imm(sheet, origin.0, origin.1, size, size).to_image()
        };
        let baked = recipe.bake_frame(frame as f32);
        // The bake is bit-exact on every platform.
        let texels: Vec<_> = frame_of(&committed, recipe.size).pixels().copied().collect();
        assert!(texels == baked.image.texels, "{}.png differs from its recipe; bake it again", sprite.name);

        // Motion is estimated from the committed frames, so that both sides have the same input.
        let decoded = sprite.sprite().unwrap();
        let detail = bake_detail_frame(&decoded, frame, &baked.offset, &optical_flow(&decoded, frame, None));
        let committed = read_png(&file("sprites", &format!("{}.detail.png", sprite.name))).unwrap().to_rgba8();
        let committed = frame_of(&committed, detail.size.x);
        // The baker moves channels of the detail map by up to this much to shrink the file.
        let most = recipe.tolerance / 2;
        let is_near =
            |(a, b): (&Rgba<u8>, &Rgba<u8>)| a.0.iter().zip(b.0).all(|(a, b)| u32::from(a.abs_diff(b)) <= most);
        assert!(
            committed.pixels().zip(&detail.texels).all(is_near),
            "{}.detail.png differs from its recipe; bake it again",
            sprite.name
        );
    }
}

#[test]
fn committed_images_are_encoded_as_scripts_bake_encodes_them() {
    let scratch = tempfile::tempdir().unwrap();
    let written = scratch.path().join("written.png");
    for folder in ["ramps", "sprites"] {
        for entry in std::fs::read_dir(file(folder, "")).unwrap() {
            let committed = entry.unwrap().path();
            if committed.extension().is_some_and(|ending| ending == "png") {
                write_baked_png(&written, &read_png(&committed).unwrap()).unwrap();
                let is_same = std::fs::read(&written).unwrap() == std::fs::read(&committed).unwrap();
                assert!(is_same, "{} has other bytes; run scripts/bake", committed.display());
            }
        }
    }
}

#[test]
fn builtin_sprites_take_less_than_a_megabyte() {
    let files = std::fs::read_dir(file("sprites", "")).unwrap().map(|entry| entry.unwrap());
    let images = files.filter(|file| file.path().extension().is_some_and(|ending| ending == "png"));
    let bytes: u64 = images.map(|image| image.metadata().unwrap().len()).sum();
    assert!((500_000..1_000_000).contains(&bytes), "all sprites take {bytes} bytes");
}

#[test]
fn committed_noise_volumes_match_their_recipes() {
    for noise in builtin::NOISES {
        let committed = read_png(&file("sprites", &format!("{}.png", noise.name))).unwrap().to_rgba8();
        let recipe = NoiseRecipe::load(&file("sprites", &format!("{}.noise.json", noise.name))).unwrap();
        // Hashes and plain arithmetic are bit-exact on every platform.
        assert_eq!(committed, recipe.bake().unwrap(), "{}.png differs from its recipe; bake it again", noise.name);
    }
}

#[test]
fn committed_settings_page_matches_the_program() {
    let committed = std::fs::read_to_string(file("docs", "settings.md")).unwrap();
    assert!(committed == haze_author::preset::settings_page(), "run `haze preset settings > docs/settings.md`");
}

#[test]
fn committed_preset_schema_matches_the_program() {
    let committed = std::fs::read_to_string(file("presets", "preset.schema.json")).unwrap();
    assert!(
        committed.trim_end() == haze_author::preset::schema(),
        "run `haze preset schema > presets/preset.schema.json`"
    );
}
