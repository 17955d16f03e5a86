//! Panorama of the sky: radiance of all directions, equirectangular.

use std::f32::consts::PI;
use std::path::{Path, PathBuf};

use glam::{IVec2, UVec2, Vec2, Vec3};
use half::f16;
use haze_core::assets::image::Image;

use super::sky_light::SkyLight;

/// Maximum width, texels.
pub const MAX_SKY_WIDTH: u32 = 8192;

/// Panorama; see the module's documentation. The middle shows -z, the direction in which default cameras look; +x is to the
/// right, +y up.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyImage {
    /// Linear radiance; alpha is 1.
    pub texels: Image<[f16; 4]>,
    /// Its light on matte surfaces.
    pub light: SkyLight,
    /// File that it was read from.
    pub file: PathBuf,
}

impl SkyImage {
    /// Takes linear radiance, row by row from the top. Light beyond what half floats hold, and below 0, is cut.
    ///
    /// # Errors
    /// The reason, for an image that is not twice as wide as high, wider than [`MAX_SKY_WIDTH`], or has a value that is not a
    /// number.
    pub fn new(size: UVec2, radiance: impl Iterator<Item = Vec3>, file: &Path) -> Result<Self, String> {
        if size.x < 2 || size.x.abs_diff(2 * size.y) > 1 || size.x > MAX_SKY_WIDTH {
            let expected = format!("a panorama twice as wide as high, at most {MAX_SKY_WIDTH}x{}", MAX_SKY_WIDTH / 2);
            return Err(format!("{}x{} texels; expected {expected}", size.x, size.y));
        }
        let mut texels = Image::new(size, [f16::ONE; 4]);
        for (index, (texel, radiance)) in (0..).zip(texels.texels.iter_mut().zip(radiance)) {
            if radiance.is_nan() {
                let x = index % size.x;
                let y = index / size.x;
                return Err(format!("texel {x}, {y} is not a number; expected linear light, 0 or more"));
            }
            let [red, green, blue] = radiance.clamp(Vec3::ZERO, Vec3::splat(f16::MAX.to_f32())).to_array();
            *texel = [f16::from_f32(red), f16::from_f32(green), f16::from_f32(blue), f16::ONE];
        }
        let light = light(&texels);
        Ok(Self { texels, light, file: file.into() })
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> u64 {
        8 * self.texels.texels.len() as u64
    }

    /// Radiance of a direction, filtered between texels.
    pub fn sample(&self, direction: Vec3) -> Vec3 {
        let position = uv(direction) * self.texels.size.as_vec2() - 0.5;
        let at = position.floor().as_ivec2();
        let mix = position - position.floor();
        let width = self.texels.size.x as i32;
        let texel = |x: i32, y: i32| color(self.texels.load(IVec2::new((at.x + x).rem_euclid(width), at.y + y)));
        let row = |y| texel(0, y).lerp(texel(1, y), mix.x);
        row(0).lerp(row(1), mix.y)
    }

    /// The same panorama, no wider than a device can hold.
    pub fn fitted(&self, max_width: u32) -> Image<[f16; 4]> {
        let mut image = self.texels.clone();
        while image.size.x > max_width.max(2) {
            let mut half = Image::new((image.size / 2).max(UVec2::ONE), [f16::ONE; 4]);
            half.for_each(|at, texel| {
                let corner = |x, y| color(image.load((2 * at + UVec2::new(x, y)).as_ivec2()));
                let mean = 0.25 * (corner(0, 0) + corner(1, 0) + corner(0, 1) + corner(1, 1));
                let [red, green, blue] = mean.to_array().map(f16::from_f32);
                *texel = [red, green, blue, f16::ONE];
            });
            image = half;
        }
        image
    }
}

/// Place of a direction in the panorama, 0 to 1 from its upper left corner. `sky_uv` in scene.wgsl of haze_demo.
pub fn uv(direction: Vec3) -> Vec2 {
    let across = direction.x.atan2(-direction.z) / (2.0 * PI) + 0.5;
    Vec2::new(across, direction.y.clamp(-1.0, 1.0).acos() / PI)
}

/// Direction of a position in the panorama.
pub(super) fn direction(uv: Vec2) -> Vec3 {
    let (sin, cos) = (2.0 * PI * (uv.x - 0.5)).sin_cos();
    let (down, up) = (PI * uv.y).sin_cos();
    Vec3::new(sin * down, up, -cos * down)
}

fn color([red, green, blue, _]: [f16; 4]) -> Vec3 {
    Vec3::new(red.to_f32(), green.to_f32(), blue.to_f32())
}

/// Light of the panorama, from means over blocks: matte surfaces blur it far more.
fn light(image: &Image<[f16; 4]>) -> SkyLight {
    let size = image.size;
    let block = size.x.div_ceil(512).max(1);
    let mut light = SkyLight::default();
    for y in 0..size.y {
        // Exact solid angle of a row.
        let edge = |y: u32| (PI * y as f32 / size.y as f32).cos();
        let angle = (edge(y) - edge(y + 1)) * 2.0 * PI / size.x as f32;
        for first in (0..size.x).step_by(block as usize) {
            let end = (first + block).min(size.x);
            let sum: Vec3 = (first..end).map(|x| color(image.texels[(y * size.x + x) as usize])).sum();
            let position = Vec2::new(0.5 * (first + end) as f32, y as f32 + 0.5) / size.as_vec2();
            light.add(direction(position), sum, angle);
        }
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(of: impl Fn(Vec3) -> Vec3) -> SkyImage {
        let size = UVec2::new(64, 32);
        let position =
            |index: u32| Vec2::new((index % size.x) as f32 + 0.5, (index / size.x) as f32 + 0.5) / size.as_vec2();
        let radiance = (0..size.x * size.y).map(|index| of(direction(position(index))));
        SkyImage::new(size, radiance, Path::new("sky.hdr")).unwrap()
    }

    #[test]
    fn directions_and_light_come_back() {
        let sky = sky(|d| 2.0 + d);
        for d in [Vec3::X, Vec3::NEG_Z, Vec3::Z, Vec3::Y, Vec3::NEG_Y, Vec3::new(-0.6, 0.0, 0.8)] {
            assert!(direction(uv(d)).abs_diff_eq(d, 1e-5), "{d}");
            assert!(sky.sample(d).abs_diff_eq(2.0 + d, 0.05), "{d}: {}", sky.sample(d));
            assert!(sky.light.on(d).abs_diff_eq(2.0 + d * (2.0 / 3.0), 0.01), "{d}: {}", sky.light.on(d));
        }
        assert_eq!(uv(Vec3::NEG_Z), Vec2::splat(0.5));
        assert!(uv(Vec3::X).x > 0.5, "+x is to the right");
        assert_eq!(sky.fitted(16).size, UVec2::new(16, 8));
    }

    #[test]
    fn what_is_no_panorama_is_refused() {
        let load = |size: (u32, u32), value: f32| {
            let texels = std::iter::repeat_n(Vec3::splat(value), (size.0 * size.1) as usize);
            SkyImage::new(size.into(), texels, Path::new("sky.hdr"))
        };
        assert!(load((30, 32), 1.0).unwrap_err().contains("30x32 texels; expected a panorama twice as wide as high"));
        assert!(load((4, 2), f32::NAN).unwrap_err().starts_with("texel 0, 0 is not a number"));
        assert_eq!(load((4, 2), f32::INFINITY).unwrap().sample(Vec3::X), Vec3::splat(65504.0));
        assert_eq!(load((4, 2), -1.0).unwrap().sample(Vec3::X), Vec3::ZERO);
    }
}
