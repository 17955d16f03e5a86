//! Smoke that the borders of frames cut off, and the field of view that holds all of it.

use std::fmt::{Display, Formatter};

use glam::{UVec2, Vec4};
use haze::FieldError;
use haze_core::assets::image::Image;
use haze_core::error::Error;
use haze_core::frame::FOV_RANGE;
use haze_demo::shot::Shot;

use crate::backend::Backend;
use crate::image_export::{ExportProgress, Frames, stopped};
use crate::smoke_layers::SmokeLayers;

/// Setting that is fitted.
const FOV: &str = "camera.fov";
/// Longer side of the images by which a field of view is found, pixels, or that of smaller frames, whose borders are wider.
const PROBE_SIDE: u32 = 64;
/// Growth of the view from one image to the next.
const WIDENING: f32 = 1.05;
/// Least alpha that is not stored as 0.
const MIN_ALPHA: f32 = 0.5 / 255.0;

/// Smoke at the borders of frames, where an engine draws it as a hard edge.
#[derive(Clone, Debug, PartialEq)]
pub struct CutSmoke {
    /// Index of the first frame that has some.
    pub frame: u32,
    /// Number of frames that have some.
    pub frames: u32,
    /// Side of that frame with the largest alpha.
    pub side: &'static str,
    /// Largest alpha there, 0 to 1.
    pub alpha: f32,
    /// Vertical field of view that holds the smoke of all frames, degrees; `None` if none does.
    pub fitting_fov: Option<f32>,
    /// True if keyframes set the field of view.
    pub has_keyframes: bool,
}

impl CutSmoke {
    /// Adds what the borders of a frame cut off.
    pub(super) fn add_frame(found: &mut Option<Self>, frame: u32, smoke: &Image<Vec4>) {
        let (side, alpha) = densest_side(smoke);
        if alpha < MIN_ALPHA {
            return;
        }
        match found {
            Some(found) => found.frames += 1,
            None => *found = Some(Self { frame, frames: 1, side, alpha, fitting_fov: None, has_keyframes: false }),
        }
    }
}

impl Display for CutSmoke {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { frame, frames, side, alpha, fitting_fov, has_keyframes } = self;
        write!(f, "frame {frame} cuts off smoke on its {side} side, with alpha {alpha:.2}")?;
        match frames {
            1 => {}
            2 => write!(f, ", and so does 1 more")?,
            _ => write!(f, ", and so do {} more", frames - 1)?,
        }
        match fitting_fov {
            Some(fov) if *has_keyframes => {
                write!(f, "; a camera.fov of {fov:.1} degrees, without keyframes, holds all of it")
            }
            Some(fov) => write!(f, "; a camera.fov of {fov:.1} degrees holds all of it (--fit)"),
            None => write!(f, "; no field of view holds all of it: it takes a camera further back"),
        }
    }
}

/// Returns the side with the largest alpha on its border, and that alpha.
fn densest_side(smoke: &Image<Vec4>) -> (&'static str, f32) {
    let last = smoke.size.saturating_sub(UVec2::ONE);
    let mut densest = ("left", 0.0);
    for (index, texel) in (0..).zip(&smoke.texels) {
        let at = UVec2::new(index % smoke.size.x, index / smoke.size.x);
        let side = if at.x == 0 {
            "left"
        } else if at.x == last.x {
            "right"
        } else if at.y == 0 {
            "upper"
        } else if at.y == last.y {
            "lower"
        } else {
            continue;
        };
        if texel.w > densest.1 {
            densest = (side, texel.w);
        }
    }
    densest
}

/// Returns true if keyframes set the field of view.
pub(super) fn has_keyframes(shot: &Shot) -> bool {
    shot.preset.animation.iter().any(|track| track.setting == FOV)
}

/// Returns the vertical field of view that holds the smoke of the first `count` frames, degrees; `None` if none does. It is at
/// least that of the camera, and found by small images. `stopped` makes the error of a search that was stopped after so many frames.
pub(super) async fn fitting_fov(
    backend: &Backend,
    shot: &Shot,
    frames: &Frames,
    count: u32,
    progress: &ExportProgress<'_>,
    stopped: impl Fn(u32) -> Error,
) -> Result<Option<f32>, Error> {
    let mut small = shot.clone();
    let side = shot.size.max_element().max(1);
    small.size = (shot.size * PROBE_SIDE.min(side) / side).max(UVec2::splat(8));
    let mut fov = shot.preset.camera.fov;
    for index in 0..count {
        loop {
            if !progress.goes_on(index, count) {
                return Err(stopped(index));
            }
            let mut frame = frames.shot(&small, frames.range.start() + index);
            frame.preset.camera.fov = fov;
            let label = format!("haze: field of view that holds image {} of {count}", index + 1);
            let layers = progress.show(label, SmokeLayers::new(backend, &frame)).await?;
            if densest_side(&layers.light).1 < MIN_ALPHA {
                break;
            }
            let slope = (0.5 * fov).to_radians().tan() * WIDENING;
            fov = 2.0 * slope.atan().to_degrees();
            if !FOV_RANGE.contains(&fov) {
                return Ok(None);
            }
        }
    }
    Ok(Some(fov))
}

/// Sets the field of view that holds the smoke of the first `count` frames.
///
/// # Errors
/// [`Error::Field`] if none does, and if keyframes set it; errors of rendering; [`AssetError::Io`](haze_core::error::AssetError::Io) if it was stopped.
pub(super) async fn fit(
    backend: &Backend,
    shot: &mut Shot,
    frames: &Frames,
    count: u32,
    progress: &ExportProgress<'_>,
) -> Result<(), Error> {
    let refused = |problem: &str, expected: &str| Err(FieldError::from_problem("--fit", problem, expected).into());
    if has_keyframes(shot) {
        return refused("keyframes set camera.fov", "a preset whose camera.fov has none");
    }
    let stopped = |done| stopped("--fit".as_ref(), format!("nothing is written; {done} of {count} images fit"));
    let Some(fov) = fitting_fov(backend, shot, frames, count, progress, stopped).await? else {
        return refused("no field of view holds all of the smoke", "a camera further back");
    };
    shot.preset.camera.fov = fov;
    Ok(())
}
