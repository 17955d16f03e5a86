//! Reads texels back and analyses them on a worker thread, so that no frame waits for them.

use std::sync::Arc;

use eframe::egui::{self, Ui};
use glam::UVec2;
use haze::Error;
use haze_demo::capture::{Capture, ProbeInputs};
use haze_demo::shot::Shot;

use super::survey::RampSurvey;
use super::{Inspect, Told};
use crate::tweak::compare::Side;
use crate::tweak::easel::Easel;
use crate::tweak::platform::clock::Duration;
use crate::tweak::platform::worker::Worker;
use crate::tweak::session::Session;
use crate::tweak::show::Tab;

/// Least time between two copies of a changing image, seconds.
const INTERVAL: f64 = 0.2;

/// Readback and analysis for the inspector and the ramps tab.
pub struct Lens {
    worker: Worker<Result<Answer, Error>>,
    seen: Option<Arc<Seen>>,
    /// Pixel that was last requested, and whether its answer is pending.
    asked: Option<UVec2>,
    is_asking: bool,
    /// Time when the last copy arrived, seconds.
    arrived: f64,
}

/// Image with its texels.
struct Seen {
    side: Side,
    witness: ProbeInputs,
}

/// Result from the worker thread.
enum Answer {
    Seen(Arc<Seen>),
    Told(Told),
    RampSurvey(RampSurvey),
}

impl Lens {
    pub fn new(context: &egui::Context) -> std::io::Result<Self> {
        let context = context.clone();
        let worker = Worker::new("inspector", move || context.request_repaint())?;
        Ok(Self { worker, seen: None, asked: None, is_asking: false, arrived: f64::NEG_INFINITY })
    }

    /// Takes finished results and requests missing ones. Call once a frame.
    pub fn update(&mut self, ui: &Ui, session: &mut Session, easel: &Easel) {
        let has_ramps = session.show.tab == Tab::Ramps;
        if !session.inspect.is_on && !has_ramps {
            easel.want_capture(None);
            easel.forget_capture();
            (self.seen, self.asked) = (None, None);
            (session.inspect.told, session.inspect.survey) = (None, None);
            return;
        }
        if !easel.can_capture() {
            let what = "the inspector does not work on this graphics backend: it cannot read depth back";
            session.messages.complain("inspector", what);
            session.inspect.is_on = false;
            return;
        }
        let now = ui.input(|input| input.time);
        let waits = INTERVAL - (now - self.arrived);
        let side = session.inspect.place().map_or(Side::First, |place| session.compare.side(place.x));
        if let Some((side, shot, capture)) = easel.take_capture() {
            self.arrived = now;
            self.worker.submit(move |_| Ok(Answer::Seen(Arc::new(read(side, shot, &capture)?))));
        } else if easel.is_capturing() {
            ui.ctx().request_repaint();
        }
        easel.want_capture((waits <= 0.0).then_some(side));
        if waits > 0.0 {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(waits.min(INTERVAL)));
        }
        while let Some(answer) = self.worker.poll() {
            self.is_asking &= matches!(answer, Some(Ok(Answer::Seen(_) | Answer::RampSurvey(_))));
            match answer {
                Some(Ok(answer)) => {
                    session.messages.withdraw("inspector");
                    self.take(answer, &mut session.inspect, has_ramps);
                }
                Some(Err(error)) => session.messages.complain("inspector", error),
                None => {}
            }
        }
        self.ask(&session.inspect, side);
    }

    fn take(&mut self, answer: Answer, inspect: &mut Inspect, has_ramps: bool) {
        match answer {
            Answer::Seen(seen) => {
                // The ramps tab shows the first image.
                if has_ramps && seen.side == Side::First {
                    let seen = seen.clone();
                    self.worker.submit(move |_| Ok(Answer::RampSurvey(RampSurvey::of(&seen.witness)?)));
                }
                (self.seen, self.asked) = (Some(seen), None);
            }
            Answer::Told(told) => inspect.told = Some(told),
            Answer::RampSurvey(survey) => inspect.survey = Some(Arc::new(survey)),
        }
    }

    /// Requests the values of the pixel under the pointer, unless they are already known.
    fn ask(&mut self, inspect: &Inspect, side: Side) {
        let Some((seen, place)) = self.seen.as_ref().filter(|seen| seen.side == side).zip(inspect.place()) else {
            return;
        };
        let size = seen.witness.shot().size;
        let at = |share: f32, side: u32| ((share * side as f32) as u32).min(side - 1);
        let pixel = UVec2::new(at(place.x, size.x), at(place.y, size.y));
        // A request waits for the previous answer; otherwise a moving pointer would never get one.
        if self.is_asking || self.asked == Some(pixel) {
            return;
        }
        let seen = seen.clone();
        self.worker.submit(move |_| {
            let probe = seen.witness.probe(&[pixel])?.remove(0);
            let preset = &seen.witness.shot().preset;
            let names = preset.systems.iter().map(|system| system.name.clone()).collect();
            Ok(Answer::Told(Told { pixel, side: seen.side, names, probe, exposure: preset.camera.exposure.exp2() }))
        });
        (self.asked, self.is_asking) = (Some(pixel), true);
    }
}

fn read(side: Side, shot: Shot, capture: &Capture) -> Result<Seen, Error> {
    let none = || Error::Device("the texels of the image could not be read back".into());
    Ok(Seen { side, witness: capture.read().ok_or_else(none)?.with_shot(shot) })
}
