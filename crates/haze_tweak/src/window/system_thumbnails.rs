//! Thumbnails of the systems of a preset, each alone, rendered one at a time in pauses of the user.

use eframe::egui::{self, ColorImage, TextureHandle, TextureOptions};
use glam::UVec2;
use haze_core::error::Error;
use haze_core::settings::DebugView;
use haze_demo::shot::Shot;
use haze_demo::tonemap_pass::tonemap;
use haze_preset::{Camera, SceneName};
use image::RgbImage;

use crate::platform::idle_timer::IdleTimer;
use crate::platform::render_job;
use crate::platform::worker::{Ticket, Worker};
use crate::session::Session;
use crate::session::smoke_geometry::SmokeGeometry;
use crate::viewport::camera_moves::frame;

/// Size of a thumbnail, pixels: twice that of the list, in points.
const SIZE: UVec2 = UVec2::new(72, 48);

/// Factor of the distance at which all smoke is in view: few particles get to the edges of its box, and they are thin there.
const CLOSER: f32 = 0.75;

/// Thumbnails of the systems.
#[derive(Default)]
pub struct SystemThumbnails {
    worker: Option<Worker<(usize, Option<RgbImage>)>>,
    /// Smoke of the thumbnails; see [`smoke_under_the_sky`].
    smoke: Option<Shot>,
    thumbnails: Vec<Thumbnail>,
    ticket: Option<Ticket>,
}

struct Thumbnail {
    /// The system alone.
    smoke: Shot,
    /// Image as last rendered, which may be of earlier settings.
    image: Option<TextureHandle>,
    progress: Progress,
}

#[derive(Clone, Copy, PartialEq)]
enum Progress {
    Due,
    Requested,
    Done,
}

impl SystemThumbnails {
    /// Takes what was rendered, and requests the next thumbnail in a pause of the user. `session.view` gets the images.
    pub fn advance(&mut self, context: &egui::Context, session: &mut Session, idle: IdleTimer) {
        while let Some(Some((index, image))) = self.worker.as_ref().and_then(Worker::poll) {
            if let Some((thumbnail, image)) = self.thumbnails.get_mut(index).zip(image) {
                let image = ColorImage::from_rgb([SIZE.x as usize, SIZE.y as usize], &image);
                thumbnail.image = Some(context.load_texture("system", image, TextureOptions::LINEAR));
                thumbnail.progress = Progress::Done;
            }
        }
        let smoke = smoke_under_the_sky(session);
        let is_same = self.smoke.as_ref().is_some_and(|known| known.has_same_image(&smoke));
        let is_busy = self.worker.as_ref().is_some_and(Worker::is_busy);
        let next = self.thumbnails.iter().position(|thumbnail| thumbnail.progress == Progress::Due);
        let next = next.filter(|_| !is_busy);
        if (!is_same || next.is_some()) && idle.is_idle(context) {
            if !is_same {
                self.follow(smoke);
            } else if let Some(index) = next {
                self.request(context, session, index);
            }
            context.request_repaint();
        }
        let images = self.thumbnails.iter().map(|thumbnail| thumbnail.image.as_ref().map(TextureHandle::id));
        session.view.systems.images.clear();
        session.view.systems.images.extend(images);
    }

    /// Keeps the thumbnails of the systems that are as they were.
    fn follow(&mut self, smoke: Shot) {
        self.ticket.take().iter().for_each(Ticket::cancel);
        let mut known = std::mem::take(&mut self.thumbnails);
        for index in 0..smoke.preset.systems.len() {
            let mut alone = smoke.clone();
            alone.keep_only_system(index);
            let is_done = |other: &Thumbnail| other.progress == Progress::Done && other.smoke.has_same_image(&alone);
            if let Some(same) = known.iter().position(is_done) {
                self.thumbnails.push(known.swap_remove(same));
                continue;
            }
            // The image of earlier settings stays until the new one is there.
            let name = |shot: &Shot| shot.preset.systems.first().map(|system| system.name.clone());
            let earlier = known.iter().find(|other| name(&other.smoke) == name(&alone));
            let image = earlier.and_then(|earlier| earlier.image.clone());
            self.thumbnails.push(Thumbnail { smoke: alone, image, progress: Progress::Due });
        }
        self.smoke = Some(smoke);
    }

    fn request(&mut self, context: &egui::Context, session: &Session, index: usize) {
        let Some(thumbnail) = self.thumbnails.get_mut(index) else { return };
        thumbnail.progress = Progress::Requested;
        let mut shot = thumbnail.smoke.clone();
        shot.preset.camera = session.document.preset.camera;
        let mut geometry = SmokeGeometry::default();
        let bounds = geometry.at(&shot.preset, shot.caches.clone(), shot.preset.time).bounds();
        let camera = &mut shot.preset.camera;
        frame(camera, &bounds, SIZE.x as f32 / SIZE.y as f32);
        camera.position = camera.target.lerp(camera.position, CLOSER);
        if self.worker.is_none() {
            let context = context.clone();
            // Without a thread, only names are shown.
            self.worker = Worker::new("haze systems", move || context.request_repaint()).ok();
        }
        self.ticket = self.worker.as_ref().map(|worker| {
            worker.submit_async(async move |_: Ticket| {
                let image = draw(&shot).await;
                (index, image.ok())
            })
        });
    }
}

/// Returns the smoke as the preset begins, under the sky alone, without what only changes the view of it: orbits and playback
/// renew nothing.
fn smoke_under_the_sky(session: &Session) -> Shot {
    let mut smoke = session.animated_shot(SIZE);
    let usual = Camera::default();
    smoke.preset.time = session.document.preset.time;
    smoke.preset.camera =
        Camera { position: usual.position, target: usual.target, fov: usual.fov, ..smoke.preset.camera };
    smoke.debug_view = DebugView::Final;
    smoke.preset.environment.scene = SceneName::Empty;
    smoke.backdrop.scene = None;
    smoke
}

async fn draw(shot: &Shot) -> Result<RgbImage, Error> {
    Ok(tonemap(&render_job::open_thumbnail_backend()?.render_async(shot).await?, shot))
}
