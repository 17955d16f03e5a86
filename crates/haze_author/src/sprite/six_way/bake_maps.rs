//! Bakes six-way maps of a sprite recipe filled with a medium.

use glam::{IVec2, UVec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::formula::six_way::SixWay;
use image::{Rgba, RgbaImage};
use serde::{Deserialize, Serialize};

use super::image_as_bytes;
use super::packing::encode_texel;
use super::trace::{SixWayMix, TracedSixWay};
use crate::deterministic_math::exp;
use crate::path_trace::{DensityVolume, Medium, PathTrace};
use crate::sprite::bake::near_lossless::quantise_frame;
use crate::sprite::bake::{SheetLayout, SpriteRecipe};

/// Baked six-way maps, with settings that go with them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct BakedSixWay {
    /// The sheet, in the layout described in the module's documentation.
    #[serde(with = "image_as_bytes")]
    pub image: RgbaImage,
    /// Value for `diffuse.intensity` that makes the smoke as bright as the medium relative to white paper.
    pub intensity: f32,
    /// Value for `diffuse.six_way_color`.
    pub color: Vec3,
    /// Value for `diffuse.six_way_anisotropy`.
    pub anisotropy: f32,
}

/// Fraction of texels that may exceed the light stored as white.
const CLIPPED_FRACTION: f32 = 0.002;

impl SpriteRecipe {
    /// Path-traces every frame filled with a medium; amounts are those of the sprite. Light is traced at half the
    /// sprite's size with `samples` paths per pixel, and upsampled along normals. `progress` is called with the frame
    /// and the number of finished paths per pixel; an error from it cancels the bake.
    ///
    /// # Errors
    /// The error of `progress`.
    pub fn bake_six_way<E>(
        &self,
        medium: &Medium,
        samples: u32,
        progress: impl Fn(u32, u32) -> Result<(), E>,
    ) -> Result<BakedSixWay, E> {
        let size = (self.size / 2).max(8);
        let filled = Self { size, extinction: medium.density, ..self.clone() };
        let frame = |frame: u32| (filled.volume(frame as f32), self.bake_frame(frame as f32).image);
        bake_six_way(self.sheet(), medium, samples, frame, progress)
    }
}

/// Bakes the six-way maps of a sheet. `frame` returns the density of a frame, at the resolution of the light, and its
/// sprite. Otherwise as [`SpriteRecipe::bake_six_way`].
///
/// # Errors
/// The error of `progress`.
pub fn bake_six_way<E>(
    sheet: SheetLayout,
    medium: &Medium,
    samples: u32,
    frame: impl Fn(u32) -> (DensityVolume, Image<Rgba<u8>>),
    progress: impl Fn(u32, u32) -> Result<(), E>,
) -> Result<BakedSixWay, E> {
    let mut mix = None::<SixWayMix>;
    let mut frames = Vec::new();
    for index in 0..sheet.frame_count() {
        let (volume, shape) = frame(index);
        let path_trace = PathTrace { size: volume.size.x, samples, seed: index };
        let traced = TracedSixWay::trace(&volume, medium, &path_trace, mix.as_ref(), |path| progress(index, path))?;
        let light = upsample_along_normals(&traced, &shape);
        mix.get_or_insert(traced.mix);
        frames.push((shape, light));
    }
    let white = white_level(&frames);
    let halves = frames.iter().flat_map(|(shape, light)| {
        [false, true].map(|below| {
            let mut half = Image::new(shape.size, Rgba([0; 4]));
            half.for_each(|at, pixel| {
                let SixWay { positive, negative } = light.load(at.as_ivec2());
                let alpha = shape.load(at.as_ivec2()).0[3];
                *pixel = encode_texel(if below { negative } else { positive } / white, alpha);
            });
            quantise_frame(&mut half, sheet.tolerance);
            half
        })
    });
    let halves: Vec<_> = halves.collect();
    let image = RgbaImage::from_fn(sheet.size * sheet.columns, 2 * sheet.size * sheet.rows, |x, y| {
        let row = y / sheet.size;
        let frame = row % sheet.rows * sheet.columns + x / sheet.size;
        let half = &halves[(2 * frame + row / sheet.rows) as usize];
        half.load(UVec2::new(x % sheet.size, y % sheet.size).as_ivec2())
    });
    let (color, anisotropy) = mix.map_or((Vec3::ONE, 0.0), |mix| (mix.color, mix.anisotropy));
    let brightest = color.max_element();
    Ok(BakedSixWay { image, intensity: white * brightest, color: color / brightest, anisotropy })
}

