//! Format of a benchmark report, whose rows a spreadsheet or jq reads directly.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use glam::UVec2;
use haze::FieldError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::suites::Suite;

/// Newest version of the report format.
pub const VERSION: u32 = 1;

/// Report of a run, as `--json` writes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Format version.
    pub version: u32,
    /// Adapter, driver and versions of the run.
    pub adapter: Adapter,
    /// False if the run was stopped or the device was lost; the rows that are present are valid.
    pub complete: bool,
    /// Number of timestamps that were discarded because they were reversed or zero.
    pub discarded: u64,
    /// One row per measured case, in the order of the suites.
    pub rows: Vec<Row>,
    /// Cases that were not measured, with the reasons.
    pub left_out: Vec<LeftOut>,
}

/// A case that was not measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeftOut {
    /// Suite of the case.
    pub suite: String,
    /// Name of the case.
    pub case: String,
    /// Reason why it was not measured.
    pub reason: String,
}

/// Adapter, driver and versions of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Adapter {
    /// Name of the adapter, from the driver.
    pub name: String,
    /// `Vulkan`, `Metal`, `Dx12`, `Gl`.
    pub backend: String,
    /// Name and version of the driver.
    pub driver: String,
    /// True if a CPU renders in software.
    pub software: bool,
    /// Version of wgpu.
    pub wgpu: String,
    /// Version of haze, and the git revision if it was built in a checkout.
    pub haze: String,
}

/// Clock that a time was measured with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// GPU timestamps of haze's own passes.
    Gpu,
    /// Wall time of the smoke, from submission to completion: on software adapters, whose timestamps leave work out, and on
    /// adapters without timestamps.
    Wall,
    /// Time of one CPU core.
    Cpu,
}

impl Clock {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gpu => "GPU",
            Self::Wall => "wall",
            Self::Cpu => "CPU",
        }
    }
}

/// One measured case. Fields that do not apply are null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Suite of the case.
    pub suite: String,
    /// Name of the case: unique within its suite, and the same in every run.
    pub case: String,
    /// Image size in pixels, for example `1280x720`.
    pub size: String,
    /// Pixels per texel of the accumulation target.
    pub scale: Option<u32>,
    /// Format of the accumulation target.
    pub format: Option<String>,
    /// Rendering path: `raster`, `tiled`, `forward` or `auto`.
    pub path: Option<String>,
    /// Lighting mode, for example `ramp` or `cubemap`; on the path `tiled` the layers that are blended, `visible` or
    /// `all`; on `auto` the path that was chosen.
    pub mode: Option<String>,
    /// Soft-particle technique.
    pub technique: Option<String>,
    /// Curve of the soft fade.
    pub fade: Option<String>,
    /// Measured overdraw: fragments per texel of the target that the smoke's box covers.
    pub layers: Option<f64>,
    /// Mean alpha of a sprite's drawn rectangle, before any fade.
    pub alpha: Option<f64>,
    /// Number of lights.
    pub lights: Option<u32>,
    /// Number of live particles.
    pub particles: Option<u32>,
    /// Clock of the times.
    pub clock: Clock,
    /// Number of measured frames.
    pub samples: u32,
    /// Milliseconds per frame of the smoke.
    pub gpu_ms: Milliseconds,
    /// Median milliseconds per frame, by pass. They are measured in frames of their own and may add up to more than `gpu_ms`, because
    /// passes that are measured one by one cannot overlap.
    pub passes: BTreeMap<String, f64>,
    /// Fragments shaded per frame.
    pub fragments: Option<u64>,
    /// Billions of fragments per second, from the median.
    pub gfragments_per_s: Option<f64>,
    /// Least number of bytes that blending moves per frame: every fragment reads and writes its texel.
    pub bytes: Option<u64>,
    /// Median time divided by the time that as many fragments of an unlit disc take, each depth-tested, with one
    /// texture fetch, and blended into the same format: the floor of every method that blends on this adapter is 1.
    pub limit_ratio: Option<f64>,
    /// PSNR in dB against the same smoke, deferred, at full resolution; null for that case itself and for identical
    /// images.
    pub psnr_db: Option<f64>,
    /// FLIP against the same image, 0 to 1; 0 means no visible difference.
    pub flip: Option<f64>,
    /// PSNR in dB over the pixels near jumps in the scene's depth.
    pub edge_psnr_db: Option<f64>,
}

