//! What the tests share: the device.

use std::sync::OnceLock;

use glam::Vec4;
use haze::headless::Headless;
use haze::reference::picture::Picture;

/// The one device of this process. A machine without an adapter fails, with the line that installs one.
pub fn gpu() -> &'static Headless {
    static GPU: OnceLock<Headless> = OnceLock::new();
    GPU.get_or_init(|| match Headless::new() {
        Ok(gpu) => {
            eprintln!("adapter: {}", gpu.description());
            gpu
        }
        Err(error) => panic!("{error}"),
    })
}

/// Peak signal-to-noise ratio of two linear HDR pictures, decibels: clamped to 0..4, divided by 4, peak 1.
pub fn psnr(a: &Picture<Vec4>, b: &Picture<Vec4>) -> f32 {
    assert_eq!(a.size, b.size);
    let channel = |x: f32| f64::from(x.clamp(0.0, 4.0) / 4.0);
    let square = |(a, b): (&Vec4, &Vec4)| {
        (0..3).map(|i| (channel(a[i]) - channel(b[i])).powi(2)).sum::<f64>()
    };
    let sum: f64 = a.texels.iter().zip(&b.texels).map(square).sum();
    let mean = sum / (3 * a.texels.len()) as f64;
    (-10.0 * mean.max(1.0e-12).log10()) as f32
}
