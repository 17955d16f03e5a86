//! Compares the error that the scale mode `auto` predicts with the error of the image.

use glam::{UVec2, Vec4, Vec4Swizzles};
use haze_core::assets::image::Image;
use haze_core::formula::color::srgb_from_linear;
use haze_core::settings::ScaleMode;
use haze_demo::offscreen_renderer::OffscreenRenderer;
use haze_demo::shot::Shot;
use haze_preset::builtin;

use crate::gpu::gpu;
use crate::presets::{offscreen_context, without_smoke};
use crate::psnr::{MIN_PSNR, psnr_over};

/// A scale, and how it is chosen.
#[derive(Clone, Copy)]
enum Scale {
    Fixed(u32),
    /// With this largest error.
    Auto(f32),
}

fn with_scale(shot: &Shot, scale: Scale) -> Shot {
    let mut shot = shot.clone();
    for system in &mut shot.preset.systems {
        let accumulate = &mut system.settings.accumulate;
        match scale {
            Scale::Fixed(pixels) => accumulate.fix_scale(pixels),
            Scale::Auto(max_error) => {
                accumulate.scale_mode = ScaleMode::Auto;
                accumulate.max_error = max_error;
            }
        }
    }
    shot
}

/// Root mean square of the difference between images, sRGB, over the pixels that smoke has changed.
fn error([a, b, behind]: [&Image<Vec4>; 3]) -> f32 {
    let encoded = |texel: Vec4| texel.xyz().to_array().map(|x| srgb_from_linear(x.clamp(0.0, 1.0)));
    let off = |x: [f32; 3], y: [f32; 3]| (0..3).map(|i| (x[i] - y[i]).powi(2)).sum::<f32>() / 3.0;
    let mut sum = 0.0;
    let mut count = 0;
    for ((a, b), behind) in a.texels.iter().zip(&b.texels).zip(&behind.texels) {
        let [a, b, behind] = [*a, *b, *behind].map(encoded);
        if off(a, behind).max(off(b, behind)) > (1.0 / 255.0_f32).powi(2) {
            sum += f64::from(off(a, b));
            count += 1;
        }
    }
    (sum / f64::from(count.max(1))).sqrt() as f32
}

/// Renders shots with one renderer until a scale is chosen afresh.
struct Stage {
    renderer: OffscreenRenderer,
}

impl Stage {
    fn new() -> Self {
        Self { renderer: OffscreenRenderer::new(offscreen_context(), true).unwrap() }
    }

    fn render(&mut self, shot: &Shot) -> Image<Vec4> {
        self.renderer.draw(gpu(), shot).unwrap();
        self.renderer.read(gpu(), shot).unwrap()
    }

    /// Renders with the scale that is chosen. Returns the scale of the first system, and its predicted error.
    fn render_auto(&mut self, shot: &Shot, max_error: f32) -> (Image<Vec4>, u32, f32) {
        // Without the choice of a frame before.
        *self = Self::new();
        let image = self.render(&with_scale(shot, Scale::Auto(max_error)));
        let choice = self.renderer.scale_choices().next().unwrap();
        (image, choice.scale, choice.error.unwrap())
    }
}

#[test]
fn the_error_of_the_image_stays_near_the_limit() {
    let mut stage = Stage::new();
    let scales = ["inside", "backlit_fog", "crates", "fence", "spell", "steam_vent"].map(|name| {
        let shot = Shot::load(name, UVec2::new(480, 270)).unwrap();
        let [behind, full] =
            [&without_smoke(&shot), &with_scale(&shot, Scale::Fixed(1))].map(|shot| stage.render(shot));
        [0.004, 0.01].map(|max_error| {
            let (image, scale, predicted) = stage.render_auto(&shot, max_error);
            let measured = error([&image, &full, &behind]);
            println!("{name} within {max_error}: scale {scale}, predicted {predicted:.4}, measured {measured:.4}");
            assert!(
                scale == 1 || (predicted <= max_error && measured <= 1.5 * max_error),
                "{name} at scale {scale}: {measured}"
            );
            scale
        })
    });
    assert!(scales.iter().all(|[fine, coarse]| fine <= coarse), "{scales:?}");
    assert!(scales[0][1] == 4 && scales[5][1] == 1, "soft smoke takes a coarse scale: {scales:?}");
}

#[test]
fn both_renderers_choose_the_same_scale() {
    let mut stage = Stage::new();
    for name in ["inside", "backlit_fog"] {
        let shot = Shot::load(name, UVec2::new(320, 180)).unwrap();
        let (on_gpu, scale, _) = stage.render_auto(&shot, 0.015);
        assert!(scale > 1, "{name}");
        let on_cpu = with_scale(&shot, Scale::Auto(0.015)).render_on_cpu().unwrap();
        let behind = [&stage.render(&without_smoke(&shot)), &without_smoke(&shot).render_on_cpu().unwrap()];
        let psnr = psnr_over([&on_gpu, &on_cpu], behind);
        assert!(psnr >= MIN_PSNR, "{name}: {psnr:.1} dB");
    }
}

#[test]
#[ignore = "prints the figures of docs/upsampling.md"]
fn prints_predicted_and_measured_errors() {
    let mut stage = Stage::new();
    for preset in builtin::PRESETS {
        let shot = Shot::load(preset.name, UVec2::new(1280, 720)).unwrap();
        let [behind, full] =
            [&without_smoke(&shot), &with_scale(&shot, Scale::Fixed(1))].map(|shot| stage.render(shot));
        let (_, scale, predicted) = stage.render_auto(&shot, 0.005);
        print!("| `{}` | {scale}, {predicted:.4} |", preset.name);
        for scale in [2, 3, 4] {
            let reduced = stage.render(&with_scale(&shot, Scale::Fixed(scale)));
            print!(" {:.4} |", error([&reduced, &full, &behind]));
        }
        println!();
    }
}
