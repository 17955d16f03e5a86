//! Measures draw times of several variants in turn, round by round, so that other load on the machine slows all
//! variants alike; takes the median of each.

use std::time::Instant;

use haze_core::error::Error;
use haze_demo::headless::Headless;
use haze_demo::offscreen_renderer::OffscreenRenderer;
use haze_demo::shot::Shot;

use haze_export::backend::Backend;

/// Times of one variant in seconds, ascending.
pub struct Cost(Vec<f64>);

impl Cost {
    /// Median of the samples, milliseconds.
    pub fn median(&self) -> f64 {
        let times = &self.0;
        let middle = times.len() / 2;
        if times.len() % 2 == 1 { times[middle] } else { 0.5 * (times[middle - 1] + times[middle]) }
    }

    /// Half the distance between the quartiles, as a fraction of the median; `None` for a single time.
    pub fn spread(&self) -> Option<f64> {
        let at = |fraction: f64| self.0[((self.0.len() - 1) as f64 * fraction).round() as usize];
        (self.0.len() > 1).then(|| 0.5 * (at(0.75) - at(0.25)) / self.median())
    }
}

/// Says how a figure was measured, for tables.
pub fn median_of(rounds: u32) -> String {
    if rounds == 1 { "one round".into() } else { format!("median of {rounds} rounds") }
}

/// Measures every variant once per round, after one warm-up round. `measure` returns seconds.
pub fn measure_interleaved(
    rounds: u32,
    variants: usize,
    mut measure: impl FnMut(usize) -> Result<f64, Error>,
) -> Result<Vec<Cost>, Error> {
    let mut times = vec![Vec::new(); variants];
    for round in 0..=rounds {
        for (variant, times) in times.iter_mut().enumerate() {
            let seconds = measure(variant)?;
            if round > 0 {
                times.push(seconds);
            }
        }
    }
    let sorted = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        Cost(times)
    };
    Ok(times.into_iter().map(sorted).collect())
}

/// Seconds of work beside which the jitter of a frame is small.
const MIN_SECONDS: f64 = 0.05;
/// Most passes over the sprites; with the single pass they are compared with, within the range of `debug.draw_count`.
const MAX_LOOPS: u32 = 8192;

/// Measures the time of a shot's smoke.
pub enum FrameTimer<'a> {
    /// Renderer on a device.
    Gpu(Box<OffscreenRenderer>, &'a Headless),
    /// The CPU renderer.
    Cpu,
}

impl<'a> FrameTimer<'a> {
    /// Prepares the renderer of a backend.
    ///
    /// # Errors
    /// Those of the renderer.
    pub fn new(backend: &'a Backend) -> Result<Self, Error> {
        Ok(match backend {
            Backend::Gpu(gpu) => {
                Self::Gpu(Box::new(OffscreenRenderer::new(&gpu.context, false)?.with_kept_paths()), &gpu.headless)
            }
            Backend::Cpu => Self::Cpu,
        })
    }

    /// Draws a frame and returns its seconds; on the CPU they include the scene.
    pub fn frame_seconds(&mut self, shot: &Shot) -> Result<f64, Error> {
        match self {
            Self::Gpu(renderer, gpu) => Ok(renderer.draw(gpu, shot)?.as_secs_f64()),
            Self::Cpu => {
                let start = Instant::now();
                shot.render_on_cpu()?;
                Ok(start.elapsed().as_secs_f64())
            }
        }
    }

    /// Returns a number of passes over all sprites that takes long enough to measure.
    pub fn measurable_loops(&mut self, shot: &Shot) -> Result<u32, Error> {
        let mut loops = 1;
        // The first frame compiles pipelines.
        self.frame_seconds(shot)?;
        while loops < MAX_LOOPS && self.seconds_per_pass(shot, loops)? * f64::from(loops) < MIN_SECONDS {
            loops *= 2;
        }
        Ok(loops)
    }

    /// Seconds per pass over all sprites, without the fixed cost of a frame: the time that `loops` more passes take,
    /// divided by `loops`.
    pub fn seconds_per_pass(&mut self, shot: &Shot, loops: u32) -> Result<f64, Error> {
        let mut shot = shot.clone();
        let mut frame = |times: u32| {
            shot.preset.systems.iter_mut().for_each(|system| system.settings.debug.draw_count = times);
            self.frame_seconds(&shot)
        };
        Ok((frame(loops + 1)? - frame(1)?) / f64::from(loops))
    }
}
