//! Images of the window, and when each is drawn again.

use eframe::wgpu;
use glam::{IVec2, UVec2};
use haze::{FrameCounts, LightingChoice, Overdraw, PathChoice, ScaleChoice, Timing};
use haze_core::error::Error;
use haze_core::formula::tonemap::DisplayTransform;
use haze_core::settings::DebugView;
use haze_demo::capture::Capture;
use haze_demo::image_metrics::Comparison;
use haze_demo::offscreen_renderer::{OffscreenContext, OffscreenMemory};
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::{TonemapBindGroup, TonemapPass, TonemapUniform, display_transform};

use super::cached_render::{CachedRender, Target, reduced, set_scale};
use super::compared_side::ComparedSide;
use super::comparison_image::{ComparisonImage, UploadedImage};
use super::motion::MotionTimer;
use super::smoke_times::{SmokeTimes, TimeSource};
use super::stage_queue::StageQueue;
use crate::platform::clock::{self, Duration, Instant};

/// Content of the viewport.
#[derive(Clone)]
pub struct ViewportFrame {
    pub shot: Shot,
    pub other: Option<ComparisonImage>,
    /// Fraction of the width at which the second image begins, 0 to 1.
    pub split: f32,
    /// Factor on the difference of the two images; 0 shows the two side by side.
    pub difference: f32,
}

/// Texels that a system was accumulated in, and the depth at which it was lit. See [`haze::TargetViews`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetTexels {
    pub origin: IVec2,
    pub size: UVec2,
    pub scale: u32,
    pub lit_depth: f32,
    /// Size of the image in pixels.
    pub image: UVec2,
}

/// Cost of drawing the image.
#[derive(Clone, Debug, Default)]
pub struct RenderStats {
    /// Number of times that it was drawn.
    pub renders: u64,
    /// Times of the last image for which they are known.
    pub times: Option<SmokeTimes>,
    pub time_source: TimeSource,
    pub counts: FrameCounts,
    pub overdraw: Overdraw,
    /// Paths that were chosen where the preset leaves it open.
    pub choices: Vec<PathChoice>,
    /// Lighting resolutions that were chosen where the preset leaves it open.
    pub lighting_choices: Vec<LightingChoice>,
    /// Scales that were chosen where the preset leaves it open.
    pub scale_choices: Vec<ScaleChoice>,
    pub memory: OffscreenMemory,
    /// Memory of the strip and the second image, bytes.
    pub other_memory: u64,
    /// Number of times that the second image was drawn, and the smoke time of both images in milliseconds, where it is
    /// known.
    pub comparison_renders: u64,
    pub smoke_ms_of_pair: [Option<f32>; 2],
}

/// State of all images, behind a lock.
pub struct RendererState {
    pub context: OffscreenContext,
    pub tonemap_pass: TonemapPass,
    /// The image, and the second one: drawn here, or uploaded.
    pub main: CachedRender,
    other: Option<CachedRender>,
    uploaded: Option<UploadedImage>,
    /// Bindings of the two images.
    pub pair: Option<TonemapBindGroup>,
    /// All debug views, small.
    pub strip: CachedRender,
    strip_drawn: Option<Instant>,
    /// Set where stages of the strip are drawn one by one.
    pub stages: Option<StageQueue>,
    pub motion: MotionTimer,
    /// Texels of every system of the image.
    pub texels: Vec<Option<TargetTexels>>,
    /// Commands were recorded that have not been painted yet.
    pub has_unpainted_commands: bool,
    /// Readback of texels: the image that is requested, the readback in progress, and the image last read.
    pub wants_capture: Option<ComparedSide>,
    pub capture: Option<(ComparedSide, Shot, Capture)>,
    pub captured: Option<(ComparedSide, Shot)>,
    /// Readback of both images for the PSNR: requested, in progress, and done for the present images.
    wants_comparison: bool,
    pub comparison: Option<Comparison>,
    is_compared: bool,
    /// Exposure factors of the two images.
    transforms: [DisplayTransform; 2],
    /// Number of times that the image and the second one were drawn.
    renders: u64,
    comparison_renders: u64,
    /// Set while images are measured.
    time_source: Option<TimeSource>,
    /// Timestamps of the first image, and of the second if it is drawn here.
    timing: Option<Timing>,
    timing_of_second: Option<Timing>,
    /// Overrides the preset's accumulation scale, pixels per texel.
    pub scale: Option<u32>,
}

