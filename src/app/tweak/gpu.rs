//! What draws the pictures of the window, and how egui calls it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use eframe::egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use eframe::{egui, wgpu};
use glam::Vec2;
use haze::Error;
use haze::demo::develop::{Developer, Developing, Shown, exposure};
use haze::demo::shot::Shot;
use haze::demo::stage::{Stage, StageContext};

/// Draws for one window. A clone is the same.
#[derive(Clone)]
pub struct Easel(Arc<Mutex<Inner>>);

struct Inner {
    developer: Developer,
    /// The viewport's picture.
    main: Canvas,
    /// The first mistake since it was last asked for.
    error: Option<Error>,
}

/// A stage, and what it shows.
struct Canvas {
    stage: Stage,
    /// What was drawn last.
    shot: Option<Shot>,
    developing: Option<Developing>,
}

impl Easel {
    /// # Errors
    /// Where the device cannot draw what the demo draws.
    pub fn new(render: &RenderState) -> Result<Self, Error> {
        let context = StageContext::new(&render.adapter, &render.device, &render.queue);
        let developer = Developer::new(&render.device, render.target_format);
        let main = Canvas::new(&context)?;
        Ok(Self(Arc::new(Mutex::new(Inner { developer, main, error: None }))))
    }

    /// Shows a shot in a part of the window.
    pub fn show(&self, ui: &egui::Ui, rect: egui::Rect, shot: Shot) {
        let callback = Callback { easel: self.clone(), rect, shot };
        ui.painter().add(eframe::egui_wgpu::Callback::new_paint_callback(rect, callback));
    }

    /// What went wrong since this was asked the last time.
    pub fn take_error(&self) -> Option<Error> {
        self.lock().error.take()
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Canvas {
    fn new(context: &StageContext) -> Result<Self, Error> {
        Ok(Self { stage: Stage::new(context, false)?, shot: None, developing: None })
    }
}

/// One shot in one part of the window, on its way through egui.
struct Callback {
    easel: Easel,
    rect: egui::Rect,
    shot: Shot,
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
        let place =
            egui::epaint::ViewportInPixels::from_points(&self.rect, screen.pixels_per_point, screen.size_in_pixels);
        self.easel.lock().record(device, queue, encoder, &self.shot, &place);
        Vec::new()
    }

    fn paint(&self, info: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        let place = info.viewport_in_pixels();
        if place.width_px > 0 && place.height_px > 0 {
            let inner = self.easel.lock();
            if let Some(developing) = &inner.main.developing {
                inner.developer.record(pass, developing);
            }
        }
    }
}

impl Inner {
    fn record(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        shot: &Shot,
        place: &egui::epaint::ViewportInPixels,
    ) {
        let canvas = &mut self.main;
        if !canvas.shot.as_ref().is_some_and(|drawn| is_same(drawn, shot)) {
            match canvas.stage.record(encoder, shot, &[shot.shade_tree]) {
                Ok(()) => {
                    canvas.shot = Some(shot.clone());
                    let picture = canvas.stage.picture(shot.shade_tree);
                    canvas.developing = picture.map(|picture| self.developer.bind(device, picture, picture));
                }
                // The last good picture stays.
                Err(error) => self.error = self.error.take().or(Some(error)),
            }
        }
        if let (Some(developing), Some(shot)) = (&canvas.developing, &canvas.shot) {
            let shown = Shown {
                origin: Vec2::new(place.left_px as f32, place.top_px as f32),
                size: Vec2::new(place.width_px as f32, place.height_px as f32),
                exposure: Vec2::splat(exposure(shot)),
                split: f32::MAX,
                difference: 0.0,
            };
            self.developer.prepare(queue, developing, &shown);
        }
    }
}

/// True if two shots give one picture.
fn is_same(a: &Shot, b: &Shot) -> bool {
    let shared = |(a, b): (&haze::MaterialAssets, &haze::MaterialAssets)| a.shares(b);
    (a.size, a.shade_tree) == (b.size, b.shade_tree)
        && a.preset == b.preset
        && a.materials.len() == b.materials.len()
        && a.materials.iter().zip(&b.materials).all(shared)
}
