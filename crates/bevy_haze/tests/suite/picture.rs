//! Pictures of linear light, and measures of them.

use std::path::Path;

use bevy::asset::RenderAssetUsages;
use bevy::prelude::Image;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use half::f16;

/// Linear RGBA, rows from the top.
#[derive(Clone, Debug)]
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<[f32; 4]>,
}

impl Picture {
    /// From tightly packed half floats.
    pub fn from_half(width: u32, height: u32, bytes: &[u8]) -> Self {
        let value = |bytes: &[u8]| f16::from_le_bytes([bytes[0], bytes[1]]).to_f32();
        let pixel = |bytes: &[u8]| [0, 2, 4, 6].map(|at| value(&bytes[at..]));
        let pixels: Vec<_> = bytes.chunks_exact(8).map(pixel).collect();
        assert_eq!(pixels.len() as u32, width * height);
        Self { width, height, pixels }
    }

    /// Saves the displayed picture as a PNG file.
    pub fn save(&self, file: &Path) {
        let size = Extent3d { width: self.width, height: self.height, depth_or_array_layers: 1 };
        let bytes =
            self.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b, 1.0].map(|v| (shown(v) * 255.0).round() as u8));
        let bytes = bytes.collect();
        let format = TextureFormat::Rgba8UnormSrgb;
        let image = Image::new(size, TextureDimension::D2, bytes, format, RenderAssetUsages::default());
        image.try_into_dynamic().unwrap().save(file).unwrap();
    }

    /// Pixels that differ visibly from those of another picture.
    pub fn mask_of_difference(&self, other: &Self) -> Vec<bool> {
        let pairs = self.pixels.iter().zip(&other.pixels);
        pairs.map(|(a, b)| (0..3).any(|c| (shown(a[c]) - shown(b[c])).abs() > 2.0 / 255.0)).collect()
    }

    /// Peak signal-to-noise ratio of the displayed pictures, decibels, over the pixels of a mask. Infinite if equal.
    pub fn psnr(&self, other: &Self, mask: &[bool]) -> f64 {
        let pairs = self.pixels.iter().zip(&other.pixels).zip(mask).filter(|(_, inside)| **inside);
        let mut sum = 0.0;
        let mut count = 0;
        for ((a, b), _) in pairs {
            sum += (0..3).map(|c| f64::from(shown(a[c]) - shown(b[c])).powi(2)).sum::<f64>();
            count += 3;
        }
        assert!(count > 0, "no pixels to compare");
        10.0 * (f64::from(count) / sum).log10()
    }

    /// Mean position of the pixels of a mask.
    pub fn center(&self, mask: &[bool]) -> [f32; 2] {
        let inside = mask.iter().enumerate().filter(|(_, inside)| **inside).map(|(index, _)| index as u32);
        let mut x = 0.0;
        let mut y = 0.0;
        let mut count = 0.0;
        for index in inside {
            x += (index % self.width) as f32;
            y += (index / self.width) as f32;
            count += 1.0;
        }
        [x / count, y / count]
    }

    /// Mean light of the pixels of a mask.
    pub fn mean(&self, mask: &[bool]) -> f32 {
        let inside = self.pixels.iter().zip(mask).filter(|(_, inside)| **inside);
        let (sum, count) = inside
            .fold((0.0, 0.0), |(sum, count), (pixel, _)| (sum + (pixel[0] + pixel[1] + pixel[2]) / 3.0, count + 1.0));
        sum / count
    }
}

pub fn count(mask: &[bool]) -> usize {
    mask.iter().filter(|inside| **inside).count()
}

/// Displayed value of linear light.
fn shown(linear: f32) -> f32 {
    linear.clamp(0.0, 1.0).powf(1.0 / 2.2)
}
