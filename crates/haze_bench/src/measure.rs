//! Measures the shots of a group in turn, frame by frame, so that other load on the machine slows all shots alike.

use std::collections::{BTreeMap, HashMap};
use std::time::{Duration, Instant};

use haze::{FrameTimes, Timing, TimingDetail, wgpu};
use haze_author::particle_files::{self, ParticleFrames};
use haze_core::error::Error;
use haze_core::settings::{AccumulationFormat, DebugView, RenderPath};
use haze_demo::headless::Headless;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenRenderer};
use haze_demo::shot::Shot;
use haze_export::interrupt;
use haze_preset::PresetSystem;
use image::RgbImage;

use super::clock_keepalive::ClockKeepalive;
use super::limit_work::bytes;
use super::quality::{Quality, Reference, check_image};
use super::report::{Clock, LeftOut, Milliseconds, Row};
use super::sprite_shots::mean_alpha;
use super::stop::check_stop;
use super::suites::{Case, Group, Suite};

/// Warm-up rounds of a GPU, which are not counted. Software adapters need none: the first look at a case has compiled its shaders.
const WARM_UP_ROUNDS: usize = 2;
/// Consecutive frames without a valid time after which a case is given up.
const MAX_TRIES: u32 = 8;
/// Most rounds of a group; more rounds add no information.
const MAX_ROUNDS: usize = 200;
const MIN_ROUNDS: usize = 3;

/// Measures groups and collects the results.
pub struct CaseBench<'a> {
    gpu: &'a Headless,
    keepalive: &'a ClockKeepalive<'a>,
    /// True if a CPU renders.
    is_software: bool,
    context: OffscreenContext,
    timing: Option<Timing>,
    /// Floor of the time per fragment, milliseconds, by format.
    pub limits: HashMap<AccumulationFormat, f64>,
    /// Bytes per millisecond of a copy.
    pub copy_rate: Option<f64>,
    /// Longest time that a frame may take; cases with slower frames are left out.
    longest: Duration,
    /// Milliseconds per unit of work, by kind of work, of the cases measured so far.
    costs: HashMap<String, f64>,
    pub discarded: u64,
    pub rows: Vec<Row>,
    pub left_out: Vec<LeftOut>,
}

/// Milliseconds of a frame's smoke, and of each of its passes.
struct SmokeTimes {
    ms: f64,
    passes: Vec<(&'static str, f64)>,
}

/// State of a case that is being measured.
struct RunningCase<'a> {
    case: &'a Case,
    offscreen: OffscreenRenderer,
    quality: Quality,
    times: Vec<f64>,
    passes: BTreeMap<&'static str, Vec<f64>>,
}

