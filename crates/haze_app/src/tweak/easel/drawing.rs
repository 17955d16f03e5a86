//! What is drawn, and when it is drawn again.

use eframe::wgpu;
use glam::{IVec2, UVec2, Vec2};
use haze::settings::ShadeTree;
use haze::{Error, FrameCounts, FrameTimes, Overdraw, PathChoice, Timing};
use haze_demo::apart::Comparison;
use haze_demo::capture::Capture;
use haze_demo::develop::{Developer, Developing, Shown, exposure};
use haze_demo::shot::Shot;
use haze_demo::stage::{StageContext, StageMemory};

use super::canvas::{Canvas, Target, reduced, set_scale};
use super::motion::Motion;
use super::other::{Made, Other};
use crate::tweak::compare::Side;
use crate::tweak::platform::clock::{Duration, Instant};

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
    pub overdraw: Overdraw,
    /// Which paths were taken, where the preset leaves it open.
    pub choices: Vec<PathChoice>,
    pub memory: StageMemory,
    /// What the strip and a second picture hold, bytes.
    pub beside: u64,
    /// Times that the second picture was drawn, and what the smoke of the two took, milliseconds, where that is known.
    pub seconds: u64,
    pub sides: [Option<f32>; 2],
}

/// All that is drawn, and what it takes.
pub struct Drawing {
    pub context: StageContext,
    pub developer: Developer,
    /// The picture, and what it is compared with: drawn here, or made elsewhere.
    pub main: Canvas,
    other: Option<Canvas>,
    made: Option<Made>,
    /// The two, bound together.
    pub pair: Option<Developing>,
    /// All stages, small.
    pub strip: Canvas,
    strip_drawn: Option<Instant>,
    pub motion: Motion,
    /// Of every system of the picture.
    pub texels: Vec<Option<Texels>>,
    /// Something was recorded that has not been painted yet.
    pub is_unpainted: bool,
    /// Texels of a picture are wanted back, and are under way; what they were last taken of.
    pub wants_capture: Option<Side>,
    pub capture: Option<(Side, Shot, Capture)>,
    pub captured: Option<(Side, Shot)>,
    /// The two pictures are wanted back to be compared, are under way, and were, as they are.
    wants_comparison: bool,
    pub comparison: Option<Comparison>,
    is_compared: bool,
    /// What multiplies the light of the two.
    exposures: Vec2,
    /// Times that the picture was drawn, and the second.
    pictures: u64,
    seconds: u64,
    /// There while pictures are measured: the first, and the second while it is drawn here.
    timing: Option<Timing>,
    timing_of_second: Option<Timing>,
    /// Pixels a texel of the accumulation targets that are shown, in place of the preset's.
    pub scale: Option<u32>,
}

/// How often the strip is drawn while something moves.
const STRIP_EVERY: Duration = Duration::from_millis(400);

impl Drawing {
    pub fn new(context: StageContext, developer: Developer) -> Result<Self, Error> {
        let (main, strip) = (Canvas::new(&context)?, Canvas::new(&context)?);
        Ok(Self {
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
            is_unpainted: false,
            wants_capture: None,
            capture: None,
            captured: None,
            wants_comparison: false,
            comparison: None,
            is_compared: false,
            exposures: Vec2::ZERO,
            pictures: 0,
            seconds: 0,
            timing: None,
            timing_of_second: None,
            scale: None,
        })
    }

    pub fn set_context(&mut self, context: StageContext) -> Result<(), Error> {
        let (main, strip) = (Canvas::new(&context)?, Canvas::new(&context)?);
        (self.main, self.strip, self.other, self.pair, self.captured) = (main, strip, None, None, None);
        self.context = context;
        self.main.stage.set_timing(self.timing.as_ref())?;
        Ok(())
    }

    /// What was recorded last was never submitted.
    pub fn forget(&mut self) {
        let canvases = [Some(&mut self.main), self.other.as_mut(), Some(&mut self.strip)];
        canvases.into_iter().flatten().for_each(Canvas::forget);
        (self.capture, self.captured, self.comparison, self.is_compared) = (None, None, None, false);
    }

    pub fn error(&self) -> Option<String> {
        [Some(&self.main), self.other.as_ref(), Some(&self.strip)]
            .into_iter()
            .flatten()
            .find_map(|canvas| canvas.error.clone())
    }

    pub fn measure(&mut self, is_on: bool) {
        if is_on == self.timing.is_some() {
            return;
        }
        self.timing = is_on.then(|| self.context.timing()).flatten();
        // Of the same device.
        let _ = self.main.stage.set_timing(self.timing.as_ref());
        // Made again, and measured.
        self.other = None;
        if is_on {
            self.main.shot = None;
        }
    }

    pub fn figures(&self, is_timed: bool) -> Figures {
        let beside = [Some(&self.strip), self.other.as_ref()].into_iter().flatten();
        let times = self.timing.as_ref().and_then(Timing::latest);
        let of_second = self.timing_of_second.as_ref().and_then(Timing::latest);
        Figures {
            seconds: self.seconds,
            sides: [&times, &of_second].map(|times| times.as_ref().map(FrameTimes::smoke_ms)),
            pictures: self.pictures,
            times,
            is_timed,
            counts: self.main.stage.renderer().counts(),
            overdraw: self.main.stage.renderer().overdraw(),
            choices: self.main.stage.path_choices().collect(),
            memory: self.main.stage.memory_use(),
            beside: beside.map(|canvas| canvas.stage.memory_use().total()).sum(),
        }
    }

    pub fn want_comparison(&mut self, wants: bool) {
        self.wants_comparison = wants;
        self.is_compared &= wants;
    }

    pub fn is_comparing(&self) -> bool {
        self.comparison.is_some() || self.wants_comparison && !self.is_compared && self.second_is_there()
    }

