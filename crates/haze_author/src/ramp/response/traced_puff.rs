//! A path-traced puff, and its shading with ramps or six-way maps.

use glam::{UVec2, Vec2, Vec3};
use haze_core::assets::image::Image;
use haze_core::assets::ramp::Ramp;
use haze_core::formula::color::luminance;
use haze_core::formula::lighting::{backlight_weight, diffuse_coordinate};
use haze_core::formula::ramp::sample_ramp_2d;
use haze_core::formula::six_way::{six_way_from_texel, six_way_response};
use haze_core::settings::RampFilter;
use serde::{Deserialize, Serialize};

use crate::deterministic_math::cos_sin;
use crate::path_trace::{Medium, PathTrace, PathTraceResult};
use crate::sprite::bake::SpriteRecipe;
use crate::sprite::six_way::BakedSixWay;

/// Number of lights in the ring around a puff.
pub const LIGHTS: u32 = 16;

/// A path-traced puff under a horizontal ring of lights at its height, the first one at the viewer. Holds the traced
/// light and the normals and coverage for ramp lookups.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Puff {
    pub(super) lights: Vec<Vec3>,
    /// Texels with coverage above 0.
    pub(super) texels: Vec<Texel>,
    pub(super) traced: PathTraceResult,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Texel {
    /// Index in the image, row by row.
    pub index: usize,
    normal: Vec3,
    pub coverage: f32,
}

/// Ramps for the diffuse light lookup.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseRamps<'a> {
    /// `diffuse_ramp` of a material.
    pub diffuse: &'a Ramp,
    /// `backlight_ramp`, if light from behind has a separate ramp.
    pub backlight: Option<&'a Ramp>,
}

/// Brightness of shaded smoke under the ring of lights, compared with the path-traced truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Factor on the shaded light that minimises the error: `diffuse.intensity`.
    pub exposure: f32,
    /// One entry per light.
    pub lights: Vec<LightResponse>,
    /// Mean relative error of brightness over the lights.
    pub error: f32,
    /// Root mean square error over all pixels and lights, relative to the root mean square of the truth.
    pub pixel_error: f32,
}

/// Brightness under one light: mean luminance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightResponse {
    /// Path-traced brightness.
    pub truth: f32,
    /// Shaded brightness, times exposure.
    pub shown: f32,
}

impl Puff {
    /// Path-traces the first frame of a sprite recipe whose densities are filled with a medium. `progress` as in
    /// [`PathTrace::run`].
    pub fn trace<E>(
        recipe: &SpriteRecipe,
        medium: &Medium,
        path_trace: &PathTrace,
        progress: impl Fn(u32) -> Result<(), E>,
    ) -> Result<Self, E> {
        // Uses the medium's opacity; tolerance 0 disables the changes that only make files smaller.
        let recipe = SpriteRecipe { size: path_trace.size, extinction: medium.density, tolerance: 0, ..recipe.clone() };
        let lights: Vec<_> = (0..LIGHTS).map(light).collect();
        let traced = path_trace.run(&recipe.volume(0.0), medium, &lights, progress)?;
        let texel = |(index, texel): (usize, &image::Rgba<u8>)| {
            let [x, y, z, _] = texel.0.map(|channel| f32::from(channel) / 255.0 * 2.0 - 1.0);
            let normal = Vec3::new(x, y, z).normalize_or(Vec3::Z);
            let coverage = traced.coverage.texels[index];
            (coverage > 0.0).then_some(Texel { index, normal, coverage })
        };
        let texels = recipe.bake_frame(0.0).image.texels.iter().enumerate().filter_map(texel).collect();
        Ok(Self { lights, texels, traced })
    }

    /// Returns the path-traced light.
    pub fn traced(&self) -> &PathTraceResult {
        &self.traced
    }

    /// Shades the puff with ramps under a light: linear RGB times coverage.
    pub fn shown(&self, ramps: DiffuseRamps<'_>, light: usize) -> Image<Vec3> {
        let mut image = Image::new(self.traced.coverage.size, Vec3::ZERO);
        for texel in &self.texels {
            image.texels[texel.index] = ramps.sample(texel, self.lights[light]) * texel.coverage;
        }
        image
    }

