//! Choice of the accumulation path for `auto`, with its reason and a delay before a switch.

use std::fmt;

use haze_core::settings::RenderPath;

use super::path_model::{PathModel, PathModelSource};
use super::workload::PathWorkload;

/// Frames for which the other path must look better before a switch: 0.5 s at 60 frames per second.
const SWITCH_DELAY_FRAMES: u32 = 30;
/// The other path looks better if its expected time is below this fraction of the current path's.
const SWITCH_RATIO: f32 = 0.95;

/// RenderPath that `auto` chose for a system, with the reason. `Display` formats it as one sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathChoice {
    /// [`RenderPath::Raster`] or [`RenderPath::Tiled`].
    pub path: RenderPath,
    /// Reason for the choice.
    pub reason: PathReason,
}

/// Reason for a [`PathChoice`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathReason {
    /// The path is expected to take less time than the other, or not enough more to justify a switch.
    Expected {
        /// Expected time to accumulate by `raster`, milliseconds.
        raster_ms: f32,
        /// Expected time to accumulate by `tiled`, milliseconds.
        tiled_ms: f32,
        /// Mean overdraw, layers per texel; `None` for particles in a host's buffer, which the CPU does not know.
        layers: Option<f32>,
        /// Origin of the cost model.
        source: PathModelSource,
    },
    /// The device does not support the path `tiled`.
    TiledUnsupported,
    /// Compute shaders cannot read the host's buffer: it lacks `STORAGE` usage, or its offset is not a multiple of 16
    /// bytes.
    BufferNotReadable,
    /// There are more particles than one storage buffer binding of this device can hold.
    TooManyParticles,
}

impl PathChoice {
    /// Returns the path with the lower expected time for a workload, regardless of earlier choices.
    pub fn new(model: &PathModel, workload: &PathWorkload) -> Self {
        let [raster_ms, tiled_ms] = model.milliseconds(workload);
        let layers = (!workload.is_assumed).then(|| workload.layers() as f32);
        Self {
            path: if tiled_ms < raster_ms { RenderPath::Tiled } else { RenderPath::Raster },
            reason: PathReason::Expected { raster_ms, tiled_ms, layers, source: model.source },
        }
    }
}

impl fmt::Display for PathChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.path.name())?;
        match self.reason {
            PathReason::Expected { raster_ms, tiled_ms, layers, source } => {
                let (own, other, name) = match self.path {
                    RenderPath::Tiled => (tiled_ms, raster_ms, "raster"),
                    _ => (raster_ms, tiled_ms, "tiled"),
                };
                write!(f, "about {} ms against {name}'s {} (overdraw ", digits(own), digits(other))?;
                match layers {
                    Some(layers) => write!(f, "{layers:.0}")?,
                    None => f.write_str("unknown, assumed 16")?,
                }
                write!(f, ", {})", source.name())
            }
            PathReason::TiledUnsupported => f.write_str("this device does not support the path tiled"),
            PathReason::BufferNotReadable => f.write_str(
                "compute shaders cannot read the particle buffer; expected STORAGE usage, an offset divisible by 16",
            ),
            PathReason::TooManyParticles => f.write_str("more particles than a shader can read on this device"),
        }
    }
}

/// Formats milliseconds with about two significant digits.
fn digits(ms: f32) -> String {
    let digits = if ms < 0.1 { 3 } else { usize::from(ms < 100.0) + usize::from(ms < 1.0) };
    format!("{ms:.digits$}")
}

/// Switches paths only after the other has looked better for a while, so that pipelines and targets are not recreated
/// every few frames.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PathChooser {
    taken: Option<RenderPath>,
    /// Consecutive frames for which the other path has looked better.
    frames_other_better: u32,
}

impl PathChooser {
    pub fn choose(&mut self, model: &PathModel, workload: &PathWorkload) -> PathChoice {
        let best = PathChoice::new(model, workload);
        let taken = *self.taken.get_or_insert(best.path);
        let PathReason::Expected { raster_ms, tiled_ms, .. } = best.reason else { return best };
        let is_worth_it = raster_ms.min(tiled_ms) < SWITCH_RATIO * raster_ms.max(tiled_ms);
        self.frames_other_better = if best.path != taken && is_worth_it { self.frames_other_better + 1 } else { 0 };
        if self.frames_other_better > SWITCH_DELAY_FRAMES {
            *self = Self { taken: Some(best.path), frames_other_better: 0 };
        }
        PathChoice { path: self.taken.unwrap_or(best.path), ..best }
    }
}

#[cfg(test)]
mod tests {
    use haze_core::glam::UVec2;

    use super::*;
    use haze_core::settings::Technique;

    fn workload(layers: f64) -> PathWorkload {
        PathWorkload {
            technique: Technique::Soft,
            sprites: 100.0,
            fragments: layers * 1.0e6,
            size: UVec2::splat(1000),
            optical_depth: 0.1,
            scale: 1,
            attachments: 1,
            grain_octaves: 0,
            lookups: 0.0,
            is_assumed: false,
        }
    }

    #[test]
    fn display_formats_a_choice_as_one_sentence() {
        let reason =
            PathReason::Expected { raster_ms: 9.8, tiled_ms: 3.12, layers: Some(64.2), source: PathModelSource::Probe };
        let choice = PathChoice { path: RenderPath::Tiled, reason };
        assert_eq!(choice.to_string(), "tiled: about 3.1 ms against raster's 9.8 (overdraw 64, probe)");
        let choice = PathChoice { path: RenderPath::Raster, reason: PathReason::TiledUnsupported };
        assert_eq!(choice.to_string(), "raster: this device does not support the path tiled");
        assert_eq!([0.0123, 0.234, 2.345, 234.5].map(digits), ["0.012", "0.23", "2.3", "234"]);
    }

    #[test]
    fn first_choice_is_immediate_and_a_switch_is_delayed() {
        let model = PathModel::for_device_type(wgpu::DeviceType::Cpu);
        let [few, many] = [workload(2.0), workload(2000.0)];
        let mut chooser = PathChooser::default();
        assert_eq!(chooser.choose(&model, &few).path, RenderPath::Raster);
        // A short advantage does not cause a switch.
        for _ in 0..10 {
            assert!((0..SWITCH_DELAY_FRAMES).all(|_| chooser.choose(&model, &many).path == RenderPath::Raster));
            assert_eq!(chooser.choose(&model, &few).path, RenderPath::Raster);
        }
        assert!((0..SWITCH_DELAY_FRAMES).all(|_| chooser.choose(&model, &many).path == RenderPath::Raster));
        assert_eq!(chooser.choose(&model, &many).path, RenderPath::Tiled);
        assert_eq!(PathChooser::default().choose(&model, &many).path, RenderPath::Tiled);
    }

    #[test]
    fn small_gain_does_not_cause_a_switch() {
        let mut model = PathModel::for_device_type(wgpu::DeviceType::Cpu);
        let mut chooser = PathChooser::default();
        model.tiled = model.raster.scaled(2.0);
        let workload = PathWorkload { optical_depth: 0.0, ..workload(10.0) };
        assert_eq!(chooser.choose(&model, &workload).path, RenderPath::Raster);
        model.tiled = model.raster.scaled(0.97);
        assert!((0..4 * SWITCH_DELAY_FRAMES).all(|_| chooser.choose(&model, &workload).path == RenderPath::Raster));
    }
}
