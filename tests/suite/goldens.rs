//! Golden images: both renderers must stay within a tolerance of images that were reviewed by eye.
//!
//! `HAZE_BLESS=1 cargo test --package haze --test suite -- goldens` writes them again; look at each before you commit it.

use std::path::{Path, PathBuf};

use glam::{UVec2, Vec4};
use haze_core::assets::image::{Image, read_png};
use haze_core::formula::color::srgb_from_linear;
use haze_core::settings::{DebugView, Technique};
use haze_demo::shot::Shot;
use haze_preset::{CompressionEffort, builtin, write_png};
use image::{DynamicImage, Rgb, RgbImage};

use crate::presets::{render_on_gpu, shot};

pub const SIZE: UVec2 = UVec2::new(160, 90);

/// Largest size of a golden file, bytes.
const MAX_GOLDEN_BYTES: u64 = 64 << 10;

/// Accepted RMS difference, in steps of 8 bits. On the presets, the CPU renderer and llvmpipe, which has 8-bit filter
/// weights, differ by 0.25 to 0.60. A diffuse ramp shifted by 1/32 of its length differs by 1.9.
pub const TOLERANCE: f64 = 0.9;

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/goldens").join(format!("{name}.png"))
}

/// Clamps to 0..1 and encodes as sRGB. There is no tonemap, because it would compress differences.
fn encode(image: &Image<Vec4>) -> RgbImage {
    let mut encoded = RgbImage::new(image.size.x, image.size.y);
    for (texel, pixel) in image.texels.iter().zip(encoded.pixels_mut()) {
        let channel = |linear: f32| (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8;
        *pixel = Rgb([channel(texel.x), channel(texel.y), channel(texel.z)]);
    }
    encoded
}

/// RMS difference over all channels, in steps of 8 bits.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let squares = a.iter().zip(b.iter()).map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

/// RMS difference of an image to the golden image of that name, in steps of 8 bits.
pub fn difference_to_golden(name: &str, image: &Image<Vec4>) -> f64 {
    difference(&encode(image), &read_png(&golden(name)).unwrap().to_rgb8())
}

#[test]
fn techniques_match_their_golden_images() {
    // depth_sprite_hard is left out: its hard edge depends on the texture filter's 8-bit weights, so single pixels
    // differ.
    for technique in [Technique::DepthSpriteSoft, Technique::SphericalBillboard, Technique::VolumetricSoft] {
        let mut shot = shot("crates", SIZE);
        shot.preset.systems[0].settings.technique = technique;
        compare(&format!("crates_{}", technique.name()), &shot);
    }
}

fn compare(name: &str, shot: &Shot) {
    let path = golden(name);
    let on_gpu = encode(&render_on_gpu(shot, false));
    if std::env::var_os("HAZE_BLESS").is_some() {
        write_png(&path, &DynamicImage::ImageRgb8(on_gpu), CompressionEffort::Small).unwrap();
        return;
    }
    let golden =
        read_png(&path).unwrap_or_else(|error| panic!("no golden image; HAZE_BLESS=1 writes it: {error}")).to_rgb8();
    assert!(
        std::fs::metadata(&path).unwrap().len() <= MAX_GOLDEN_BYTES,
        "{name} is larger than {MAX_GOLDEN_BYTES} bytes"
    );
    let on_cpu = encode(&shot.render_on_cpu().unwrap());
    for (renderer, image) in [("GPU", &on_gpu), ("CPU", &on_cpu)] {
        let difference = difference(image, &golden);
        println!("{name} on the {renderer}: {difference:.2}");
        if difference > TOLERANCE {
            let found = path.with_extension("found.png");
            write_png(&found, &DynamicImage::ImageRgb8(image.clone()), CompressionEffort::Small).unwrap();
            panic!("{name} on the {renderer} is {difference:.2} of 255 off; see {}", found.display());
        }
    }
}

#[test]
fn presets_match_their_golden_images() {
    for preset in builtin::PRESETS {
        compare(preset.name, &shot(preset.name, SIZE));
    }
}

#[test]
fn normals_match_their_golden_image() {
    let mut shot = shot("column", SIZE);
    shot.debug_view = DebugView::Normals;
    compare("column_normals", &shot);
}

#[test]
fn ramp_shifted_by_a_32nd_exceeds_the_tolerance() {
    let shot = shot("column", SIZE);
    let mut mutant = shot.clone();
    for material in &mut mutant.materials {
        let ramp = material.diffuse_ramp.clone();
        let width = ramp.size().x;
        let texels = (0..width).map(|x| ramp.texel(UVec2::new((x + width / 32).min(width - 1), 0)));
        material.diffuse_ramp = haze_core::assets::ramp::Ramp::from_linear(ramp.size(), texels);
    }
    let golden = read_png(&golden("column")).unwrap().to_rgb8();
    let difference = difference(&encode(&mutant.render_on_cpu().unwrap()), &golden);
    println!("{difference:.2}");
    assert!(difference > TOLERANCE);
}