/// Interval of drawing the strip while something moves.
const MIN_STRIP_INTERVAL: Duration = Duration::from_millis(400);

impl RendererState {
    pub fn new(context: OffscreenContext, tonemap_pass: TonemapPass) -> Result<Self, Error> {
        let main = CachedRender::new(&context)?;
        let strip = CachedRender::new(&context)?;
        Ok(Self {
            context,
            tonemap_pass,
            main,
            other: None,
            uploaded: None,
            pair: None,
            strip,
            strip_drawn: None,
            stages: None,
            motion: MotionTimer::default(),
            texels: Vec::new(),
            has_unpainted_commands: false,
            wants_capture: None,
            capture: None,
            captured: None,
            wants_comparison: false,
            comparison: None,
            is_compared: false,
            transforms: [DisplayTransform::DATA; 2],
            renders: 0,
            comparison_renders: 0,
            time_source: None,
            timing: None,
            timing_of_second: None,
            scale: None,
        })
    }

    pub fn replace_context(&mut self, context: OffscreenContext) -> Result<(), Error> {
        let main = CachedRender::new(&context)?;
        let strip = CachedRender::new(&context)?;
        self.main = main;
        self.strip = strip;
        self.other = None;
        self.pair = None;
        self.captured = None;
        self.context = context;
        self.main.is_wall_timed = self.is_wall_timed();
        self.main.offscreen.set_timing(self.timing.as_ref())?;
        Ok(())
    }

    /// Call if the commands that were recorded last were never submitted.
    pub fn forget(&mut self) {
        let all = [Some(&mut self.main), self.other.as_mut(), Some(&mut self.strip)];
        all.into_iter().flatten().for_each(CachedRender::forget);
        self.capture = None;
        self.captured = None;
        self.comparison = None;
        self.is_compared = false;
    }

    pub fn error(&self) -> Option<String> {
        [Some(&self.main), self.other.as_ref(), Some(&self.strip)]
            .into_iter()
            .flatten()
            .find_map(|cached| cached.error.clone())
    }

    /// Measures images from a source, or no longer.
    pub fn measure(&mut self, time_source: Option<TimeSource>) {
        if time_source == self.time_source {
            return;
        }
        self.time_source = time_source;
        self.timing = if time_source == Some(TimeSource::Timestamps) { self.context.timing() } else { None };
        self.main.is_wall_timed = self.is_wall_timed();
        // Cannot fail: both are of the same device.
        let _ = self.main.offscreen.set_timing(self.timing.as_ref());
        // It is created again, with measurement.
        self.other = None;
        if time_source.is_some() {
            self.main.shot = None;
        }
    }

    fn is_wall_timed(&self) -> bool {
        self.time_source == Some(TimeSource::WallTime)
    }

    pub fn render_stats(&self, time_source: TimeSource) -> RenderStats {
        let others = [Some(&self.strip), self.other.as_ref()].into_iter().flatten();
        let times = SmokeTimes::latest(&self.main, self.renders, self.timing.as_ref());
        let other = self.other.as_ref();
        let of_second =
            other.and_then(|other| SmokeTimes::latest(other, self.comparison_renders, self.timing_of_second.as_ref()));
        RenderStats {
            comparison_renders: self.comparison_renders,
            smoke_ms_of_pair: [&times, &of_second].map(|times| times.as_ref().map(SmokeTimes::sum_ms)),
            renders: self.renders,
            times,
            time_source,
            counts: self.main.offscreen.renderer().counts(),
            overdraw: self.main.offscreen.renderer().overdraw(),
            choices: self.main.offscreen.path_choices().collect(),
            lighting_choices: self.main.offscreen.lighting_choices().collect(),
            scale_choices: self.main.offscreen.scale_choices().collect(),
            memory: self.main.offscreen.memory_use(),
            other_memory: others.map(|cached| cached.offscreen.memory_use().total()).sum(),
        }
    }

