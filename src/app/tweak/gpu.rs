//! What draws the pictures of the window, and how egui calls it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use eframe::egui::epaint::ViewportInPixels;
use eframe::egui_wgpu::{CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::{egui, wgpu};
use glam::{IVec2, UVec2, Vec2};
use haze::demo::apart::Comparison;
use haze::demo::capture::Capture;
use haze::demo::develop::{Developer, Developing, Shown, exposure};
use haze::demo::shot::Shot;
use haze::demo::stage::{StageContext, StageMemory};
use haze::settings::ShadeTree;
use haze::{Error, FrameCounts, FrameTimes, Timing};

use super::canvas::{Canvas, Target, reduced, set_scale};
use super::health::Health;
use super::other::{Made, Other};
use super::pace::Pace;
use super::platform::clock::{Duration, Instant};

/// Draws for one window. A clone is the same.
#[derive(Clone)]
pub struct Easel {
    inner: Arc<Mutex<Inner>>,
    adapter: Arc<wgpu::AdapterInfo>,
    health: Health,
    egui: egui::Context,
    /// GPU time can be known.
    is_timed: bool,
}

struct Inner {
    context: StageContext,
    developer: Developer,
    /// The picture, and what it is compared with: drawn here, or made elsewhere.
    main: Canvas,
    other: Option<Canvas>,
    made: Option<Made>,
    /// The two, bound together.
    pair: Option<Developing>,
    /// All stages, small.
    strip: Canvas,
    strip_drawn: Option<Instant>,
    motion: Motion,
    /// Of every system of the picture.
    texels: Vec<Option<Texels>>,
    /// Texels of the picture are wanted back, and are under way; what they were last taken of.
    wants_capture: bool,
    capture: Option<(Shot, Capture)>,
    captured: Option<Shot>,
    /// The two pictures are wanted back to be compared, are under way, and were, as they are.
    wants_comparison: bool,
    comparison: Option<Comparison>,
    is_compared: bool,
    /// Times that the picture was drawn.
    pictures: u64,
    /// There while the picture is measured.
    timing: Option<Timing>,
    /// Pixels a texel of the accumulation targets that are shown, in place of the preset's.
    scale: Option<u32>,
}

/// What drawing the picture took.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// Times that it was drawn.
    pub pictures: u64,
    /// GPU time of the last picture that it is known of.
    pub times: Option<FrameTimes>,
    /// GPU time can be known here.
    pub is_timed: bool,
    pub counts: FrameCounts,
    pub memory: StageMemory,
    /// What the strip and a second picture hold, bytes.
    pub beside: u64,
}

/// How often the strip is drawn while something moves.
const STRIP_EVERY: Duration = Duration::from_millis(400);

/// What is known of frames in which something moves.
#[derive(Default)]
struct Motion {
    pace: Pace,
    is_moving: bool,
    /// When the last frame began, and whether it drew the picture.
    last: Option<Instant>,
    drew: bool,
}

/// What the viewport shows.
#[derive(Clone)]
pub struct Exhibit {
    pub shot: Shot,
    pub other: Option<Other>,
    /// Share of the width from which on the other is shown.
    pub split: f32,
    /// Multiplies the difference of the two; 0: they stand side by side.
    pub difference: f32,
}

/// The texels that a system was accumulated in, and where it was lit: see [`haze::TargetViews`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texels {
    pub origin: IVec2,
    pub size: UVec2,
    pub scale: u32,
    pub lit_depth: f32,
    /// Pixels of the picture.
    pub picture: UVec2,
}

impl Easel {
    /// # Errors
    /// Where there is no device, or it cannot draw what the demo draws.
    pub fn new(window: &eframe::CreationContext<'_>) -> Result<Self, Error> {
        let none = || Error::NoDevice("the window has no graphics device".into());
        let render = window.wgpu_render_state.as_ref().ok_or_else(none)?;
        let health = Health::watch(&render.device, &window.egui_ctx);
        let context = StageContext::new(&render.adapter, &render.device, &render.queue);
        let developer = Developer::new(&render.device, render.target_format);
        let (main, strip) = (Canvas::new(&context)?, Canvas::new(&context)?);
        let inner = Inner {
            context,
            developer,
            main,
            other: None,
            made: None,
            pair: None,
            strip,
            strip_drawn: None,
            motion: Motion::default(),
            texels: Vec::new(),
            wants_capture: false,
            capture: None,
            captured: None,
            wants_comparison: false,
            comparison: None,
            is_compared: false,
            pictures: 0,
            timing: None,
            scale: None,
        };
        let (adapter, egui) = (Arc::new(render.adapter.get_info()), window.egui_ctx.clone());
        let is_timed = render.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        Ok(Self { inner: Arc::new(Mutex::new(inner)), adapter, health, egui, is_timed })
    }

