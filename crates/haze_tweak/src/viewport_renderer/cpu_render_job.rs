//! Image by the CPU renderer, made on a worker thread as soon as the view stands still.

use std::sync::Arc;

use glam::Vec4;
use haze_core::assets::image::Image;
use haze_core::error::{AssetError, Error};
use haze_demo::shot::Shot;

use crate::platform::clock::{self, Duration, Instant};
use crate::platform::worker::{Ticket, Worker};

/// Time for which the view must not change before rendering begins.
const MIN_STILL_TIME: Duration = Duration::from_millis(250);

/// Image, and the time it took.
type Work = Result<(Image<Vec4>, Duration), Error>;

#[derive(Default)]
pub struct CpuRenderJob {
    worker: Option<Worker<Work>>,
    /// Last requested shot, and when it was first requested.
    wanted: Option<(Shot, Instant)>,
    /// Set while the image is rendered.
    ticket: Option<Ticket>,
    image: Option<Arc<Image<Vec4>>>,
    /// Time that rendering took.
    pub took: Option<Duration>,
}

/// State of the image.
pub enum CpuRenderState {
    /// Nothing to do before this time has passed.
    Later(Duration),
    /// Rendering is in progress; `wake` will be called.
    Soon,
    Ready(Arc<Image<Vec4>>),
    Failed(Error),
}

impl CpuRenderJob {
    /// Returns the image of a shot, or its state. `wake` is called from the worker thread when the image is ready.
    pub fn poll_or_start(&mut self, shot: &Shot, wake: impl Fn() + Send + 'static) -> CpuRenderState {
        let now = clock::now();
        if !self.wanted.as_ref().is_some_and(|(wanted, _)| wanted.has_same_image(shot)) {
            self.wanted = Some((shot.clone(), now));
            self.image = None;
            self.took = None;
            if let Some(ticket) = self.ticket.take() {
                ticket.cancel();
            }
        }
        if let Some(image) = &self.image {
            return CpuRenderState::Ready(image.clone());
        }
        if self.ticket.is_none() {
            let since = self.wanted.as_ref().map_or(now, |(_, since)| *since);
            let left = MIN_STILL_TIME.saturating_sub(now.duration_since(since));
            if left > Duration::ZERO {
                return CpuRenderState::Later(left);
            }
            let worker = match &self.worker {
                Some(worker) => worker,
                None => match Worker::new("reference", wake) {
                    Ok(worker) => self.worker.insert(worker),
                    Err(error) => {
                        return CpuRenderState::Failed(Error::from(AssetError::Io { path: "a thread".into(), error }));
                    }
                },
            };
            let shot = shot.clone();
            self.ticket = Some(worker.submit(move |_| {
                let begun = clock::now();
                shot.render_on_cpu().map(|rendered| (rendered, begun.elapsed()))
            }));
        }
        match self.worker.as_ref().and_then(Worker::poll) {
            None => CpuRenderState::Soon,
            Some(Some(Ok((rendered, took)))) => {
                let image = Arc::new(rendered);
                self.image = Some(image.clone());
                self.took = Some(took);
                CpuRenderState::Ready(image)
            }
            Some(Some(Err(error))) => CpuRenderState::Failed(error),
            Some(None) => CpuRenderState::Failed(Error::Device("the CPU renderer ended".into())),
        }
    }
}