    pub fn want_comparison(&mut self, wants: bool) {
        self.wants_comparison = wants;
        self.is_compared &= wants;
    }

    pub fn is_comparing(&self) -> bool {
        self.comparison.is_some() || self.wants_comparison && !self.is_compared && self.second_is_there()
    }

    /// Records the texels of all systems. Returns true if they have changed.
    pub fn update_target_texels(&mut self, systems: usize) -> bool {
        let renderer = self.main.offscreen.renderer();
        let image = self.main.shot.as_ref().map_or(UVec2::ONE, |shot| shot.size);
        let of = |key| {
            renderer.targets(key).map(|targets| TargetTexels {
                origin: targets.origin,
                size: targets.size,
                scale: targets.scale,
                lit_depth: targets.lit_depth,
                image,
            })
        };
        let texels = (0..systems as u64).map(of).collect();
        let before = std::mem::replace(&mut self.texels, texels);
        before != self.texels
    }

    pub fn record_viewport(&mut self, target: &mut Target<'_>, frame: &ViewportFrame) {
        let ViewportFrame { shot, other, split, difference } = frame;
        let divisor = self.motion.resolution.divisor();
        let mut shot = reduced(shot, divisor);
        let other = &other.as_ref().map(|other| other.reduced(divisor));
        if let Some(scale) = self.scale {
            set_scale(&mut shot.preset, scale);
        }
        let shot = &shot;
        let mut is_new = false;
        if !self.main.shows(shot) {
            is_new = self.main.record(target, shot, &[shot.debug_view]);
            if let Some(timing) = &self.timing {
                timing.resolve(target.encoder);
            }
            self.motion.draw();
            self.renders += 1;
            self.is_compared = false;
        }
        is_new |= self.record_comparison(target, other.as_ref());
        self.copy(target.encoder, shot, other.as_ref());
        let Some([first, second]) = self.image_pair(shot, other.as_ref()) else { return };
        if is_new || self.pair.is_none() {
            self.pair = Some(self.tonemap_pass.bind(target.device, &first, &second));
        }
        let width = target.viewport.width_px as f32;
        let transform = display_transform(shot);
        let transforms = [transform, other.as_ref().map_or(transform, ComparisonImage::transform)];
        let shown = TonemapUniform {
            split: if other.is_some() { split * width } else { width },
            difference: if other.is_some() { *difference } else { 0.0 },
            ..target.shown().with_transforms(transforms)
        };
        if let Some(pair) = &self.pair {
            self.tonemap_pass.prepare(target.queue, pair, &shown);
        }
        self.is_compared &= transforms == self.transforms;
        self.transforms = transforms;
        let stands_still = !self.motion.is_moving() && self.comparison.is_none() && !self.is_compared;
        if self.wants_comparison && stands_still && self.second_is_there() {
            let depth = self.main.offscreen.linear_depth();
            let device = target.device;
            let encoder = &mut *target.encoder;
            self.comparison = Comparison::record(device, encoder, [&first, &second], transforms, depth);
            self.is_compared = true;
        }
    }

    /// Copies the requested texels of this frame, unless they were already copied.
    fn copy(&mut self, encoder: &mut wgpu::CommandEncoder, first: &Shot, other: Option<&ComparisonImage>) {
        let Some(side) = self.wants_capture.filter(|_| self.capture.is_none()) else { return };
        let (shot, cached) = match (side, other, &self.other) {
            (ComparedSide::First, ..) => (first, &self.main),
            (ComparedSide::Second, Some(ComparisonImage::Shot(shot)), Some(cached)) => (&**shot, cached),
            // An uploaded image has no texels.
            (ComparedSide::Second, ..) => return,
        };
        let is_copied = |(of, copied): &(ComparedSide, Shot)| {
            *of == side && copied.has_same_image(shot) && display_transform(copied) == display_transform(shot)
        };
        if !self.captured.as_ref().is_some_and(is_copied) {
            self.captured = Some((side, shot.clone()));
            self.capture = cached.offscreen.capture(encoder).map(|capture| (side, shot.clone(), capture));
        }
    }

