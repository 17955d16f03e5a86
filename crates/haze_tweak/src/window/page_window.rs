//! Opens the window in the canvas of a page, and opens it again with the same session when the graphics device is lost.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use eframe::{WebRunner, egui, egui_wgpu, wgpu};
use haze_export::page_renderer::{PageGpu, set_gpu};
use wasm_bindgen::JsValue;
use wasm_bindgen_futures::spawn_local;
use web_sys::HtmlCanvasElement;

use super::device::setup;
use super::drag_end::split_events_at_buttons;
use super::surface_pacing::paced_surface_handler;
use super::{Start, Window};
use crate::platform::web::{page, storage};
use crate::viewport_renderer::ViewportRenderer;
use crate::viewport_renderer::device_health::DeviceHealth;

/// Frames after which the image is on the screen.
const SETTLED_FRAMES: u32 = 3;

/// State that is kept while one canvas goes and the next comes.
struct KeptState {
    /// `None` while a window owns it.
    start: RefCell<Option<Start>>,
    /// Memory of egui: sizes of panels, collapsed sections.
    memory: RefCell<Option<egui::Memory>>,
    runner: WebRunner,
    /// The graphics context of the canvas was lost.
    is_lost: Rc<Cell<bool>>,
}

/// Shows a session in the canvas of the page.
///
/// # Errors
/// The reason in words if the browser has no graphics device.
pub async fn open(start: Start) -> Result<(), String> {
    let canvas = page::canvas().ok_or("the page has no canvas")?;
    let kept = KeptState {
        start: RefCell::new(Some(start)),
        memory: RefCell::default(),
        runner: WebRunner::new(),
        is_lost: Rc::default(),
    };
    open_in(canvas, Rc::new(kept)).await
}

async fn open_in(canvas: HtmlCanvasElement, kept: Rc<KeptState>) -> Result<(), String> {
    let options = eframe::WebOptions {
        wgpu_options: egui_wgpu::WgpuConfiguration {
            wgpu_setup: page_setup(),
            on_surface_status: paced_surface_handler(),
            ..Default::default()
        },
        ..Default::default()
    };
    kept.is_lost.set(false);
    let runner = kept.runner.clone();
    let watched = canvas.clone();
    let app: eframe::AppCreator<'static> = Box::new(move |context| {
        let renderer = ViewportRenderer::new(context)?;
        if let Some(memory) = kept.memory.take() {
            context.egui_ctx.memory_mut(|new| *new = memory);
        }
        if let Some(render) = &context.wgpu_render_state {
            let device = render.device.clone();
            let queue = render.queue.clone();
            set_gpu(PageGpu { device, queue, context: renderer.context() });
        }
        let health = renderer.health().clone();
        let events = page::watch_context(&watched, Rc::clone(&kept.is_lost), renderer.wake());
        let start = kept.start.take().ok_or("the session is gone")?;
        let window = Some(Window::new(renderer, start)?);
        Ok(Box::new(PageApp { window, health, kept, later: Vec::new(), frames: 0, _events: events })
            as Box<dyn eframe::App>)
    });
    runner.start(canvas, options, app).await.map_err(|error| reason(&error))
}

/// Returns the setup of a window; of WebGL alone if the address asks for it with `?api=webgl`.
fn page_setup() -> egui_wgpu::WgpuSetup {
    let mut setup = setup();
    if let egui_wgpu::WgpuSetup::CreateNew(new) = &mut setup
        && page::query().contains("api=webgl")
    {
        new.instance_descriptor.backends = wgpu::Backends::GL;
    }
    setup
}

fn reason(error: &JsValue) -> String {
    error.as_string().unwrap_or_else(|| format!("{error:?}"))
}

/// App of eframe around the window, while the device works.
struct PageApp {
    window: Option<Window>,
    health: DeviceHealth,
    kept: Rc<KeptState>,
    /// Events that later frames take.
    later: Vec<egui::Event>,
    frames: u32,
    _events: page::ContextEvents,
}

impl PageApp {
    /// Continues the session in a new canvas.
    fn reopen(&mut self, context: &egui::Context) {
        let Some(window) = self.window.take() else { return };
        *self.kept.memory.borrow_mut() = Some(context.memory(Clone::clone));
        *self.kept.start.borrow_mut() = Some(window.into_start());
        let kept = Rc::clone(&self.kept);
        spawn_local(async move {
            kept.runner.destroy();
            let opened = match page::replace_canvas() {
                Some(canvas) => open_in(canvas, kept).await,
                None => Err("the page has no canvas".into()),
            };
            if let Err(reason) = opened {
                page::set_state("failed", &format!("the graphics device was lost and does not come back: {reason}"));
            }
        });
    }
}

impl eframe::App for PageApp {
    fn raw_input_hook(&mut self, context: &egui::Context, input: &mut egui::RawInput) {
        split_events_at_buttons(&mut self.later, &mut input.events);
        if !self.later.is_empty() {
            context.request_repaint();
        }
    }

    fn logic(&mut self, context: &egui::Context, frame: &mut eframe::Frame) {
        if self.health.is_lost() || self.kept.is_lost.get() {
            self.reopen(context);
        } else if let Some(window) = &mut self.window {
            window.logic(context, frame);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let Some(window) = &mut self.window else { return };
        window.ui(ui, frame);
        if !storage::save_changed() {
            window.session.messages.info("storage", "The browser does not keep this file after a reload. Save it.");
        }
        self.frames += 1;
        match self.frames.cmp(&SETTLED_FRAMES) {
            std::cmp::Ordering::Less => ui.ctx().request_repaint(),
            std::cmp::Ordering::Equal => page::set_state("running", ""),
            std::cmp::Ordering::Greater => {}
        }
    }
}
