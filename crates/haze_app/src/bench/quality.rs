//! What a saving costs in image quality, and whether a picture is right at all.

use glam::{UVec2, Vec2, Vec4};
use haze::Error;
use haze::picture::Picture;
use haze_demo::apart::Apart;
use haze_demo::develop::{develop, exposure};
use haze_demo::headless::Headless;
use haze_demo::shot::Shot;
use haze_demo::stage::{Stage, StageContext};
use image::RgbImage;

use crate::flip::flips;

/// How far a picture is from another; none of what cannot be told.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quality {
    pub psnr_db: Option<f64>,
    pub flip: Option<f64>,
    pub edge_psnr_db: Option<f64>,
}

/// What the pictures of a group are compared with.
pub struct Reference {
    picture: Picture<Vec4>,
    exposure: f32,
    developed: RgbImage,
    /// View depth of the scene, where the device tells.
    depth: Option<Picture<f32>>,
}

impl Reference {
    /// What a stage has drawn.
    pub fn read(gpu: &Headless, stage: &Stage, shot: &Shot) -> Result<Self, Error> {
        let picture = stage.read(gpu, shot)?;
        let depth = match stage.linear_depth() {
            Some(depth) => Some(Picture { size: picture.size, texels: gpu.read_r32float(depth)? }),
            None => None,
        };
        Ok(Self { exposure: exposure(shot), developed: develop(&picture, shot), picture, depth })
    }

    /// How far what another stage has drawn is from it, but for FLIP, which takes long: the picture for that as well.
    pub fn compare(&self, gpu: &Headless, stage: &Stage, shot: &Shot) -> Result<(Quality, RgbImage), Error> {
        let picture = stage.read(gpu, shot)?;
        let exposures = Vec2::new(exposure(shot), self.exposure);
        let apart = Apart::of(&picture, &self.picture, exposures, self.depth.as_ref());
        let finite = |db: f32| db.is_finite().then_some(f64::from(db));
        let quality =
            Quality { psnr_db: finite(apart.psnr), flip: None, edge_psnr_db: apart.edge_psnr.and_then(finite) };
        Ok((quality, develop(&picture, shot)))
    }

    /// FLIP of pictures.
    pub fn flips(&self, pictures: &[RgbImage]) -> Vec<f64> {
        let pairs: Vec<_> = pictures.iter().map(|picture| [&self.developed, picture]).collect();
        flips(&pairs)
    }
}

/// Where both renderers are asked for the same.
const SMALL: UVec2 = UVec2::new(96, 54);
/// Most sprites that they are asked for: more are drawn as these are.
const MOST: f32 = 64.0;
/// Below this, dB, they do not agree.
const AGREEMENT: f32 = 40.0;

/// Whether the GPU draws what it should, by the reference renderer; why not where it does not.
pub fn is_right(gpu: &Headless, context: &StageContext, shot: &Shot) -> Result<Result<(), String>, Error> {
    let mut shot = Shot { size: SMALL, ..shot.clone() };
    for system in &mut shot.preset.systems {
        let fewer = (MOST / system.emitter.most_alive() as f32).min(1.0);
        system.emitter.rate *= fewer;
        system.settings.sprite.debug_loop = 1;
        // What is left covers as much.
        system.settings.sprite.size /= fewer.sqrt();
    }
    let mut stage = Stage::new(context, false)?;
    stage.warm_up(&shot)?;
    stage.draw(gpu, &shot)?;
    let drawn = stage.read(gpu, &shot)?;
    if drawn.texels.iter().any(|texel| !texel.is_finite()) {
        return Ok(Err("its picture has pixels that are no numbers".into()));
    }
    let exposure = Vec2::splat(exposure(&shot));
    let apart = Apart::of(&drawn, &shot.render_on_cpu()?, exposure, None).psnr;
    let reason = || format!("its picture is {apart:.0} dB from what it should be, less than {AGREEMENT} dB");
    Ok(if apart < AGREEMENT { Err(reason()) } else { Ok(()) })
}