    /// Draws or uploads the second image. Returns true if its texture may have been replaced.
    fn record_comparison(&mut self, target: &mut Target<'_>, other: Option<&ComparisonImage>) -> bool {
        let (drawn, uploaded) = match other {
            Some(ComparisonImage::Shot(shot)) => (Some(&**shot), None),
            Some(ComparisonImage::Image(image, _)) => (None, Some(image)),
            None => (None, None),
        };
        let mut is_new = false;
        match drawn {
            Some(shot) => {
                let is_wall_timed = self.is_wall_timed();
                if self.other.is_none() {
                    // Like the other renders, which could be created.
                    self.other = CachedRender::new(&self.context).ok();
                    self.timing_of_second = self.timing.as_ref().and_then(|_| self.context.timing());
                    let timing = self.timing_of_second.as_ref();
                    if let Some(cached) = &mut self.other {
                        cached.is_wall_timed = is_wall_timed;
                        // Cannot fail: both are of the same device.
                        let _ = cached.offscreen.set_timing(timing);
                    }
                }
                if let Some(cached) = self.other.as_mut().filter(|cached| !cached.shows(shot)) {
                    is_new = cached.record(target, shot, &[shot.debug_view]);
                    if let Some(timing) = &self.timing_of_second {
                        timing.resolve(target.encoder);
                    }
                    self.comparison_renders += 1;
                    self.is_compared = false;
                }
            }
            None => {
                is_new = self.other.take().is_some();
                self.timing_of_second = None;
            }
        }
        let is_replaced = UploadedImage::sync_upload(&mut self.uploaded, target, uploaded);
        self.is_compared &= !is_replaced;
        is_new || is_replaced
    }

    /// Returns the image and the second one; the image twice if there is no second.
    fn image_pair(&self, shot: &Shot, other: Option<&ComparisonImage>) -> Option<[wgpu::Texture; 2]> {
        let first = self.main.image(shot.debug_view)?;
        let drawn = match other {
            Some(ComparisonImage::Shot(shot)) => self.other.as_ref().and_then(|cached| cached.image(shot.debug_view)),
            _ => None,
        };
        let second = drawn.or(self.uploaded.as_ref().map(|uploaded| &uploaded.texture));
        Some([first.clone(), second.unwrap_or(first).clone()])
    }

    /// Returns true if there is a second image.
    fn second_is_there(&self) -> bool {
        self.other.is_some() || self.uploaded.is_some()
    }

    pub fn record_debug_view(&mut self, target: &mut Target<'_>, shot: &Shot) {
        let view = shot.debug_view;
        let all = Shot { debug_view: DebugView::Final, ..shot.clone() };
        let is_moving = self.motion.is_moving();
        let may_wait = is_moving && self.strip_drawn.is_some_and(|drawn| drawn.elapsed() < MIN_STRIP_INTERVAL);
        let is_new = match &mut self.stages {
            Some(stages) => {
                // While something moves, a round of all stages is finished before the next.
                if !self.strip.shows(&all) && (stages.is_empty() || !is_moving) {
                    stages.restart();
                }
                let is_drawn = !may_wait && stages.take(view);
                if is_drawn {
                    self.strip_drawn = Some(clock::now());
                }
                is_drawn && self.strip.record_view(target, &all, view)
            }
            None => {
                if !may_wait && !self.strip.shows(&all) {
                    self.strip_drawn = Some(clock::now());
                }
                // The first view that is requested draws all.
                !may_wait && self.strip.record(target, &all, DebugView::ALL)
            }
        };
        if is_new {
            self.strip.tonemap_bindings = Default::default();
        }
        let Some(image) = self.strip.offscreen.image(view) else { return };
        let tonemap_bindings = self.strip.tonemap_bindings[view as usize]
            .get_or_insert_with(|| self.tonemap_pass.bind(target.device, image, image));
        let shown = target.shown().with_transforms([display_transform(shot); 2]);
        self.tonemap_pass.prepare(target.queue, tonemap_bindings, &shown);
    }
}