impl<'a> CaseBench<'a> {
    pub fn new(gpu: &'a Headless, keepalive: &'a ClockKeepalive<'a>, longest: Duration) -> Self {
        let context = OffscreenContext::new(&gpu.adapter, &gpu.device, &gpu.queue);
        // Without this feature the passes that light the smoke have no timestamps.
        let is_whole = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES);
        let is_software = gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        Self {
            // lavapipe's timestamps of compute passes leave their work out.
            timing: context.timing().filter(|_| is_whole && !is_software),
            is_software,
            gpu,
            keepalive,
            context,
            limits: HashMap::new(),
            copy_rate: None,
            longest,
            costs: HashMap::new(),
            discarded: 0,
            rows: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// Measures the cost model by which the path `auto` chooses on this adapter.
    ///
    /// # Errors
    /// If the device failed.
    pub fn measure_paths(&self) -> Result<(), Error> {
        // The model comes from wall time, which would include the wait for filler work.
        let _pause = self.keepalive.pause();
        let submit = |encoder| {
            check_stop()?;
            self.gpu.submit(encoder)
        };
        self.context.measure_paths(submit).map(|_| ())
    }

    fn clock(&self) -> Clock {
        if self.timing.is_some() { Clock::Gpu } else { Clock::Wall }
    }

    /// Measures a group for about `budget`. Returns the time that it needs at least.
    ///
    /// # Errors
    /// If the device failed, or a stop was requested; the cases measured so far are in the rows.
    pub fn group(&mut self, group: &Group, budget: Duration) -> Result<Duration, Error> {
        let started = Instant::now();
        let mut least = None;
        let reference = self.reference(group)?;
        let mut running = Vec::new();
        let mut images = Vec::new();
        for case in &group.cases {
            check_stop()?;
            match self.start_case(case, &reference)? {
                Ok((case, image)) => {
                    running.push(case);
                    images.push(image);
                }
                Err(reason) => self.skip_case(group.suite, &case.name, reason),
            }
        }
        running.iter_mut().zip(reference.flips(&images)).for_each(|(case, flip)| case.quality.flip = Some(flip));
        check_stop()?;
        drop((reference, images));
        let warm_up_rounds = if self.is_software { 0 } else { WARM_UP_ROUNDS };
        for round in 0..warm_up_rounds + MAX_ROUNDS {
            let elapsed = started.elapsed();
            let is_late = elapsed > budget;
            let is_enough = round >= warm_up_rounds + MIN_ROUNDS;
            if is_enough {
                least.get_or_insert(elapsed);
            }
            if interrupt::is_requested() || (is_late && is_enough) {
                break;
            }
            for case in &mut running {
                // Past the budget, only cases with too few times go on.
                if is_late && case.times.len() >= MIN_ROUNDS {
                    continue;
                }
                let taken = self.frame(&mut case.offscreen, &case.case.shot)?;
                let Some(SmokeTimes { ms, passes }) = taken else { continue };
                if round >= warm_up_rounds {
                    case.times.push(ms);
                    passes.iter().for_each(|(name, ms)| case.passes.entry(name).or_default().push(*ms));
                }
            }
        }
        for case in running {
            self.costs.insert(case.case.work.0.clone(), median(&case.times) / case.case.work.1);
            let row = self.row(group.suite, case);
            self.rows.extend(row);
        }
        check_stop()?;
        Ok(least.unwrap_or_else(|| started.elapsed()))
    }

    fn reference(&self, group: &Group) -> Result<Reference, Error> {
        let mut offscreen = OffscreenRenderer::new(&self.context, false)?;
        offscreen.warm_up(&group.reference)?;
        offscreen.draw(self.gpu, &group.reference)?;
        Reference::read(self.gpu, &offscreen, &group.reference)
    }

    fn skip_case(&mut self, suite: Suite, case: &str, reason: String) {
        self.left_out.push(LeftOut { suite: suite.name(), case: case.into(), reason });
    }

    /// Checks the image of a case before it is measured. The inner `Err` is the reason why the case is left out.
    fn start_case<'c>(
        &mut self,
        case: &'c Case,
        reference: &Reference,
    ) -> Result<Result<(RunningCase<'c>, RgbImage), String>, Error> {
        let longest = self.longest.as_secs_f64() * 1000.0;
        let seconds = |ms: f64| {
            format!("a frame would take about {:.1} s, more than the limit of {:.1} s", ms / 1000.0, longest / 1000.0)
        };
        if let Some(ms) = self.costs.get(&case.work.0).map(|cost| cost * case.work.1).filter(|&ms| ms > longest) {
            return Ok(Err(seconds(ms)));
        }
        match check_image(self.gpu, &self.context, &case.shot) {
            Ok(Ok(())) => {}
            Ok(Err(reason)) => return Ok(Err(reason)),
            // This device does not support the case.
            Err(Error::Field(error)) => return Ok(Err(error.to_string())),
            Err(error) => return Err(error),
        }
        check_stop()?;
        let mut offscreen = OffscreenRenderer::new(&self.context, false)?;
        offscreen.warm_up(&case.shot)?;
        check_stop()?;
        offscreen.set_timing(self.timing.as_ref())?;
        match self.frame(&mut offscreen, &case.shot)? {
            None => return Ok(Err("the GPU returned no valid timestamps for it".into())),
            Some(SmokeTimes { ms, .. }) if ms > longest => {
                self.costs.insert(case.work.0.clone(), ms / case.work.1);
                return Ok(Err(seconds(ms)));
            }
            Some(SmokeTimes { ms, .. }) => {
                let written = target_bytes(&offscreen, &case.shot);
                if let Some(reason) = self.copy_rate.and_then(|rate| impossible_time(ms, written, rate)) {
                    return Ok(Err(reason));
                }
            }
        }
        let (quality, image) = reference.compare(self.gpu, &offscreen, &case.shot)?;
        Ok(Ok((RunningCase { case, offscreen, quality, times: Vec::new(), passes: BTreeMap::new() }, image)))
    }

