//! Reads texels back and analyses them on a worker thread, so that no frame waits for them.

use std::sync::Arc;

use eframe::egui::{self, Ui};
use glam::UVec2;
use haze_core::error::Error;
use haze_core::formula::tonemap::DisplayTransform;
use haze_demo::capture::{Capture, ProbeInputs};
use haze_demo::shot::Shot;

use crate::platform::clock::Duration;
use crate::platform::worker::Worker;
use crate::session::Session;
use crate::session::inspection::{Inspection, PixelValues};
use crate::session::ramp_survey::RampSurvey;
use crate::session::view_options::Tab;
use crate::viewport_renderer::ViewportRenderer;
use crate::viewport_renderer::compared_side::ComparedSide;

/// Least time between two copies of a changing image, seconds.
const MIN_COPY_INTERVAL: f64 = 0.2;

/// Readback and analysis for the inspector and the ramps tab.
pub struct ProbeJob {
    worker: Worker<Result<Answer, Error>>,
    captured: Option<Arc<CapturedImage>>,
    /// Pixel that was last requested, and whether its answer is pending.
    requested: Option<UVec2>,
    is_pending: bool,
    /// Time when the last copy arrived, seconds.
    arrived: f64,
}

/// Image with its texels.
struct CapturedImage {
    side: ComparedSide,
    inputs: ProbeInputs,
}

/// Result from the worker thread.
enum Answer {
    CapturedImage(Arc<CapturedImage>),
    PixelValues(PixelValues),
    RampSurvey(RampSurvey),
}

impl ProbeJob {
    pub fn new(context: &egui::Context) -> std::io::Result<Self> {
        let context = context.clone();
        let worker = Worker::new("inspector", move || context.request_repaint())?;
        Ok(Self { worker, captured: None, requested: None, is_pending: false, arrived: f64::NEG_INFINITY })
    }

    /// Takes finished results and requests missing ones. Call once a frame.
    pub fn update(&mut self, ui: &Ui, session: &mut Session, renderer: &ViewportRenderer) {
        let has_ramps = session.view.tab == Tab::Ramps;
        if !session.inspect.is_on && !has_ramps {
            renderer.want_capture(None);
            renderer.forget_capture();
            // An answer from before would be shown for the pixel that is inspected next.
            self.worker.cancel_all();
            self.is_pending = false;
            self.captured = None;
            self.requested = None;
            session.inspect.pixel_values = None;
            session.inspect.survey = None;
            return;
        }
        if !renderer.can_capture() {
            let what = "the inspector does not work on this graphics backend: it cannot read depth back";
            session.messages.error("inspector", what);
            session.inspect.is_on = false;
            return;
        }
        let now = ui.input(|input| input.time);
        let waits = MIN_COPY_INTERVAL - (now - self.arrived);
        let side = session.inspect.position().map_or(ComparedSide::First, |position| session.compare.side(position.x));
        if let Some((side, shot, capture)) = renderer.take_capture() {
            self.arrived = now;
            self.worker.submit(move |_| Ok(Answer::CapturedImage(Arc::new(read(side, shot, &capture)?))));
        } else if renderer.is_capturing() {
            ui.ctx().request_repaint();
        }
        renderer.want_capture((waits <= 0.0).then_some(side));
        if waits > 0.0 {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(waits.min(MIN_COPY_INTERVAL)));
        }
        while let Some(answer) = self.worker.poll() {
            self.is_pending &= matches!(answer, Some(Ok(Answer::CapturedImage(_) | Answer::RampSurvey(_))));
            match answer {
                Some(Ok(answer)) => {
                    session.messages.clear("inspector");
                    self.take(answer, &mut session.inspect, has_ramps);
                }
                Some(Err(error)) => session.messages.error("inspector", error),
                None => {}
            }
        }
        self.ask(&session.inspect, side);
    }

    fn take(&mut self, answer: Answer, inspect: &mut Inspection, has_ramps: bool) {
        match answer {
            Answer::CapturedImage(captured) => {
                // The ramps tab shows the first image.
                if has_ramps && captured.side == ComparedSide::First {
                    let captured = captured.clone();
                    self.worker.submit(move |_| Ok(Answer::RampSurvey(RampSurvey::of(&captured.inputs)?)));
                }
                self.captured = Some(captured);
                self.requested = None;
            }
            Answer::PixelValues(values) => inspect.pixel_values = Some(values),
            Answer::RampSurvey(survey) => inspect.survey = Some(Arc::new(survey)),
        }
    }

    /// Requests the values of the pixel under the pointer, unless they are already known.
    fn ask(&mut self, inspect: &Inspection, side: ComparedSide) {
        let Some((captured, position)) =
            self.captured.as_ref().filter(|captured| captured.side == side).zip(inspect.position())
        else {
            return;
        };
        let size = captured.inputs.shot().size;
        let at = |fraction: f32, side: u32| ((fraction * side as f32) as u32).min(side - 1);
        let pixel = UVec2::new(at(position.x, size.x), at(position.y, size.y));
        // A request waits for the previous answer; otherwise a moving pointer would never get one.
        if self.is_pending || self.requested == Some(pixel) {
            return;
        }
        let captured = captured.clone();
        self.worker.submit(move |_| {
            let probe = captured.inputs.probe(&[pixel])?.remove(0);
            let preset = &captured.inputs.shot().preset;
            let camera = preset.camera;
            let names = preset.systems.iter().map(|system| system.name.clone()).collect();
            Ok(Answer::PixelValues(PixelValues {
                pixel,
                side: captured.side,
                names,
                probe,
                front_fraction: captured.inputs.front_fraction(pixel),
                transform: DisplayTransform { exposure: camera.exposure.exp2(), tonemap: camera.tonemap },
            }))
        });
        self.requested = Some(pixel);
        self.is_pending = true;
    }
}

fn read(side: ComparedSide, shot: Shot, capture: &Capture) -> Result<CapturedImage, Error> {
    let none = || Error::Device("the texels of the image could not be read back".into());
    Ok(CapturedImage { side, inputs: capture.read().ok_or_else(none)?.with_shot(shot) })
}