/// Returns the light to store as white: all visible texels except the fraction [`CLIPPED_FRACTION`] are darker.
fn white_level(frames: &[(Image<Rgba<u8>>, Image<SixWay>)]) -> f32 {
    let seen = frames.iter().flat_map(|(shape, light)| shape.texels.iter().zip(&light.texels));
    let seen = seen.filter(|(texel, _)| texel.0[3] > 25);
    let mut light: Vec<f32> = seen.map(|(_, light)| light.positive.max(light.negative).max_element()).collect();
    light.sort_by(f32::total_cmp);
    let index = (light.len() as f32 * (1.0 - CLIPPED_FRACTION)) as usize;
    light.get(index.min(light.len().saturating_sub(1))).copied().unwrap_or(1.0).max(1.0e-6)
}

/// Radius of the upsampling filter, in texels of the traced image.
const REACH: i32 = 2;
/// Standard deviation of the filter's weight over the difference of normals.
const SLOPE: f32 = 0.35;

/// Upsamples light to the sprite's size with a cross-bilateral filter on normals. It smooths the noise of the path
/// tracer and preserves the shape.
fn upsample_along_normals(traced: &TracedSixWay, shape: &Image<Rgba<u8>>) -> Image<SixWay> {
    let fine = shape.size;
    let coarse = traced.light.size;
    let normals = coarse_normals(shape, coarse);
    let mut light = Image::new(fine, SixWay::default());
    light.for_each(|at, texel| {
        let position = (at.as_vec2() + 0.5) * coarse.as_vec2() / fine.as_vec2() - 0.5;
        let middle = position.round().as_ivec2();
        let normal = normal_of(shape.load(at.as_ivec2()));
        let mut sum = SixWay::default();
        let mut weights = 0.0;
        for y in -REACH..=REACH {
            for x in -REACH..=REACH {
                let tap = (middle + IVec2::new(x, y)).clamp(IVec2::ZERO, coarse.as_ivec2() - 1);
                let distance = (tap.as_vec2() - position).length_squared();
                let slope = (normals.load(tap) - normal).length_squared() / (SLOPE * SLOPE);
                let weight = exp(-0.5 * (distance + slope)) * traced.coverage.load(tap).max(1.0e-6);
                let SixWay { positive, negative } = traced.light.load(tap);
                sum.positive += positive * weight;
                sum.negative += negative * weight;
                weights += weight;
            }
        }
        *texel = SixWay { positive: sum.positive / weights, negative: sum.negative / weights };
    });
    light
}

fn coarse_normals(shape: &Image<Rgba<u8>>, size: UVec2) -> Image<Vec3> {
    let mut normals = Image::new(size, Vec3::Z);
    let scale = shape.size.as_vec2() / size.as_vec2();
    normals.for_each(|at, normal| {
        let [low, high] = [at, at + 1].map(|corner| (corner.as_vec2() * scale).as_ivec2());
        let texels = (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| IVec2::new(x, y)));
        *normal = texels.map(|at| normal_of(shape.load(at))).sum::<Vec3>().normalize_or(Vec3::Z);
    });
    normals
}

fn normal_of(texel: Rgba<u8>) -> Vec3 {
    let [x, y, z, _] = texel.0.map(|channel| f32::from(channel) / 255.0 * 2.0 - 1.0);
    Vec3::new(x, y, z)
}
