//! Inputs of the formula tests: pseudo-random numbers, and small textures filled with them.

use std::sync::OnceLock;

use glam::{UVec2, UVec3, Vec2, Vec3, Vec4, vec3};
use haze_author::noise_recipe::NoiseRecipe;
use haze_core::assets::noise::{NoiseVolume, pcg3d, unit};
use haze_core::assets::ramp::Ramp;
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::formula::texture::Texture2d;

/// Tolerance for f32 arithmetic in another order, with fused or separate multiply-add: a few units in the last place.
pub const ARITHMETIC: f32 = 2e-6;
/// Tolerance for results of the driver's `pow`, `exp2`, `log2`, `sin` or `inverseSqrt`, which Vulkan allows to be this
/// imprecise.
pub const TRANSCENDENTAL: f32 = 2e-4;

/// Returns `count` cases of pseudo-random numbers in the given ranges. Every call returns the same numbers.
pub fn random(count: u32, ranges: &[(f32, f32)]) -> Vec<Vec<f32>> {
    let number = |case: u32, index: usize| unit(pcg3d(UVec3::new(case, index as u32, 77)).x);
    let pick = |case| (0..).zip(ranges).map(|(i, &(low, high))| low + (high - low) * number(case, i)).collect();
    (0..count).map(pick).collect()
}

/// Returns 40 cases for each of `choices` choices: the number of the choice, then random numbers in the given ranges.
pub fn with_choices(choices: u32, ranges: &[(f32, f32)]) -> Vec<Vec<f32>> {
    let prefix = |(index, mut case): (u32, Vec<f32>)| {
        case.insert(0, (index % choices) as f32);
        case
    };
    (0..).zip(random(40 * choices, ranges)).map(prefix).collect()
}

/// Returns the number of choices of a setting, so that a new choice is tested automatically.
pub fn count<T>(choices: &[T]) -> u32 {
    choices.len() as u32
}

/// Normalises the vector that begins at number `at` of each case.
pub fn unit_vectors(cases: Vec<Vec<f32>>, at: usize) -> Vec<Vec<f32>> {
    let normalise = |mut case: Vec<f32>| {
        let n = vec3(case[at], case[at + 1], case[at + 2]).normalize_or(Vec3::X);
        case[at..at + 3].copy_from_slice(&n.to_array());
        case
    };
    cases.into_iter().map(normalise).collect()
}

pub fn v2(x: &[f32]) -> Vec2 {
    Vec2::from_slice(x)
}

pub fn v3(x: &[f32]) -> Vec3 {
    Vec3::from_slice(x)
}

pub fn v4(x: &[f32]) -> Vec4 {
    Vec4::from_slice(x)
}

/// Returns a ramp of 8x4 texels with different pseudo-random colors.
pub fn test_ramp() -> Ramp {
    let color = |i: u32| {
        let hash = pcg3d(UVec3::new(i, 1, 2));
        vec3(unit(hash.x), unit(hash.y), unit(hash.z)) * 2.0
    };
    Ramp::from_linear(UVec2::new(8, 4), (0..32).map(color))
}

/// Returns the image of [`test_sprite`].
pub fn test_sprite_sheet() -> image::RgbaImage {
    let mut sheet = image::RgbaImage::new(24, 8);
    for (x, y, pixel) in sheet.enumerate_pixels_mut() {
        let hash = pcg3d(UVec3::new(x, y, 3));
        let border = x % 8 == 0 || x % 8 == 7 || y == 0 || y == 7;
        let is_clear = border || x % 8 > 4 || y > 3 + x / 8;
        let alpha = if is_clear { 0 } else { hash.x as u8 };
        *pixel = image::Rgba([hash.y as u8, hash.z as u8, (hash.y >> 8) as u8, alpha]);
    }
    sheet
}

/// Returns a flipbook of three 8x8 frames with different pseudo-random texels. Transparent at the border, on the
/// right, and at the bottom, there by a row less in each frame.
pub fn test_sprite() -> Sprite {
    let layout = SpriteLayout { columns: 3, rows: 1, y_down: false };
    Sprite::from_image(std::path::Path::new("test"), &test_sprite_sheet(), layout).unwrap()
}

/// Returns the word that `word(i)` reads in WGSL: its upper and its lower 16 bits are two numbers.
pub fn word(x: &[f32]) -> u32 {
    (x[0] as u32) << 16 | x[1] as u32
}

/// Returns the two numbers that `y_word(i, value)` writes in WGSL.
pub fn halves(word: u32) -> [f32; 2] {
    [word >> 16, word & 0xffff].map(|half| half as f32)
}

/// Range of a half of [`word`].
pub const HALF: (f32, f32) = (0.0, 65535.9);

/// Returns 1 for true and 0 for false.
pub fn flag(value: bool) -> Vec<f32> {
    vec![f32::from(value)]
}

/// One frame of a sprite at mip level 0.
pub struct SpriteFrameTexture(pub Sprite, pub u32);

impl Texture2d for SpriteFrameTexture {
    fn dimensions(&self) -> UVec2 {
        UVec2::splat(self.0.level_size(0))
    }
    fn load(&self, at: UVec2) -> Vec4 {
        self.0.texel(0, self.1, at.x, at.y)
    }
}

pub fn test_noise() -> &'static NoiseVolume {
    static NOISE: OnceLock<NoiseVolume> = OnceLock::new();
    NOISE.get_or_init(|| {
        let recipe = NoiseRecipe { version: 1, seed: 5, size: 8, cells: 2, octaves: 2, gain: 0.5 };
        NoiseVolume::from_image(std::path::Path::new("noise"), &recipe.bake().unwrap()).unwrap()
    })
}
