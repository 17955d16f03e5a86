//! PSNR of images of smoke, and its limits.

use glam::Vec4;
use haze_core::assets::image::Image;

use crate::test_scene::BACKDROP;

/// Lowest PSNR of two correct renderers, dB. They differ by f16 rounding, by the order of f32 operations, and by edges
/// that are snapped to 1/256 pixel: 57 to 84 dB on llvmpipe, with Vulkan and OpenGL. The mistakes in
/// properties/mutants.rs give 12 to 36.
pub const MIN_PSNR: f32 = 54.0;

/// Lowest PSNR of images with hard steps, which may fall on either side of a pixel, dB. Sprites with the debug
/// checkerboard give 45 dB on an NVIDIA H200 and 68 dB on llvmpipe. Ramps sampled at the nearest texel give 50 dB on
/// llvmpipe, because of four pixels in five thousand.
pub const MIN_PSNR_WITH_STEPS: f32 = 44.0;

/// Returns the PSNR of two images of smoke over the scene's backdrop, dB; see [`psnr_over`].
pub fn psnr(a: &Image<Vec4>, b: &Image<Vec4>) -> f32 {
    let behind = Image::new(a.size, BACKDROP);
    psnr_over([a, b], [&behind, &behind])
}

/// Returns the peak signal-to-noise ratio of two images of smoke, dB. Only pixels that differ from their background by
/// more than 1/255 in either image are counted; the others contain no smoke. Linear HDR color is clamped to 0..4 and
/// has peak 4; alpha has peak 1.
pub fn psnr_over(images: [&Image<Vec4>; 2], behind: [&Image<Vec4>; 2]) -> f32 {
    let [a, b] = images.map(|image| &image.texels);
    let [behind_a, behind_b] = behind.map(|image| &image.texels);
    assert!(a.len() == b.len() && a.len() == behind_a.len() && a.len() == behind_b.len());
    let differs = |a: Vec4, b: Vec4| (a - b).abs().max_element() > 1.0 / 255.0;
    let smoke = (0..a.len()).filter(|&i| differs(a[i], behind_a[i]) || differs(b[i], behind_b[i]));
    let peaks = Vec4::new(4.0, 4.0, 4.0, 1.0);
    let mut sum = 0.0;
    let mut pixels = 0_u32;
    for i in smoke {
        let [a, b] = [a[i], b[i]].map(|texel| texel.clamp(Vec4::ZERO, peaks) / peaks);
        sum += f64::from((a - b).length_squared());
        pixels += 1;
    }
    assert!(pixels > 0, "no smoke to compare");
    let mean = sum / f64::from(4 * pixels);
    (-10.0 * mean.max(1.0e-12).log10()) as f32
}
