//! From linear HDR to a picture file. The library never tonemaps; this is the demo program's own taste.

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use haze::demo::shot::Shot;
use haze::formula::tonemap::{developed, dither};
use haze::picture::Picture;
use image::RgbImage;

/// Develops a rendered shot: exposure and a film curve for pictures, the bare values for data.
pub fn develop(picture: &Picture<Vec4>, shot: &Shot) -> RgbImage {
    let exposure = shot.preset.camera.exposure.exp2();
    let mut rounded = Picture::new(picture.size, [0_u8; 3]);
    rounded.for_each(|at, out| {
        let colour = picture.load(at.as_ivec2()).xyz();
        *out = quantise(if shot.shade_tree.is_data() { colour } else { developed(colour, exposure) }, at);
    });
    // A texel for every pixel, so never empty.
    RgbImage::from_raw(picture.size.x, picture.size.y, rounded.texels.into_flattened()).unwrap_or_default()
}

/// Rounds to 8 bits.
fn quantise(encoded: Vec3, at: UVec2) -> [u8; 3] {
    // Rounded by the cast, which also clamps.
    ((encoded + dither(at)) * 255.0 + 0.5).to_array().map(|channel| channel as u8)
}
