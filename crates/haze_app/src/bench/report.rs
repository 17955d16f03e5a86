//! What a run of the benchmark says: rows that a spreadsheet or jq reads as they are.

use std::collections::BTreeMap;

use glam::UVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::suites::Suite;

/// Newest version of the format.
pub const VERSION: u32 = 1;

/// A run, as `--json` writes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Format version.
    pub version: u32,
    /// Where it was measured, and with what.
    pub adapter: Adapter,
    /// False if the run was stopped, or the device was lost: what is there is whole.
    pub complete: bool,
    /// Timestamps that were reversed or zero, and are in no figure.
    pub discarded: u64,
    /// One for each thing measured, in the order of the suites.
    pub rows: Vec<Row>,
    /// What was not measured, and why.
    pub left_out: Vec<LeftOut>,
}

/// Something that was not measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeftOut {
    /// Its suite.
    pub suite: String,
    /// Its case.
    pub case: String,
    /// Why not.
    pub reason: String,
}

/// A machine, and what was built.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Adapter {
    /// As the driver names it.
    pub name: String,
    /// `Vulkan`, `Metal`, `Dx12`, `Gl`.
    pub backend: String,
    /// The driver, and its version.
    pub driver: String,
    /// True where a CPU draws.
    pub software: bool,
    /// Version of wgpu.
    pub wgpu: String,
    /// Version of haze, and the git revision where it was built in a checkout.
    pub haze: String,
}

/// Which clock a time is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// GPU timestamps of haze's own passes.
    Gpu,
    /// Wall time of the whole frame: the adapter has no timestamps.
    Wall,
    /// Time of one CPU core.
    Cpu,
}

impl Clock {
    /// For tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gpu => "GPU",
            Self::Wall => "wall",
            Self::Cpu => "CPU",
        }
    }
}

/// One thing measured. What does not apply is null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// The suite it belongs to.
    pub suite: String,
    /// What sets it apart within its suite: with the suite it is unique, and the same from run to run.
    pub case: String,
    /// Size of the picture, as `1280x720`.
    pub size: String,
    /// Pixels per texel of the accumulation target.
    pub scale: Option<u32>,
    /// Format of the accumulation target.
    pub format: Option<String>,
    /// `raster`, `forward` …
    pub path: Option<String>,
    /// How lights answer: `ramp`, `cubemap` …; on the path `tiled`, how far it goes down the layers: `visible`, `all`; on
    /// `auto`, the path that it took.
    pub mode: Option<String>,
    /// How sprites meet the scene.
    pub technique: Option<String>,
    /// Curve of the soft fade.
    pub fade: Option<String>,
    /// Measured overdraw: fragments per texel of the target that the view covers.
    pub layers: Option<f64>,
    /// Mean alpha of what is drawn of a sprite, where nothing fades it.
    pub alpha: Option<f64>,
    /// Lights.
    pub lights: Option<u32>,
    /// Particles alive.
    pub particles: Option<u32>,
    /// Which clock the times are from.
    pub clock: Clock,
    /// How many frames were measured.
    pub samples: u32,
    /// Of the smoke, milliseconds a frame.
    pub gpu_ms: Milliseconds,
    /// Median milliseconds by pass.
    pub passes: BTreeMap<String, f64>,
    /// Fragments shaded a frame.
    pub fragments: Option<u64>,
    /// Billions of fragments a second, by the median.
    pub gfragments_per_s: Option<f64>,
    /// Bytes that blending moves at the least: every fragment reads and writes its texel.
    pub bytes: Option<u64>,
    /// Time over what as many fragments of an unlit disc take, tested, looked up once and blended into the same format: what any way
    /// that blends takes at the least on this adapter.
    pub limit_ratio: Option<f64>,
    /// Against the same smoke, deferred, at full resolution, dB; null where it is that, and where both are the same.
    pub psnr_db: Option<f64>,
    /// FLIP against the same, 0 to 1: 0 where nobody sees a difference.
    pub flip: Option<f64>,
    /// PSNR over the pixels by which the scene's depth jumps, dB.
    pub edge_psnr_db: Option<f64>,
}

impl Row {
    pub fn is_of(&self, suite: Suite) -> bool {
        self.suite == suite.name()
    }

    /// A row of nothing but a time.
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

/// What a time is over many frames.
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
    /// Of at least one time; they are sorted.
    pub fn of(times: &mut [f64]) -> Option<Self> {
        times.sort_by(f64::total_cmp);
        let (&min, &max) = (times.first()?, times.last()?);
        // Between the two nearest, by how near they are.
        let at = |share: f64| {
            let place = (times.len() - 1) as f64 * share;
            let (low, high) = (times[place.floor() as usize], times[place.ceil() as usize]);
            low + (high - low) * place.fract()
        };
        Some(Self { median: at(0.5), min, max, quartiles: [at(0.25), at(0.75)] })
    }

    /// Half the distance between the quartiles, as a share of the median.
    pub fn spread(&self) -> f64 {
        0.5 * (self.quartiles[1] - self.quartiles[0]) / self.median
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_those_of_the_definition() {
        assert_eq!(Milliseconds::of(&mut []), None);
        let of = |times: &[f64]| Milliseconds::of(&mut times.to_vec()).unwrap();
        assert_eq!(of(&[3.0]), Milliseconds { median: 3.0, min: 3.0, max: 3.0, quartiles: [3.0; 2] });
        let five = of(&[5.0, 1.0, 4.0, 2.0, 3.0]);
        assert_eq!(five, Milliseconds { median: 3.0, min: 1.0, max: 5.0, quartiles: [2.0, 4.0] });
        assert!((five.spread() - 1.0 / 3.0).abs() < 1e-12);
        assert!((of(&[1.0, 2.0]).median - 1.5).abs() < 1e-12);
    }
}