    /// Shades the puff with six-way maps under a light, as [`Puff::shown`]. The maps must be of one frame of the puff's
    /// size.
    pub fn shown_six_way(&self, maps: &BakedSixWay, light: usize) -> Image<Vec3> {
        let size = self.traced.coverage.size;
        let mut image = Image::new(size, Vec3::ZERO);
        for texel in &self.texels {
            let at = UVec2::new(texel.index as u32 % size.x, texel.index as u32 / size.x);
            let half = |y| {
                let [r, g, b, _] = maps.image.get_pixel(at.x, y).0.map(|channel| f32::from(channel) / 255.0);
                six_way_from_texel(Vec3::new(r, g, b))
            };
            let positive = half(at.y);
            let negative = half(at.y + size.y);
            let response = six_way_response(positive, negative, self.lights[light], maps.anisotropy);
            image.texels[texel.index] = maps.color * (response * texel.coverage);
        }
        image
    }

    /// Compares shading with ramps to the truth, at the best exposure.
    pub fn response(&self, ramps: DiffuseRamps<'_>) -> Response {
        self.compare_images(|light| self.shown(ramps, light))
    }

    /// Compares images, one per light, to the truth, at the best exposure.
    pub fn compare_images(&self, shown: impl Fn(usize) -> Image<Vec3>) -> Response {
        let shown: Vec<_> = (0..self.lights.len()).map(shown).collect();
        Response::new(&shown, &self.traced.light)
    }
}

impl Response {
    /// Compares images to true ones, one per light. The exposure minimises the squared relative errors of brightness
    /// over all lights.
    pub fn new(shown: &[Image<Vec3>], truth: &[Image<Vec3>]) -> Self {
        let mean = |image: &Image<Vec3>| luminance(image.texels.iter().sum()) / image.texels.len() as f32;
        let both = || shown.iter().zip(truth);
        let lights: Vec<_> =
            both().map(|(shown, truth)| LightResponse { truth: mean(truth), shown: mean(shown) }).collect();
        let fraction = |light: &LightResponse| light.shown / light.truth.max(f32::MIN_POSITIVE);
        let squares: f32 = lights.iter().map(|light| fraction(light).powi(2)).sum();
        let exposure = lights.iter().map(fraction).sum::<f32>() / squares.max(f32::MIN_POSITIVE);
        let off = lights.iter().map(|light| (exposure * fraction(light) - 1.0).abs());
        let error = off.sum::<f32>() / lights.len() as f32;
        let texels = || both().flat_map(|(shown, truth)| shown.texels.iter().zip(&truth.texels));
        let off: f32 = texels().map(|(&shown, &truth)| (shown * exposure - truth).length_squared()).sum();
        let all: f32 = texels().map(|(_, truth)| truth.length_squared()).sum();
        let lights = lights.into_iter().map(|light| LightResponse { shown: light.shown * exposure, ..light }).collect();
        Self { exposure, lights, error, pixel_error: (off / all.max(f32::MIN_POSITIVE)).sqrt() }
    }
}

/// Returns the angle of a light in the ring, degrees: 0 at the viewer, 180 behind the smoke.
pub fn light_angle(light: usize) -> f32 {
    360.0 * light as f32 / LIGHTS as f32
}

/// Returns the direction to a light of the ring.
fn light(index: u32) -> Vec3 {
    let turn = cos_sin(index as f32 * std::f32::consts::TAU / LIGHTS as f32);
    Vec3::new(turn.y, 0.0, turn.x)
}

impl Texel {
    /// Returns the ramp coordinate for a light.
    pub fn coordinate(&self, light: Vec3) -> Vec2 {
        Vec2::new(diffuse_coordinate(self.normal, light), self.coverage)
    }
}

impl DiffuseRamps<'_> {
    fn sample(&self, texel: &Texel, light: Vec3) -> Vec3 {
        let sample = |ramp| sample_ramp_2d(ramp, RampFilter::Bilinear, texel.coordinate(light));
        let from_front = sample(self.diffuse);
        self.backlight.map_or(from_front, |ramp| from_front.lerp(sample(ramp), backlight_weight(light, Vec3::Z)))
    }
}
