use std::path::Path;

use glam::UVec3;
use haze_core::assets::json;
use haze_core::settings::{Fields as _, field_path, for_each_field};

use super::*;
use crate::deterministic_math::tests::hash;

fn puff() -> SpriteRecipe {
    let recipe = include_str!("../../../../../tests/corpus/sprite/good_first");
    json::parse(Path::new("puff.sprite.json"), recipe).unwrap()
}

fn bake(recipe: &SpriteRecipe) -> Result<BakedSprite, FieldError> {
    recipe.bake(|_| Ok(()))
}

#[test]
fn extreme_seeds_bake_without_overflow() {
    // The second seed times 31 is u32::MAX, modulo 2^32.
    for seed in [0, 1_108_378_657, u32::MAX] {
        let frame = SpriteRecipe { seed, size: 8, ..puff() }.bake_frame(0.0);
        assert!(frame.offset.texels.iter().all(|offset| offset.is_finite()));
    }
}

#[test]
fn optional_fields_change_the_image() {
    let plain = SpriteRecipe { size: 32, columns: 2, rows: 1, ..puff() };
    let lines = SpriteRecipe { length: 0.5, ..plain.clone() };
    let bake = |recipe: &SpriteRecipe| bake(recipe).unwrap().image;
    for changed in [
        lines.clone(),
        SpriteRecipe { lumps: 0.5, ..plain.clone() },
        SpriteRecipe { travel: 0.5, ..plain.clone() },
        SpriteRecipe { tolerance: 2, ..plain.clone() },
    ] {
        assert!(bake(&changed) != bake(&plain), "{changed:?}");
    }
    // `upright` turns lines only.
    assert!(bake(&SpriteRecipe { upright: 0.5, ..lines.clone() }) != bake(&lines));
    assert!(bake(&SpriteRecipe { upright: 0.5, ..plain.clone() }) == bake(&plain));
}

#[test]
fn smoke_ends_where_its_balls_end() {
    // Strong erosion, whose negative noise adds density.
    let recipe = SpriteRecipe { size: 64, balls: 1, spread: 0.0, erosion: 4.0, drift: 0.0, warp: 0.0, ..puff() };
    let recipe = SpriteRecipe { ball_radius_min: 0.4, ball_radius_max: 0.4, ..recipe };
    let volume = recipe.volume(0.0);
    let sides = volume.size;
    let mut reached = 0.0_f32;
    for (index, &density) in (0..).zip(&volume.densities) {
        let voxel = UVec3::new(index % sides.x, index / sides.x % sides.y, index / (sides.x * sides.y));
        let from = volume.voxel_center(voxel).length();
        // Density rises from 0 at the radius, without a step. At 0.9 of it the field is (1 - 0.81)^3 = 0.007, the body
        // 0.014, and the density at most twice that.
        assert!(density <= 0.0 || from < 0.4, "{density} at {from}");
        assert!(density <= 0.028 || from < 0.36, "{density} at {from}");
        reached = reached.max(if density > 0.0 { from } else { 0.0 });
    }
    assert!(reached > 0.3, "{reached}");
}

#[test]
fn every_machine_bakes_the_same_bytes() {
    let small = SpriteRecipe { size: 32, columns: 2, rows: 1, ..puff() };
    let rough = SpriteRecipe { noise_octaves: 5, noise_gain: 0.55, ..small.clone() };
    let drawn_out = SpriteRecipe { length: 0.4, upright: 0.5, lumps: 0.7, ..rough.clone() };
    let carried = SpriteRecipe { travel: 0.2, tolerance: 2, ..drawn_out.clone() };
    let found = [small, rough, drawn_out, carried].map(|recipe| {
        let BakedSprite { image, detail } = bake(&recipe).unwrap();
        hash(image.into_raw().into_iter().chain(detail.into_raw()))
    });
    let expected = [0x6be5_4e10_bf01_e3ae, 0xd573_6a6b_03a6_3766, 0x3093_f633_f0aa_91d5, 0xa174_e057_fb2b_ba2b];
    assert_eq!(found, expected, "{found:#x?}");
}

#[test]
fn progress_is_reported_and_its_error_cancels_the_bake() {
    let told = std::cell::RefCell::new(Vec::new());
    let recipe = SpriteRecipe { size: 8, columns: 3, rows: 1, ..puff() };
    let bake = |last| {
        let error = || FieldError::new("", "", "");
        recipe.bake(|frame| {
            told.borrow_mut().push(frame);
            if frame < last { Ok(()) } else { Err(error()) }
        })
    };
    assert!(bake(9).is_ok());
    assert_eq!(told.take(), [0, 1, 2]);
    assert!(bake(1).is_err());
    assert_eq!(told.take(), [0, 1]);
}

#[test]
fn a_written_recipe_is_read_back_equal() {
    let path = Path::new("a.sprite.json");
    for recipe in [puff(), SpriteRecipe { travel: 0.25, ..puff() }] {
        let text = recipe.to_json();
        assert_eq!(json::parse::<SpriteRecipe>(path, &text).unwrap(), recipe);
        // Unused optional fields are not written.
        assert_eq!(text.contains("\"travel\": 0.25"), recipe.travel > 0.0);
        assert!(text.ends_with("}\n") && !text.contains("\"length\""), "{text}");
    }
}

#[test]
fn every_field_but_the_version_is_listed_once_under_the_headings() {
    let mut fields = Vec::new();
    for_each_field(&mut puff(), &mut |path, _| fields.push(field_path(path)));
    fields.retain(|field| field != "version");
    let mut placed: Vec<_> = puff().headings().iter().map(|(field, _)| (*field).to_owned()).collect();
    fields.sort();
    placed.sort();
    assert_eq!(placed, fields);
}
