//! Smoke without the scene behind it: its light and its opacity, for other programs. Two images before skies of different
//! brightness tell both.

use glam::{Vec3, Vec4, Vec4Swizzles};
use haze_author::backdrop::Backdrop;
use haze_core::assets::image::Image;
use haze_demo::shot::Shot;
use haze_preset::SceneName;

/// Brightness of the second sky. Far above 1, so that half floats resolve the opacity of bright smoke too.
const BRIGHT: f32 = 64.0;

/// Returns the shot before an even dark sky, and before a bright one.
pub fn before_two_skies(shot: &Shot) -> [Shot; 2] {
    [0.0, BRIGHT].map(|light| {
        let mut shot = shot.at_its_time().into_owned();
        shot.backdrop = Backdrop::default();
        // It would carry light from pixel to pixel, and the sky's too.
        shot.preset.camera.bloom = 0.0;
        shot.preset.camera.antialiasing = false;
        shot.preset.camera.heat_haze = 0.0;
        let environment = &mut shot.preset.environment;
        environment.scene = SceneName::Empty;
        environment.zenith = Vec3::splat(light);
        environment.horizon = Vec3::splat(light);
        shot
    })
}

/// Separates the smoke of such a shot from its sky: linear, premultiplied color, and opacity in alpha.
pub fn separated([dark, bright]: [&Image<Vec4>; 2]) -> Image<Vec4> {
    let mut smoke = Image::new(dark.size, Vec4::ZERO);
    smoke.for_each(|at, out| {
        let [dark, bright] = [dark, bright].map(|image| image.load(at.as_ivec2()).xyz());
        let seen = (bright - dark).element_sum() / (3.0 * BRIGHT);
        *out = dark.extend((1.0 - seen).clamp(0.0, 1.0));
    });
    smoke
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;

    #[test]
    fn smoke_over_a_background_is_the_image_of_both() {
        for name in ["column", "campfire"] {
            let shot = Shot::load(name, UVec2::new(48, 48)).unwrap();
            let [dark, bright] = before_two_skies(&shot).map(|shot| shot.render_on_cpu().unwrap());
            let smoke = separated([&dark, &bright]);
            let mut between = before_two_skies(&shot)[0].clone();
            let light = Vec3::new(0.2, 0.5, 0.9);
            let environment = &mut between.preset.environment;
            environment.zenith = light;
            environment.horizon = light;
            let expected = between.render_on_cpu().unwrap();
            let opacities = smoke.texels.iter().map(|texel| texel.w);
            let (least, most) = opacities.fold((1.0_f32, 0.0_f32), |(low, high), a| (low.min(a), high.max(a)));
            assert!(least == 0.0 && most > 0.9, "{name}: {least} to {most}");
            for (smoke, expected) in smoke.texels.iter().zip(&expected.texels) {
                let over = smoke.xyz() + light * (1.0 - smoke.w);
                let error = (over - expected.xyz()).abs().max_element();
                // Images of the CPU have whole floats, whose steps at 64 are 8e-6.
                assert!(error < 1.0e-5, "{name}: {error}");
            }
        }
    }
}