    /// Makes the window draw itself again, from any thread.
    pub fn wake(&self) -> impl Fn() + Send + Sync + 'static {
        let egui = self.egui.clone();
        move || egui.request_repaint()
    }

    /// What the window is drawn with.
    pub fn egui(&self) -> &egui::Context {
        &self.egui
    }

    /// What draws, on one line.
    pub fn adapter(&self) -> String {
        let software = if self.is_software() { ", software" } else { "" };
        format!("{} ({}{software})", self.adapter.name, self.adapter.backend)
    }

    /// True if the CPU draws.
    pub fn is_software(&self) -> bool {
        self.adapter.device_type == wgpu::DeviceType::Cpu
    }

    pub fn health(&self) -> &Health {
        &self.health
    }

    /// To be called at the beginning of a frame. While something moves the picture is drawn as coarsely as it takes to be quick.
    pub fn begin_frame(&self, is_moving: bool) {
        let motion = &mut self.lock().motion;
        let last = motion.last.replace(Instant::now());
        let drew = std::mem::take(&mut motion.drew);
        if !is_moving {
            motion.pace.rest();
        } else if let Some(last) = last.filter(|_| drew && motion.is_moving) {
            motion.pace.update(last.elapsed().as_secs_f32());
        }
        motion.is_moving = is_moving;
    }

    /// As if a frame had taken long.
    #[cfg(test)]
    pub fn be_slow(&self) {
        self.lock().motion.pace.update(1.0);
    }

    /// Pixels of the window that one of the picture stands for, each way.
    pub fn divisor(&self) -> u32 {
        self.lock().motion.pace.divisor()
    }

    /// Shows the picture in a part of the window.
    pub fn show(&self, ui: &egui::Ui, rect: egui::Rect, exhibit: Exhibit) {
        self.add(ui, rect, What::Exhibit(Box::new(exhibit)));
    }

    /// Shows a stage of a shot as small as the part of the window; all stages of one shot are drawn at once.
    pub fn show_stage(&self, ui: &egui::Ui, rect: egui::Rect, shot: Shot) {
        self.add(ui, rect, What::Stage(Box::new(shot)));
    }

    /// What stages are made of: for other shaders to be checked with.
    pub fn context(&self) -> StageContext {
        self.lock().context.clone()
    }

    /// Draws everything with another context of the same device from now on.
    ///
    /// # Errors
    /// As [`Easel::new`]; all is as it was then.
    pub fn set_context(&self, context: StageContext) -> Result<(), Error> {
        let (main, strip) = (Canvas::new(&context)?, Canvas::new(&context)?);
        let inner = &mut *self.lock();
        (inner.main, inner.strip, inner.other, inner.pair, inner.captured) = (main, strip, None, None, None);
        inner.context = context;
        inner.main.stage.set_timing(inner.timing.as_ref())?;
        Ok(())
    }

    /// What is wrong with what is to be seen.
    pub fn error(&self) -> Option<String> {
        let inner = self.lock();
        [Some(&inner.main), inner.other.as_ref(), Some(&inner.strip)]
            .into_iter()
            .flatten()
            .find_map(|canvas| canvas.error.clone())
    }

    /// Measures the picture from now on, or not any more.
    pub fn measure(&self, is_on: bool) {
        let inner = &mut *self.lock();
        if is_on == inner.timing.is_some() || is_on && !self.is_timed {
            return;
        }
        inner.timing = is_on.then(|| inner.context.timing()).flatten();
        // Of the same device.
        let _ = inner.main.stage.set_timing(inner.timing.as_ref());
        if is_on {
            inner.main.shot = None;
        }
    }

    /// Draws the picture again, though it is the same.
    pub fn draw_again(&self) {
        self.lock().main.shot = None;
    }

    /// Shows the smoke through targets of this scale, or of the preset's.
    pub fn show_scale(&self, scale: Option<u32>) {
        self.lock().scale = scale;
    }

    /// What drawing the picture took.
    pub fn figures(&self) -> Figures {
        let inner = &*self.lock();
        let beside = [Some(&inner.strip), inner.other.as_ref()].into_iter().flatten();
        Figures {
            pictures: inner.pictures,
            times: inner.timing.as_ref().and_then(Timing::latest),
            is_timed: self.is_timed,
            counts: inner.main.stage.renderer().counts(),
            memory: inner.main.stage.memory_use(),
            beside: beside.map(|canvas| canvas.stage.memory_use().total()).sum(),
        }
    }

    /// Of every system, how it was in the last picture; `None` where it was out of sight or drawn forward.
    pub fn texels(&self) -> Vec<Option<Texels>> {
        self.lock().texels.clone()
    }

    /// Whether texels can be brought back at all.
    pub fn can_capture(&self) -> bool {
        self.lock().context.can_capture()
    }

    /// Whether texels of the picture are to be brought back when it is another.
    pub fn want_capture(&self, wants: bool) {
        let mut inner = self.lock();
        inner.wants_capture = wants;
    }

    /// Texels of a picture that have arrived.
    pub fn take_capture(&self) -> Option<(Shot, Capture)> {
        self.lock().capture.take_if(|(_, capture)| capture.has_arrived())
    }

    /// Texels are under way.
    pub fn is_capturing(&self) -> bool {
        self.lock().capture.is_some()
    }

    /// The next copy is taken, even of a picture that was copied.
    pub fn forget_capture(&self) {
        self.lock().captured = None;
    }

    /// Whether the two pictures are to be brought back when they stand still.
    pub fn want_comparison(&self, wants: bool) {
        let mut inner = self.lock();
        inner.wants_comparison = wants;
        inner.is_compared &= wants;
    }

    /// Two pictures that have arrived.
    pub fn take_comparison(&self) -> Option<Comparison> {
        self.lock().comparison.take_if(|comparison| comparison.has_arrived())
    }

    /// Two pictures are under way, or will be.
    pub fn is_comparing(&self) -> bool {
        let inner = self.lock();
        inner.comparison.is_some() || inner.wants_comparison && !inner.is_compared && inner.second_is_there()
    }

    fn add(&self, ui: &egui::Ui, rect: egui::Rect, what: What) {
        let callback = Callback { easel: self.clone(), rect, what };
        ui.painter().add(eframe::egui_wgpu::Callback::new_paint_callback(rect, callback));
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// One part of the window on its way through egui.
struct Callback {
    easel: Easel,
    rect: egui::Rect,
    what: What,
}

enum What {
    Exhibit(Box<Exhibit>),
    Stage(Box<Shot>),
}

impl CallbackTrait for Callback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        _: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if self.easel.health.is_lost() {
            return Vec::new();
        }
        let place = ViewportInPixels::from_points(&self.rect, screen.pixels_per_point, screen.size_in_pixels);
        let mut target = Target { device, queue, encoder, place };
        let mut inner = self.easel.lock();
        match &self.what {
            What::Exhibit(exhibit) => inner.record_exhibit(&mut target, exhibit),
            What::Stage(shot) => inner.record_stage(&mut target, shot),
        }
        // The time to the next frame is what this one takes.
        if inner.motion.drew && inner.motion.is_moving {
            self.easel.egui.request_repaint();
        }
        // What is drawn over the picture is as it was in the last one.
        if let What::Exhibit(exhibit) = &self.what
            && inner.measure(exhibit.shot.preset.systems.len())
        {
            self.easel.egui.request_repaint();
        }
        Vec::new()
    }

    fn paint(&self, info: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        let place = info.viewport_in_pixels();
        if place.width_px <= 0 || place.height_px <= 0 {
            return;
        }
        let inner = self.easel.lock();
        let developing = match &self.what {
            What::Exhibit(_) => inner.pair.as_ref(),
            What::Stage(shot) => inner.strip.developing[shot.shade_tree as usize].as_ref(),
        };
        if let Some(developing) = developing {
            inner.developer.record(pass, developing);
        }
    }
}

