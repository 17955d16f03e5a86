//! Compares details of drawn smoke with those of a path-traced volume of the same outline; `scripts/truth --grain` runs it.
//!
//! `grain_truth SIZE SAMPLES` path-traces one puff whose noise reaches down to the pixels, draws it from a sprite with
//! [`TEXELS`] texels across, as a screen of 1920x1080 pixels shows sprites, and prints the contrast of details by their
//! wavelength, inside the smoke: the root mean square of the luminance between two blurs, relative to the local mean.
//!
//! The puff is path-traced twice. Its contrast is the mean of products of the two, so the noise cancels out.

use std::convert::Infallible;
use std::error::Error;

use glam::{IVec2, UVec2, Vec3, vec3};
use haze::builtin;
use haze_author::path_trace::{MEDIA, PathTrace};
use haze_author::sprite::bake::SpriteRecipe;
use haze_core::assets::image::Image;
use haze_core::formula::color::luminance;
use haze_demo::puff_cloud::PuffKind;

/// Texels of the sprite across the puff. With a `SIZE` of 256, each is 4 pixels wide.
const TEXELS: u32 = 48;
/// Octaves of the path-traced puff.
const OCTAVES: u32 = 8;
/// Bands of wavelengths, pixels.
const BANDS: [(f32, f32); 3] = [(4.0, 8.0), (8.0, 16.0), (16.0, 32.0)];
/// Wavelength, in standard deviations, at which a Gaussian blur halves a wave: 2π / √(2 ln 2).
const HALVED: f32 = 5.336;

/// Erosion, bump and octaves of the grain, by name.
const GRAINS: [(&str, f32, f32, u32); 4] =
    [("no grain", 0.0, 0.0, 1), ("grain", 0.5, 1.0, 1), ("two octaves", 0.5, 1.0, 2), ("strong", 0.9, 2.0, 2)];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [size, samples] = &arguments[..] else { return Err("usage: grain_truth SIZE SAMPLES".into()) };
    let size = size.parse()?;
    let samples = samples.parse()?;
    let medium = MEDIA.iter().find(|medium| medium.name == "ash").ok_or("no medium ash")?.medium;
    let light = vec3(0.7, 0.5, 0.5).normalize();
    println!("| sprite | | {} |", BANDS.map(|(low, high)| format!("{low} to {high} pixels")).join(" | "));
    println!("|---|---|{}", "---|".repeat(BANDS.len()));
    for sprite in ["puff", "billow", "wisp"] {
        let recipe = SpriteRecipe::of_builtin(builtin::find(builtin::SPRITES, sprite).ok_or("no such sprite")?)?;
        let fine = SpriteRecipe { noise_octaves: OCTAVES, ..recipe.clone() };
        let kind = PuffKind::new(&fine, &medium, PathTrace { size, samples, seed: 1 });
        let puff = kind.single();
        let volume = puff.volume();
        let [a, b] = [1, 2].map(|seed| {
            let Ok(traced) =
                PathTrace { size, samples, seed }.run(&volume, &medium, &[light], |_| Ok::<_, Infallible>(()));
            traced
        });
        let row = |name: &str, contrasts: [f32; 3]| {
            println!("| `{sprite}` | {name} | {} |", contrasts.map(|contrast| format!("{contrast:.3}")).join(" | "));
        };
        row("path-traced", contrasts([&a.light[0], &b.light[0]], &a.coverage));
        let coarse = PuffKind::new(&recipe, &medium, PathTrace { size: TEXELS, samples: 1, seed: 1 });
        for scale in [1, 2] {
            for (name, erosion, bump, octaves) in GRAINS {
                let mut material = coarse.material()?;
                let grain = &mut material.settings.grain;
                grain.erosion = erosion;
                grain.bump = bump;
                grain.octaves = octaves;
                material.settings.accumulate.downscale = scale;
                let drawn = puff.drawn(&[light], &material)?;
                let coverage = puff.drawn_coverage(&material)?;
                row(&format!("{name}, scale {scale}"), contrasts([&drawn[0]; 2], &coverage));
            }
        }
    }
    Ok(())
}

/// Contrast of each band, from two images of the same smoke.
fn contrasts(images: [&Image<Vec3>; 2], coverage: &Image<f32>) -> [f32; 3] {
    let luminances =
        images.map(|image| Image { size: image.size, texels: image.texels.iter().copied().map(luminance).collect() });
    let inside = blurred(coverage, BANDS[2].1);
    let means = luminances.each_ref().map(|image| blurred(image, BANDS[2].1));
    BANDS.map(|(low, high)| {
        let bands = luminances.each_ref().map(|image| (blurred(image, low), blurred(image, high)));
        let mut sum = 0.0;
        let mut count = 0;
        for index in (0..inside.texels.len()).filter(|index| inside.texels[*index] > 0.6) {
            let [a, b] = [0, 1].map(|of| {
                (bands[of].0.texels[index] - bands[of].1.texels[index]) / means[of].texels[index].max(1.0e-6)
            });
            sum += a * b;
            count += 1;
        }
        (sum / count.max(1) as f32).max(0.0).sqrt()
    })
}

/// An image without details of less than a wavelength.
fn blurred(image: &Image<f32>, wavelength: f32) -> Image<f32> {
    let deviation = wavelength / HALVED;
    let reach = (3.0 * deviation).ceil() as i32;
    let weights: Vec<_> = (-reach..=reach).map(|x| (-0.5 * (x as f32 / deviation).powi(2)).exp()).collect();
    let total: f32 = weights.iter().sum();
    let along = |image: &Image<f32>, axis: IVec2| {
        let mut blurred = Image::new(image.size, 0.0);
        blurred.for_each(|at: UVec2, texel: &mut f32| {
            let taps = (-reach..=reach).zip(&weights);
            *texel =
                taps.map(|(offset, weight)| image.load(at.as_ivec2() + axis * offset) * weight).sum::<f32>() / total;
        });
        blurred
    };
    along(&along(image, IVec2::X), IVec2::Y)
}