    /// Draws a frame; `None` if the GPU returned no valid timestamps in [`MAX_TRIES`] frames.
    fn frame(&mut self, offscreen: &mut OffscreenRenderer, shot: &Shot) -> Result<Option<SmokeTimes>, Error> {
        let Some(timing) = self.timing.clone() else {
            let _pause = self.keepalive.pause();
            let taken = offscreen.smoke_time(shot, &[DebugView::Final], |encoder| self.gpu.submit(encoder))?;
            return Ok(Some(SmokeTimes { ms: taken.as_secs_f64() * 1000.0, passes: Vec::new() }));
        };
        let Some(by_pass) = self.timed_frame(&timing, offscreen, shot, TimingDetail::Passes)? else { return Ok(None) };
        // Measuring each pass slows a GPU down, so the whole frame is measured in another one.
        let Some(whole) = self.timed_frame(&timing, offscreen, shot, TimingDetail::Frame)? else { return Ok(None) };
        let passes = by_pass.passes.iter().map(|pass| (pass.name, f64::from(pass.ms))).collect();
        Ok(Some(SmokeTimes { ms: f64::from(whole.smoke_ms()), passes }))
    }

    /// Draws a frame with timestamps; `None` if the GPU returned no valid ones in [`MAX_TRIES`] frames.
    fn timed_frame(
        &mut self,
        timing: &Timing,
        offscreen: &mut OffscreenRenderer,
        shot: &Shot,
        detail: TimingDetail,
    ) -> Result<Option<FrameTimes>, Error> {
        timing.set_detail(detail);
        for _ in 0..MAX_TRIES {
            let before = timing.latest().map(|times| times.frame);
            let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            offscreen.record(&mut encoder, shot, &[DebugView::Final])?;
            timing.resolve(&mut encoder);
            let pause = self.keepalive.pause();
            self.gpu.submit(encoder)?;
            drop(pause);
            let Some(times) = timing.latest().filter(|times| before != Some(times.frame)) else { continue };
            self.discarded += u64::from(times.discarded);
            if times.discarded == 0 {
                return Ok(Some(times));
            }
        }
        Ok(None)
    }

    /// Builds the row of a case; `None` if nothing was measured.
    fn row(&self, suite: Suite, mut running: RunningCase<'_>) -> Option<Row> {
        let gpu_ms = Milliseconds::of(&mut running.times)?;
        let shot = &running.case.shot;
        let system = shot.preset.systems.first()?;
        let settings = system.settings;
        let is_forward = settings.path == RenderPath::Forward;
        // Forward smoke is blended directly into the scene color.
        let format = if is_forward { AccumulationFormat::Rgba16Float } else { settings.accumulate.format };
        let overdraw = running.offscreen.renderer().overdraw();
        let fragments = overdraw.fragments;
        let limit = self.limits.get(&format).map(|ms| ms * fragments).filter(|&ms| ms > 0.0);
        let mut particles = Vec::new();
        let alive = |(system, cache): (&PresetSystem, &Option<ParticleFrames>)| {
            particle_files::particles(system, cache.as_ref(), shot.preset.time, &mut particles);
            particles.len() as u32
        };
        let alive = shot.preset.systems.iter().zip(&shot.caches).map(alive).sum();
        Some(Row {
            scale: (!is_forward).then_some(settings.accumulate.downscale),
            format: Some(format.name().into()),
            path: Some(settings.path.name().into()),
            mode: match settings.path {
                RenderPath::Forward => None,
                RenderPath::Tiled => Some(settings.accumulate.layers.name().into()),
                RenderPath::Auto => running.offscreen.renderer().path_choice(0).map(|choice| choice.path.name().into()),
                _ => Some(settings.diffuse.mode.name().into()),
            },
            technique: Some(settings.technique.name().into()),
            fade: Some(settings.soft_fade.curve.name().into()),
            layers: Some(overdraw.mean()),
            alpha: shot.materials.first().map(|material| {
                let alpha = f64::from(system.emitter.amount * mean_alpha(&material.sprite));
                (alpha * 1000.0).round() / 1000.0
            }),
            lights: Some(shot.preset.lights.len() as u32),
            particles: Some(alive),
            samples: running.times.len() as u32,
            passes: running.passes.iter().map(|(name, times)| ((*name).to_owned(), median(times))).collect(),
            fragments: Some(fragments as u64),
            gfragments_per_s: Some(fragments / gpu_ms.median * 1.0e-6),
            bytes: Some(fragments as u64 * 2 * u64::from(bytes(format))),
            limit_ratio: limit.map(|limit| gpu_ms.median / limit),
            psnr_db: running.quality.psnr_db,
            flip: running.quality.flip,
            edge_psnr_db: running.quality.edge_psnr_db,
            ..Row::of(suite, running.case.name.clone(), shot.size, self.clock(), gpu_ms)
        })
    }
}

