//! From linear HDR to a picture file. The library never tonemaps; this is the demo program's own taste.

use glam::{Mat3, UVec2, UVec3, Vec3, Vec4, Vec4Swizzles, vec3};
use haze::demo::shot::Shot;
use haze::formula::colour::srgb_from_linear;
use haze::noise::{pcg3d, unit};
use haze::picture::Picture;
use haze::settings::ShadeTree;
use image::RgbImage;

/// Develops a rendered shot: exposure and a film curve for pictures, the bare values for data.
pub fn develop(picture: &Picture<Vec4>, shot: &Shot) -> RgbImage {
    let exposure = shot.preset.camera.exposure.exp2();
    let is_data = matches!(
        shot.shade_tree,
        ShadeTree::Normals | ShadeTree::Amount | ShadeTree::Overdraw | ShadeTree::ReducedDepth
    );
    let mut developed = Picture::new(picture.size, [0_u8; 3]);
    developed.for_each(|at, out| {
        let colour = picture.load(at.as_ivec2()).xyz();
        *out = quantise(if is_data { colour } else { film(colour * exposure).map(srgb_from_linear) }, at);
    });
    // A texel for every pixel, so never empty.
    RgbImage::from_raw(picture.size.x, picture.size.y, developed.texels.into_flattened()).unwrap_or_default()
}

/// The ACES film curve. (Hill, "BakingLab", 2016: a fit of the reference and output transforms)
fn film(colour: Vec3) -> Vec3 {
    const INPUT: Mat3 = Mat3::from_cols(
        vec3(0.597_19, 0.076, 0.028_4),
        vec3(0.354_58, 0.908_34, 0.133_83),
        vec3(0.048_23, 0.015_66, 0.837_77),
    );
    const OUTPUT: Mat3 = Mat3::from_cols(
        vec3(1.604_75, -0.102_08, -0.003_27),
        vec3(-0.531_08, 1.108_13, -0.072_76),
        vec3(-0.073_67, -0.006_05, 1.076_02),
    );
    let v = INPUT * colour.max(Vec3::ZERO);
    let fitted = (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081);
    (OUTPUT * fitted).clamp(Vec3::ZERO, Vec3::ONE)
}

/// Rounds to 8 bits with a triangular dither of one step, so that slow gradients do not band.
fn quantise(encoded: Vec3, at: UVec2) -> [u8; 3] {
    let hash = pcg3d(UVec3::new(at.x, at.y, 0));
    let dither = unit(hash.x) - unit(hash.y);
    // Rounded by the cast, which also clamps.
    (encoded * 255.0 + (0.5 + 0.5 * dither)).to_array().map(|channel| channel as u8)
}