impl Inner {
    /// Takes note of the texels of all systems; true if they are others.
    fn measure(&mut self, systems: usize) -> bool {
        let renderer = self.main.stage.renderer();
        let picture = self.main.shot.as_ref().map_or(UVec2::ONE, |shot| shot.size);
        let of = |key| {
            renderer.targets(key).map(|targets| Texels {
                origin: targets.origin,
                size: targets.size,
                scale: targets.scale,
                lit_depth: targets.lit_depth,
                picture,
            })
        };
        let texels = (0..systems as u64).map(of).collect();
        let before = std::mem::replace(&mut self.texels, texels);
        before != self.texels
    }

    fn record_exhibit(&mut self, target: &mut Target<'_>, exhibit: &Exhibit) {
        let Exhibit { shot, other, split, difference } = exhibit;
        let divisor = self.motion.pace.divisor();
        let (mut shot, other) = (reduced(shot, divisor), &other.as_ref().map(|other| other.reduced(divisor)));
        self.scale.iter().for_each(|scale| set_scale(&mut shot.preset, *scale));
        let shot = &shot;
        let mut is_new = false;
        if !self.main.shows(shot) {
            is_new = self.main.record(target, shot, &[shot.shade_tree]);
            self.timing.iter().for_each(|timing| timing.resolve(target.encoder));
            self.motion.drew = true;
            self.pictures += 1;
            self.is_compared = false;
        }
        let is_new_shot = || self.captured.as_ref().is_none_or(|captured| !captured.is_same(shot));
        if self.wants_capture && self.capture.is_none() && is_new_shot() {
            self.captured = Some(shot.clone());
            self.capture = self.main.stage.capture(target.encoder).map(|capture| (shot.clone(), capture));
        }
        let (drawn, made) = match other {
            Some(Other::Shot(shot)) => (Some(&**shot), None),
            Some(Other::Picture(picture, _)) => (None, Some(picture)),
            None => (None, None),
        };
        match drawn {
            Some(other) => {
                if self.other.is_none() {
                    // As the others, which could be made.
                    self.other = Canvas::new(&self.context).ok();
                }
                if let Some(canvas) = &mut self.other {
                    self.is_compared &= canvas.shows(other);
                    is_new |= canvas.record(target, other, &[other.shade_tree]);
                }
            }
            None => is_new |= self.other.take().is_some(),
        }
        let is_hung = Made::hang(&mut self.made, target, made);
        self.is_compared &= !is_hung;
        is_new |= is_hung;
        let first = self.main.picture(shot.shade_tree);
        let second = self.other.as_ref().zip(drawn).and_then(|(canvas, other)| canvas.picture(other.shade_tree));
        let second = second.or(self.made.as_ref().map(|made| &made.texture)).or(first);
        if let Some((first, second)) = first.zip(second).filter(|_| is_new || self.pair.is_none()) {
            self.pair = Some(self.developer.bind(target.device, first, second));
        }
        if let Some(pair) = &self.pair {
            let width = target.place.width_px as f32;
            let shown = Shown {
                exposure: Vec2::new(exposure(shot), other.as_ref().map_or(exposure(shot), Other::exposure)),
                split: if other.is_some() { split * width } else { width },
                difference: if other.is_some() { *difference } else { 0.0 },
                ..target.shown()
            };
            self.developer.prepare(target.queue, pair, &shown);
            let stands_still = !self.motion.is_moving && self.comparison.is_none() && !self.is_compared;
            if let Some((first, second)) = first.zip(second)
                && self.wants_comparison
                && stands_still
                && self.second_is_there()
            {
                let depth = self.main.stage.linear_depth();
                let (device, encoder) = (target.device, &mut *target.encoder);
                self.comparison = Comparison::record(device, encoder, [first, second], shown.exposure, depth);
                self.is_compared = true;
            }
        }
    }

    /// There are two pictures.
    fn second_is_there(&self) -> bool {
        self.other.is_some() || self.made.is_some()
    }

    fn record_stage(&mut self, target: &mut Target<'_>, shot: &Shot) {
        let stage = shot.shade_tree;
        // Drawn by the first of them.
        let all = Shot { shade_tree: ShadeTree::Final, ..shot.clone() };
        let may_wait = self.motion.is_moving && self.strip_drawn.is_some_and(|drawn| drawn.elapsed() < STRIP_EVERY);
        if !may_wait && !self.strip.shows(&all) {
            self.strip_drawn = Some(Instant::now());
            if self.strip.record(target, &all, ShadeTree::ALL) {
                self.strip.developing = Default::default();
            }
        }
        let Some(picture) = self.strip.stage.picture(stage) else { return };
        let developing = self.strip.developing[stage as usize]
            .get_or_insert_with(|| self.developer.bind(target.device, picture, picture));
        let shown = Shown { exposure: Vec2::splat(exposure(shot)), ..target.shown() };
        self.developer.prepare(target.queue, developing, &shown);
    }
}
