//! FLIP, the perceived difference of two images.

use haze_export::interrupt;
use image::RgbImage;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};

/// Mean FLIP, 0 to 1. (Andersson et al., "FLIP: A difference evaluator for alternating images", 2020)
pub fn flip_of(reference: &RgbImage, image: &RgbImage) -> f64 {
    let [reference, image] =
        [reference, image].map(|rgb| FlipImageRgb8::with_data(rgb.width(), rgb.height(), rgb.as_raw()));
    f64::from(FlipPool::from_image(&flip(reference, image, DEFAULT_PIXELS_PER_DEGREE)).mean())
}

/// Mean FLIP of many pairs, computed on all processors. After a request to stop, the others are 0.
pub fn flips(pairs: &[[&RgbImage; 2]]) -> Vec<f64> {
    let mut flips = vec![0.0; pairs.len()];
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let each = pairs.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        for (pairs, flips) in pairs.chunks(each).zip(flips.chunks_mut(each)) {
            scope.spawn(move || {
                for ([reference, image], flip) in pairs.iter().zip(flips) {
                    if interrupt::is_requested() {
                        break;
                    }
                    *flip = flip_of(reference, image);
                }
            });
        }
    });
    flips
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flip_is_0_for_equal_images_and_grows_with_the_difference() {
        let gray = |value: u8| RgbImage::from_pixel(64, 64, image::Rgb([value; 3]));
        assert!(flip_of(&gray(100), &gray(100)) < 1e-6);
        let near = flip_of(&gray(100), &gray(110));
        let far = flip_of(&gray(100), &gray(200));
        assert!(0.0 < near && near < far && far <= 1.0, "{near} {far}");
        let [gray_100, gray_110, gray_200] = [100, 110, 200].map(gray);
        let pairs = [[&gray_100, &gray_110], [&gray_100, &gray_200], [&gray_100, &gray_100]];
        assert_eq!(flips(&pairs), [near, far, 0.0]);
        assert!(flips(&[]).is_empty());
    }
}
