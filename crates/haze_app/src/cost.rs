//! What drawing costs, measured so that machines which do other things as well can be compared: all variants in turn, over
//! and over, and the median of each.

use std::time::Instant;

use haze::Error;
use haze_demo::headless::Headless;
use haze_demo::shot::Shot;
use haze_demo::stage::Stage;

use super::options::Backend;

/// Times of one variant, seconds, ascending.
pub struct Cost(Vec<f64>);

impl Cost {
    pub fn median(&self) -> f64 {
        let times = &self.0;
        let middle = times.len() / 2;
        if times.len() % 2 == 1 { times[middle] } else { 0.5 * (times[middle - 1] + times[middle]) }
    }

    /// Half the distance between the quartiles, as a share of the median; none of a single time.
    pub fn spread(&self) -> Option<f64> {
        let at = |share: f64| self.0[((self.0.len() - 1) as f64 * share).round() as usize];
        (self.0.len() > 1).then(|| 0.5 * (at(0.75) - at(0.25)) / self.median())
    }
}

/// What a figure is of so many rounds.
pub fn median_of(rounds: u32) -> String {
    if rounds == 1 { "one round".into() } else { format!("median of {rounds} rounds") }
}

/// Measures every variant in every round, after a round that is not counted. `measure` gives seconds.
pub fn interleaved(
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

/// Seconds against which a frame's own unsteadiness is small.
const LONG_ENOUGH: f64 = 0.05;
/// With the one that they are compared with, within the range of `debug_loop`.
const MOST_LOOPS: u32 = 8192;

/// Draws the smoke of a shot again and again.
pub enum Timer<'a> {
    Gpu(Box<Stage>, &'a Headless),
    Cpu,
}

impl<'a> Timer<'a> {
    pub fn new(backend: &'a Backend) -> Result<Self, Error> {
        Ok(match backend {
            Backend::Gpu(gpu) => Self::Gpu(Box::new(Stage::new(&gpu.context, false)?), &gpu.headless),
            Backend::Cpu => Self::Cpu,
        })
    }

    /// Seconds of one frame; on the CPU with the scene behind it.
    pub fn frame(&mut self, shot: &Shot) -> Result<f64, Error> {
        match self {
            Self::Gpu(stage, gpu) => Ok(stage.draw(gpu, shot)?.as_secs_f64()),
            Self::Cpu => {
                let start = Instant::now();
                shot.render_on_cpu()?;
                Ok(start.elapsed().as_secs_f64())
            }
        }
    }

    /// How often to draw all sprites so that the clock can tell what once costs.
    pub fn loops_that_tell(&mut self, shot: &Shot) -> Result<u32, Error> {
        let mut loops = 1;
        // The first frame compiles pipelines.
        self.frame(shot)?;
        while loops < MOST_LOOPS && self.sprites(shot, loops)? * f64::from(loops) < LONG_ENOUGH {
            loops *= 2;
        }
        Ok(loops)
    }

    /// Seconds that it takes to draw all sprites once, and nothing else: what more passes over them cost, per pass.
    pub fn sprites(&mut self, shot: &Shot, loops: u32) -> Result<f64, Error> {
        let mut shot = shot.clone();
        let mut frame = |times: u32| {
            shot.preset.systems.iter_mut().for_each(|system| system.settings.sprite.debug_loop = times);
            self.frame(&shot)
        };
        Ok((frame(loops + 1)? - frame(1)?) / f64::from(loops))
    }
}