impl Row {
    pub fn is_of(&self, suite: Suite) -> bool {
        self.suite == suite.name()
    }

    /// Creates a row with a time and no other figures.
    pub fn of(suite: Suite, case: String, size: UVec2, clock: Clock, gpu_ms: Milliseconds) -> Self {
        Self {
            suite: suite.name(),
            case,
            size: format!("{}x{}", size.x, size.y),
            scale: None,
            format: None,
            path: None,
            mode: None,
            technique: None,
            fade: None,
            layers: None,
            alpha: None,
            lights: None,
            particles: None,
            clock,
            samples: 0,
            gpu_ms,
            passes: BTreeMap::new(),
            fragments: None,
            gfragments_per_s: None,
            bytes: None,
            limit_ratio: None,
            psnr_db: None,
            flip: None,
            edge_psnr_db: None,
        }
    }
}

/// Statistics of the times of many frames, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Milliseconds {
    pub median: f64,
    pub min: f64,
    pub max: f64,
    /// Lower and upper quartile.
    pub quartiles: [f64; 2],
}

impl Milliseconds {
    /// Sorts the times and returns their statistics; `None` without times.
    pub fn of(times: &mut [f64]) -> Option<Self> {
        times.sort_by(f64::total_cmp);
        let &min = times.first()?;
        let &max = times.last()?;
        // Interpolates linearly between the two nearest times.
        let at = |fraction: f64| {
            let position = (times.len() - 1) as f64 * fraction;
            let low = times[position.floor() as usize];
            let high = times[position.ceil() as usize];
            low + (high - low) * position.fract()
        };
        Some(Self { median: at(0.5), min, max, quartiles: [at(0.25), at(0.75)] })
    }

    /// Checks that ratios and spreads of the times are finite numbers.
    ///
    /// # Errors
    /// Names the field, and `row` before it.
    pub fn validate(&self, row: &str) -> Result<(), FieldError> {
        /// A picosecond to eleven days. Ratios divide by the median, so only the others may be zero.
        const MEDIAN: (RangeInclusive<f64>, &str) = (1.0e-9..=1.0e9, "1e-9 to 1e9 milliseconds");
        const OTHERS: (RangeInclusive<f64>, &str) = (0.0..=1.0e9, "0 to 1e9 milliseconds");
        let [low, high] = self.quartiles;
        for (field, value, (range, expected)) in [
            ("median", self.median, MEDIAN),
            ("min", self.min, OTHERS),
            ("max", self.max, OTHERS),
            ("quartiles[0]", low, OTHERS),
            ("quartiles[1]", high, OTHERS),
        ] {
            if !range.contains(&value) {
                return Err(FieldError::new(format!("{row}.gpu_ms.{field}"), value, expected));
            }
        }
        Ok(())
    }

    /// Half the distance between the quartiles, as a fraction of the median.
    pub fn spread(&self) -> f64 {
        0.5 * (self.quartiles[1] - self.quartiles[0]) / self.median
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_quartiles_match_their_definition() {
        assert_eq!(Milliseconds::of(&mut []), None);
        let of = |times: &[f64]| Milliseconds::of(&mut times.to_vec()).unwrap();
        assert_eq!(of(&[3.0]), Milliseconds { median: 3.0, min: 3.0, max: 3.0, quartiles: [3.0; 2] });
        let five = of(&[5.0, 1.0, 4.0, 2.0, 3.0]);
        assert_eq!(five, Milliseconds { median: 3.0, min: 1.0, max: 5.0, quartiles: [2.0, 4.0] });
        assert!((five.spread() - 1.0 / 3.0).abs() < 1e-12);
        assert!((of(&[1.0, 2.0]).median - 1.5).abs() < 1e-12);
    }
}
