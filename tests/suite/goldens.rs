//! Pictures of every preset as they were when someone last looked at them and was content.
//!
//! `HAZE_BLESS=1 cargo test goldens` writes them anew; look at each before committing it.

use std::path::{Path, PathBuf};

use glam::{UVec2, Vec4};
use haze::builtin;
use haze::formula::colour::srgb_from_linear;
use haze::picture::Picture;
use haze::picture::{Effort, read_png, write_png};
use haze::settings::{ShadeTree, Technique};
use haze_demo::shot::Shot;
use image::{DynamicImage, Rgb, RgbImage};

use crate::presets::{drawn, shot};

const SIZE: UVec2 = UVec2::new(160, 90);

/// Largest golden, bytes.
const LARGEST: u64 = 64 << 10;

/// Root of the mean square difference, in steps of 8 bits. The CPU renderer and llvmpipe with its 8-bit filter weights
/// are 0.25 to 0.60 apart on the presets; a diffuse ramp shifted by a 32nd of its length is 1.9.
const TOLERANCE: f64 = 0.9;

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens").join(format!("{name}.png"))
}

/// The bare picture, clamped to 1 and encoded: no film curve to hide behind.
fn encode(picture: &Picture<Vec4>) -> RgbImage {
    let mut encoded = RgbImage::new(picture.size.x, picture.size.y);
    for (texel, pixel) in picture.texels.iter().zip(encoded.pixels_mut()) {
        let channel = |linear: f32| (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8;
        *pixel = Rgb([channel(texel.x), channel(texel.y), channel(texel.z)]);
    }
    encoded
}

fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let squares = a.iter().zip(b.iter()).map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn techniques_look_as_they_did() {
    // Not depth_sprite_hard: its cut follows the filter's 8-bit weights, a pixel here or there.
    for technique in [Technique::DepthSpriteSoft, Technique::SphericalBillboard, Technique::VolumetricSoft] {
        let mut shot = shot("crates", SIZE);
        shot.preset.systems[0].settings.technique = technique;
        compare(&format!("crates_{}", technique.name()), &shot);
    }
}

fn compare(name: &str, shot: &Shot) {
    let path = golden(name);
    let on_gpu = encode(&drawn(shot, false));
    if std::env::var_os("HAZE_BLESS").is_some() {
        write_png(&path, &DynamicImage::ImageRgb8(on_gpu), Effort::Small).unwrap();
        return;
    }
    let golden = read_png(&path).unwrap_or_else(|error| panic!("no golden: {error}")).to_rgb8();
    assert!(std::fs::metadata(&path).unwrap().len() <= LARGEST, "{name} is larger than {LARGEST} bytes");
    let on_cpu = encode(&shot.render_on_cpu().unwrap());
    for (renderer, picture) in [("GPU", &on_gpu), ("CPU", &on_cpu)] {
        let difference = difference(picture, &golden);
        println!("{name} on the {renderer}: {difference:.2}");
        if difference > TOLERANCE {
            let found = path.with_extension("found.png");
            write_png(&found, &DynamicImage::ImageRgb8(picture.clone()), Effort::Small).unwrap();
            panic!("{name} on the {renderer} is {difference:.2} off; see {}", found.display());
        }
    }
}

#[test]
fn presets_look_as_they_did() {
    for preset in builtin::PRESETS {
        compare(preset.name, &shot(preset.name, SIZE));
    }
}

#[test]
fn normals_look_as_they_did() {
    let mut shot = shot("column", SIZE);
    shot.shade_tree = ShadeTree::Normals;
    compare("column_normals", &shot);
}

#[test]
fn a_ramp_shifted_by_a_32nd_is_seen() {
    let shot = shot("column", SIZE);
    let mut mutant = shot.clone();
    for material in &mut mutant.materials {
        let ramp = material.diffuse_ramp.clone();
        let width = ramp.size().x;
        let texels = (0..width).map(|x| ramp.texel(UVec2::new((x + width / 32).min(width - 1), 0)));
        material.diffuse_ramp = haze::ramp::Ramp::from_linear(ramp.size(), texels);
    }
    let golden = read_png(&golden("column")).unwrap().to_rgb8();
    let difference = difference(&encode(&mutant.render_on_cpu().unwrap()), &golden);
    println!("{difference:.2}");
    assert!(difference > TOLERANCE);
}