/// Returns the bytes of the accumulation targets of the last frame, each written once; 0 on the path `forward`.
fn target_bytes(offscreen: &OffscreenRenderer, shot: &Shot) -> u64 {
    let texels = offscreen.renderer().counts().texels;
    let format = shot.preset.systems.first().map(|system| system.settings.accumulate.format);
    texels * format.map_or(0, |format| u64::from(bytes(format)))
}

/// Returns the reason to discard a time in which the device cannot have written so many bytes: some drivers' timestamps
/// leave work out. `rate`: bytes per millisecond of a copy, which reads as much as it writes.
fn impossible_time(ms: f64, written: u64, rate: f64) -> Option<String> {
    let least = written as f64 / rate;
    (ms < least).then(|| {
        format!("the timestamps give {ms:.4} ms, but writing its {written} bytes takes {least:.4} ms on this adapter")
    })
}

fn median(times: &[f64]) -> f64 {
    Milliseconds::of(&mut times.to_vec()).map_or(0.0, |ms| ms.median)
}

#[cfg(test)]
mod tests {
    use glam::UVec2;
    use haze_core::settings::Traversal;

    use super::*;
    use crate::sprite_shots::{layers, sprite_count};
    use crate::suite::{at_scale, changed};

    #[test]
    fn a_thousand_layers_take_many_times_as_long_as_four() {
        let features = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES;
        let gpu = Headless::with(wgpu::Limits::default(), features).unwrap();
        let keepalive = ClockKeepalive::new(&gpu).unwrap();
        let mut bench = CaseBench::new(&gpu, &keepalive, Duration::from_secs(60));
        let shots = [4, 1024].map(|deep| {
            let shot = layers(UVec2::new(192, 108), sprite_count(deep), 0.02).unwrap();
            changed(&shot, |settings| {
                at_scale(RenderPath::Tiled, 1)(settings);
                settings.accumulate.layers = Traversal::All;
            })
        });
        let mut shortest = [f64::INFINITY; 2];
        for (shot, shortest) in shots.iter().zip(&mut shortest) {
            let mut offscreen = OffscreenRenderer::new(&bench.context, false).unwrap();
            offscreen.warm_up(shot).unwrap();
            offscreen.set_timing(bench.timing.as_ref()).unwrap();
            for _ in 0..8 {
                let times = bench.frame(&mut offscreen, shot).unwrap().expect("a valid time");
                *shortest = shortest.min(times.ms);
            }
        }
        assert!(shortest[1] > 20.0 * shortest[0], "{shortest:?} ms");
    }

    #[test]
    fn a_time_too_short_for_its_bytes_is_discarded_with_the_reason() {
        // A copy of 1 GB/s, that is 1e6 bytes a millisecond.
        assert_eq!(impossible_time(2.0, 2_000_000, 1.0e6), None);
        let reason = impossible_time(0.015, 2_000_000, 1.0e6).unwrap();
        assert_eq!(
            reason,
            "the timestamps give 0.0150 ms, but writing its 2000000 bytes takes 2.0000 ms on this adapter"
        );
    }
}
