//! Measures the image error of a saving, and checks that an image is right at all.

use glam::{UVec2, Vec4};
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::formula::tonemap::DisplayTransform;
use haze_demo::headless::Headless;
use haze_demo::image_metrics::PsnrReport;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::{display_transform, tonemap};
use image::RgbImage;

use crate::flip::flips;
use crate::stop::check_stop;

/// Difference of an image from its reference; `None` where it is infinite or not measured.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quality {
    pub psnr_db: Option<f64>,
    pub flip: Option<f64>,
    pub edge_psnr_db: Option<f64>,
}

/// Full-resolution image that the images of a group are compared with.
pub struct Reference {
    image: Image<Vec4>,
    transform: DisplayTransform,
    tonemapped: RgbImage,
    /// View depth of the scene, metres, if the device can read it back.
    depth: Option<Image<f32>>,
}

impl Reference {
    /// Reads back the image that a renderer has drawn.
    pub fn read(gpu: &Headless, renderer: &OffscreenRenderer, shot: &Shot) -> Result<Self, Error> {
        let image = renderer.read(gpu, shot)?;
        let depth = match renderer.linear_depth() {
            Some(depth) => Some(Image { size: image.size, texels: gpu.read_r32float(depth)? }),
            None => None,
        };
        Ok(Self { transform: display_transform(shot), tonemapped: tonemap(&image, shot), image, depth })
    }

    /// Compares another image with this one, except for FLIP, which is slow. Also returns the tonemapped image
    /// for [`Self::flips`].
    pub fn compare(
        &self,
        gpu: &Headless,
        renderer: &OffscreenRenderer,
        shot: &Shot,
    ) -> Result<(Quality, RgbImage), Error> {
        let image = renderer.read(gpu, shot)?;
        let transforms = [display_transform(shot), self.transform];
        let apart = PsnrReport::compare([&image, &self.image], transforms, self.depth.as_ref());
        let finite = |db: f32| db.is_finite().then_some(f64::from(db));
        let quality =
            Quality { psnr_db: finite(apart.psnr), flip: None, edge_psnr_db: apart.edge_psnr.and_then(finite) };
        Ok((quality, tonemap(&image, shot)))
    }

    /// Returns the FLIP of tonemapped images against this one.
    pub fn flips(&self, images: &[RgbImage]) -> Vec<f64> {
        let pairs: Vec<_> = images.iter().map(|image| [&self.tonemapped, image]).collect();
        flips(&pairs)
    }
}

/// Image size at which the GPU is compared with the reference renderer.
const CHECK_SIZE: UVec2 = UVec2::new(96, 54);
/// Most sprites in that comparison; emitters with more are thinned out.
const MAX_SPRITES: f32 = 64.0;
/// PSNR, dB, below which the two renderers disagree. `nearest_depth` takes one of four texels, and rounding may take another:
/// `fence` at scale 4 is between 39.5 and 40, and nine tenths of such an error lie in some thirty pixels.
const MIN_AGREEMENT_DB: f32 = 38.0;

/// Checks the GPU's image of a shot against the reference renderer. The inner `Err` says what is wrong with it.
pub fn check_image(gpu: &Headless, context: &OffscreenContext, shot: &Shot) -> Result<Result<(), String>, Error> {
    let mut shot = Shot { size: CHECK_SIZE, ..shot.clone() };
    for system in &mut shot.preset.systems {
        let fewer = (MAX_SPRITES / system.emitter.max_alive() as f32).min(1.0);
        system.emitter.rate *= fewer;
        system.settings.debug.draw_count = 1;
        // The fewer sprites cover the same area.
        system.settings.sprite.size /= fewer.sqrt();
    }
    let mut renderer = OffscreenRenderer::new(context, false)?;
    renderer.warm_up(&shot)?;
    check_stop()?;
    renderer.draw(gpu, &shot)?;
    check_stop()?;
    let drawn = renderer.read(gpu, &shot)?;
    if drawn.texels.iter().any(|texel| !texel.is_finite()) {
        return Ok(Err("its image has pixels that are NaN or infinite".into()));
    }
    let transforms = [display_transform(&shot); 2];
    let apart = PsnrReport::compare([&drawn, &shot.render_on_cpu()?], transforms, None).psnr;
    let reason = || {
        format!("its image has {apart:.0} dB PSNR against the CPU renderer; expected at least {MIN_AGREEMENT_DB} dB")
    };
    Ok(if apart < MIN_AGREEMENT_DB { Err(reason()) } else { Ok(()) })
}
