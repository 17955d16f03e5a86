use std::path::Path;

use super::*;
use crate::deterministic_math::tests::hash;
use haze::assets::json;
use haze::settings::{Fields as _, field_path, for_each_field};

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
        for version in [1, 2] {
            let frame = SpriteRecipe { seed, version, size: 8, ..puff() }.bake_frame(0.0);
            assert!(frame.offset.texels.iter().all(|offset| offset.is_finite()));
        }
    }
}

#[test]
fn version_2_fields_need_version_2_and_change_the_image() {
    for change in [
        (|recipe| recipe.length = 0.5) as fn(&mut SpriteRecipe),
        |recipe| recipe.upright = 0.5,
        |recipe| recipe.lumps = 0.5,
        |recipe| recipe.travel = 0.5,
    ] {
        let mut recipe = SpriteRecipe { size: 32, columns: 2, rows: 1, ..puff() };
        change(&mut recipe);
        assert!(bake(&recipe).is_err());
        // Each field changes the image; `upright` only together with `length`.
        let plain = SpriteRecipe { version: 2, length: recipe.length.max(recipe.upright), ..puff() };
        let plain = SpriteRecipe { size: 32, columns: 2, rows: 1, ..plain };
        recipe = SpriteRecipe { version: 2, length: plain.length, ..recipe };
        let plain =
            if recipe.length > 0.0 && recipe.upright <= 0.0 { SpriteRecipe { length: 0.0, ..plain } } else { plain };
        assert!(bake(&recipe).unwrap().picture != bake(&plain).unwrap().picture);
    }
}

#[test]
fn every_machine_bakes_the_same_bytes() {
    let small = SpriteRecipe { size: 32, columns: 2, rows: 1, ..puff() };
    let second = SpriteRecipe { version: 2, noise_octaves: 5, noise_gain: 0.55, ..small.clone() };
    let drawn_out = SpriteRecipe { length: 0.4, upright: 0.5, lumps: 0.7, ..second.clone() };
    let carried = SpriteRecipe { travel: 0.2, tolerance: 2, ..drawn_out.clone() };
    let found = [small, second, drawn_out, carried].map(|recipe| {
        let BakedSprite { picture, detail } = bake(&recipe).unwrap();
        hash(picture.into_raw().into_iter().chain(detail.into_raw()))
    });
    let expected = [0xf4ae_8d1a_5b84_6e84, 0x8ca5_5646_d54b_4579, 0xf7e5_60c9_fec5_d918, 0xae73_111c_c438_914b];
    assert_eq!(found, expected, "{found:#x?}");
}

#[test]
fn both_versions_bake_similar_images() {
    let recipe = SpriteRecipe { size: 64, ..puff() };
    let [first, second] =
        [1, 2].map(|version| SpriteRecipe { version, ..recipe.clone() }.bake_frame(1.5).picture.texels);
    let texels = first.iter().zip(&second).filter(|(first, second)| first.0[3].max(second.0[3]) > 40);
    let off: Vec<[f32; 4]> = texels.map(|(a, b)| std::array::from_fn(|c| f32::from(a.0[c].abs_diff(b.0[c])))).collect();
    let mean: [f32; 4] = std::array::from_fn(|c| off.iter().map(|off| off[c]).sum::<f32>() / off.len() as f32);
    // They differ because a voxel of version 2 is four times as deep. Another seed differs by about 40.
    assert!(off.len() > 1000 && mean.iter().all(|&mean| mean < 12.0), "{mean:?}");
}

#[test]
fn progress_is_reported_and_its_error_cancels_the_bake() {
    let told = std::cell::RefCell::new(Vec::new());
    let recipe = SpriteRecipe { version: 2, size: 8, columns: 3, rows: 1, ..puff() };
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
    for recipe in [puff(), SpriteRecipe { version: 2, travel: 0.25, ..puff() }] {
        let text = recipe.to_text();
        assert_eq!(json::parse::<SpriteRecipe>(path, &text).unwrap(), recipe);
        // Unused version 2 fields are not written, so older programs can read the file.
        assert_eq!(text.contains("\"travel\": 0.25"), recipe.version == 2);
        assert!(text.ends_with("}\n") && !text.contains("\"length\""), "{text}");
    }
}

#[test]
fn every_field_is_listed_once_under_the_headings() {
    let mut fields = Vec::new();
    for_each_field(&mut puff(), &mut |path, _| fields.push(field_path(path)));
    let mut placed: Vec<_> = puff().headings().iter().map(|(field, _)| (*field).to_owned()).collect();
    fields.sort();
    placed.sort();
    assert_eq!(placed, fields);
}
