//! The choice, with its reason; and that it is kept.

use std::fmt;

use super::load::PathLoad;
use super::model::{PathModel, PathModelSource};
use crate::settings::Path;

/// Frames for which the other path must look better before it is taken: half a second of most games.
const PATIENCE: u32 = 30;
/// How much better it must look.
const GAIN: f32 = 0.95;

/// What the path `auto` takes for a system, and why. Its `Display` is one sentence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathChoice {
    /// [`Path::Raster`] or [`Path::Tiled`].
    pub path: Path,
    /// Why it is that.
    pub reason: PathReason,
}

/// Why a path is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathReason {
    /// It is expected to take less time, or not so much more that another would be worth the change.
    Expected {
        /// Milliseconds to accumulate by `raster`.
        raster_ms: f32,
        /// The same by `tiled`.
        tiled_ms: f32,
        /// Layers over a texel, in the mean; `None` where particles are in a host's buffer, which the CPU does not know.
        layers: Option<f32>,
        /// Where the figures are from.
        source: PathModelSource,
    },
    /// The device has no path `tiled`.
    NoTiles,
    /// Compute shaders cannot read the host's buffer: it has no `STORAGE` usage, or an offset that is no multiple of 16.
    BufferOfVertices,
    /// There are more particles than fit into what shaders of this device read.
    TooMany,
}

impl PathChoice {
    /// The better of the two for a load, whatever was taken before.
    pub fn new(model: &PathModel, load: &PathLoad) -> Self {
        let [raster_ms, tiled_ms] = model.milliseconds(load);
        let layers = (!load.is_assumed).then(|| load.layers() as f32);
        Self {
            path: if tiled_ms < raster_ms { Path::Tiled } else { Path::Raster },
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
                    Path::Tiled => (tiled_ms, raster_ms, "raster"),
                    _ => (raster_ms, tiled_ms, "tiled"),
                };
                write!(f, "about {} ms against {name}'s {} (overdraw ", digits(own), digits(other))?;
                match layers {
                    Some(layers) => write!(f, "{layers:.0}")?,
                    None => f.write_str("unknown, taken for 16")?,
                }
                write!(f, ", {})", source.name())
            }
            PathReason::NoTiles => f.write_str("this device has no path tiled"),
            PathReason::BufferOfVertices => f.write_str(
                "compute shaders cannot read the particles' buffer: STORAGE usage and an offset of 16 bytes",
            ),
            PathReason::TooMany => f.write_str("more particles than shaders of this device can read"),
        }
    }
}

/// Two digits or more that count.
fn digits(ms: f32) -> String {
    let digits = if ms < 0.1 { 3 } else { usize::from(ms < 100.0) + usize::from(ms < 1.0) };
    format!("{ms:.digits$}")
}

/// Keeps to a path until the other has looked better for a while, so that pipelines and targets do not come and go.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Chooser {
    taken: Option<Path>,
    /// Frames for which the other has looked better.
    other: u32,
}

impl Chooser {
    pub fn choose(&mut self, model: &PathModel, load: &PathLoad) -> PathChoice {
        let best = PathChoice::new(model, load);
        let taken = *self.taken.get_or_insert(best.path);
        let PathReason::Expected { raster_ms, tiled_ms, .. } = best.reason else { return best };
        let is_worth_it = raster_ms.min(tiled_ms) < GAIN * raster_ms.max(tiled_ms);
        self.other = if best.path != taken && is_worth_it { self.other + 1 } else { 0 };
        if self.other > PATIENCE {
            *self = Self { taken: Some(best.path), other: 0 };
        }
        PathChoice { path: self.taken.unwrap_or(best.path), ..best }
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;
    use crate::settings::Technique;

    fn load(layers: f64) -> PathLoad {
        PathLoad {
            technique: Technique::Soft,
            sprites: 100.0,
            fragments: layers * 1.0e6,
            size: UVec2::splat(1000),
            optical_depth: 0.1,
            lookups: 0.0,
            is_assumed: false,
        }
    }

    #[test]
    fn a_choice_is_a_sentence() {
        let reason =
            PathReason::Expected { raster_ms: 9.8, tiled_ms: 3.12, layers: Some(64.2), source: PathModelSource::Probe };
        let choice = PathChoice { path: Path::Tiled, reason };
        assert_eq!(choice.to_string(), "tiled: about 3.1 ms against raster's 9.8 (overdraw 64, probe)");
        let choice = PathChoice { path: Path::Raster, reason: PathReason::NoTiles };
        assert_eq!(choice.to_string(), "raster: this device has no path tiled");
        assert_eq!([0.0123, 0.234, 2.345, 234.5].map(digits), ["0.012", "0.23", "2.3", "234"]);
    }

    #[test]
    fn the_first_choice_is_at_once_and_another_takes_time() {
        let model = PathModel::of_class(wgpu::DeviceType::Cpu);
        let [few, many] = [load(2.0), load(2000.0)];
        let mut chooser = Chooser::default();
        assert_eq!(chooser.choose(&model, &few).path, Path::Raster);
        // What comes and goes changes nothing.
        for _ in 0..10 {
            assert!((0..PATIENCE).all(|_| chooser.choose(&model, &many).path == Path::Raster));
            assert_eq!(chooser.choose(&model, &few).path, Path::Raster);
        }
        assert!((0..PATIENCE).all(|_| chooser.choose(&model, &many).path == Path::Raster));
        assert_eq!(chooser.choose(&model, &many).path, Path::Tiled);
        assert_eq!(Chooser::default().choose(&model, &many).path, Path::Tiled);
    }

    #[test]
    fn what_is_hardly_better_is_not_worth_a_change() {
        let mut model = PathModel::of_class(wgpu::DeviceType::Cpu);
        let mut chooser = Chooser::default();
        model.tiled = model.raster.times(2.0);
        let load = PathLoad { optical_depth: 0.0, ..load(10.0) };
        assert_eq!(chooser.choose(&model, &load).path, Path::Raster);
        model.tiled = model.raster.times(0.97);
        assert!((0..4 * PATIENCE).all(|_| chooser.choose(&model, &load).path == Path::Raster));
    }
}