    /// Takes note of the texels of all systems; true if they are others.
    pub fn note_texels(&mut self, systems: usize) -> bool {
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

    pub fn record_exhibit(&mut self, target: &mut Target<'_>, exhibit: &Exhibit) {
        let Exhibit { shot, other, split, difference } = exhibit;
        let divisor = self.motion.pace.divisor();
        let (mut shot, other) = (reduced(shot, divisor), &other.as_ref().map(|other| other.reduced(divisor)));
        self.scale.iter().for_each(|scale| set_scale(&mut shot.preset, *scale));
        let shot = &shot;
        let mut is_new = false;
        if !self.main.shows(shot) {
            is_new = self.main.record(target, shot, &[shot.shade_tree]);
            self.timing.iter().for_each(|timing| timing.resolve(target.encoder));
            self.motion.draw();
            self.pictures += 1;
            self.is_compared = false;
        }
        is_new |= self.record_second(target, other.as_ref());
        self.copy(target.encoder, shot, other.as_ref());
        let Some([first, second]) = self.hung(shot, other.as_ref()) else { return };
        if is_new || self.pair.is_none() {
            self.pair = Some(self.developer.bind(target.device, &first, &second));
        }
        let width = target.place.width_px as f32;
        let shown = Shown {
            exposure: Vec2::new(exposure(shot), other.as_ref().map_or(exposure(shot), Other::exposure)),
            split: if other.is_some() { split * width } else { width },
            difference: if other.is_some() { *difference } else { 0.0 },
            ..target.shown()
        };
        self.pair.iter().for_each(|pair| self.developer.prepare(target.queue, pair, &shown));
        self.is_compared &= shown.exposure == self.exposures;
        self.exposures = shown.exposure;
        let stands_still = !self.motion.is_moving() && self.comparison.is_none() && !self.is_compared;
        if self.wants_comparison && stands_still && self.second_is_there() {
            let depth = self.main.stage.linear_depth();
            let (device, encoder) = (target.device, &mut *target.encoder);
            self.comparison = Comparison::record(device, encoder, [&first, &second], shown.exposure, depth);
            self.is_compared = true;
        }
    }

    /// Copies the texels that are wanted, unless they were. They are those of this frame.
    fn copy(&mut self, encoder: &mut wgpu::CommandEncoder, first: &Shot, other: Option<&Other>) {
        let Some(side) = self.wants_capture.filter(|_| self.capture.is_none()) else { return };
        let (shot, canvas) = match (side, other, &self.other) {
            (Side::First, ..) => (first, &self.main),
            (Side::Second, Some(Other::Shot(shot)), Some(canvas)) => (&**shot, canvas),
            // Made elsewhere: it has none.
            (Side::Second, ..) => return,
        };
        let is_copied = |(of, copied): &(Side, Shot)| {
            *of == side && copied.is_same(shot) && exposure(copied).to_bits() == exposure(shot).to_bits()
        };
        if !self.captured.as_ref().is_some_and(is_copied) {
            self.captured = Some((side, shot.clone()));
            self.capture = canvas.stage.capture(encoder).map(|capture| (side, shot.clone(), capture));
        }
    }

    /// Draws what the picture is compared with, or hangs it up; true if it is another than before.
    fn record_second(&mut self, target: &mut Target<'_>, other: Option<&Other>) -> bool {
        let (drawn, made) = match other {
            Some(Other::Shot(shot)) => (Some(&**shot), None),
            Some(Other::Picture(picture, _)) => (None, Some(picture)),
            None => (None, None),
        };
        let mut is_new = false;
        match drawn {
            Some(shot) => {
                if self.other.is_none() {
                    // As the others, which could be made.
                    self.other = Canvas::new(&self.context).ok();
                    self.timing_of_second = self.timing.as_ref().and_then(|_| self.context.timing());
                    let timing = self.timing_of_second.as_ref();
                    // Of the same device.
                    self.other.iter_mut().for_each(|canvas| drop(canvas.stage.set_timing(timing)));
                }
                if let Some(canvas) = self.other.as_mut().filter(|canvas| !canvas.shows(shot)) {
                    is_new = canvas.record(target, shot, &[shot.shade_tree]);
                    self.timing_of_second.iter().for_each(|timing| timing.resolve(target.encoder));
                    self.seconds += 1;
                    self.is_compared = false;
                }
            }
            None => {
                is_new = self.other.take().is_some();
                self.timing_of_second = None;
            }
        }
        let is_hung = Made::hang(&mut self.made, target, made);
        self.is_compared &= !is_hung;
        is_new || is_hung
    }

    /// The picture, and what it is compared with: itself if there is none.
    fn hung(&self, shot: &Shot, other: Option<&Other>) -> Option<[wgpu::Texture; 2]> {
        let first = self.main.picture(shot.shade_tree)?;
        let drawn = match other {
            Some(Other::Shot(shot)) => self.other.as_ref().and_then(|canvas| canvas.picture(shot.shade_tree)),
            _ => None,
        };
        let second = drawn.or(self.made.as_ref().map(|made| &made.texture));
        Some([first.clone(), second.unwrap_or(first).clone()])
    }

    /// There are two pictures.
    fn second_is_there(&self) -> bool {
        self.other.is_some() || self.made.is_some()
    }

    pub fn record_stage(&mut self, target: &mut Target<'_>, shot: &Shot) {
        let stage = shot.shade_tree;
        // Drawn by the first of them.
        let all = Shot { shade_tree: ShadeTree::Final, ..shot.clone() };
        let may_wait = self.motion.is_moving() && self.strip_drawn.is_some_and(|drawn| drawn.elapsed() < STRIP_EVERY);
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
