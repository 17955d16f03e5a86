//! Window for tests: controlled through accessible names, drawn by a real adapter.

use std::path::Path;
use std::sync::LazyLock;

use eframe::egui::{self, Vec2};
use eframe::egui_wgpu;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::{Harness, HarnessBuilder};
use haze::wgpu::Backends;
use haze_core::error::Error;
use haze_demo::offscreen_renderer::OffscreenContext;
use image::RgbaImage;

use super::device::device;
use super::{Start, Window};
use crate::files::hot_reload::ShaderFolder;
use crate::files::persistence::Layout;
use crate::files::thumbnail_cache::ThumbnailCache;
use crate::session::Session;
use crate::viewport_renderer::ViewportRenderer;

/// Opens a window with a preset and waits until it has settled.
pub fn window(preset: &str, size: Vec2, theme: egui::Theme) -> Harness<'static, Window> {
    window_with(preset, size, theme, ShaderFolder::None)
}

/// Like [`window`], with a folder of shaders.
pub fn window_with(preset: &str, size: Vec2, theme: egui::Theme, shaders: ShaderFolder) -> Harness<'static, Window> {
    open(start(preset, shaders), size, theme)
}

fn start(preset: &str, shaders: ShaderFolder) -> Start {
    Start { shaders, ..start_of(Session::open(Path::new(preset), None).unwrap()) }
}

/// Returns a start that shows a session and nothing else, and keeps nothing.
pub fn start_of(session: Session) -> Start {
    Start {
        session,
        shaders: ShaderFolder::None,
        persistence: None,
        layout: Layout::default(),
        has_dialogs: false,
        cache: ThumbnailCache::default(),
        has_start_view: false,
    }
}

/// Like [`window`], with any start state.
pub fn open(start: Start, size: Vec2, theme: egui::Theme) -> Harness<'static, Window> {
    let (setup, context) = shared_device();
    let builder = Harness::builder().with_size(size).with_theme(theme).wgpu_setup(setup.clone());
    settled(builder, |window| ViewportRenderer::with_context(window, context.clone()), start)
}

/// Setup without OpenGL: egui lists the adapters of all backends for each window, and wgpu panics when two threads drop an
/// OpenGL adapter of one instance at the same time.
fn wgpu_setup() -> egui_wgpu::WgpuSetup {
    let mut setup = egui_kittest::wgpu::default_wgpu_setup();
    if let egui_wgpu::WgpuSetup::CreateNew(setup) = &mut setup {
        setup.instance_descriptor.backends = Backends::from_env().unwrap_or(Backends::PRIMARY);
    }
    setup
}

/// Device and pipelines that all tests of the process share, so that no pipeline is compiled twice.
fn shared_device() -> &'static (egui_wgpu::WgpuSetup, OffscreenContext) {
    static SHARED: LazyLock<(egui_wgpu::WgpuSetup, OffscreenContext)> = LazyLock::new(|| {
        let setup = wgpu_setup();
        let instance = pollster::block_on(setup.new_instance());
        let options = egui_wgpu::RendererOptions::PREDICTABLE;
        let configuration = egui_wgpu::WgpuConfiguration { wgpu_setup: setup, ..Default::default() };
        let created = egui_wgpu::RenderState::create(&configuration, &instance, None, options);
        let egui_wgpu::RenderState { adapter, device, queue, .. } = pollster::block_on(created).unwrap();
        let context = OffscreenContext::new(&adapter, &device, &queue);
        (egui_wgpu::WgpuSetupExisting { instance, adapter, device, queue }.into(), context)
    });
    &SHARED
}

fn settled(
    builder: HarnessBuilder<Window>,
    renderer: impl FnOnce(&eframe::CreationContext<'_>) -> Result<ViewportRenderer, Error>,
    start: Start,
) -> Harness<'static, Window> {
    let open = |context: &mut eframe::CreationContext<'_>| Window::new(renderer(context).unwrap(), start).unwrap();
    let mut harness = builder.with_render_cursor(false).build_eframe(open);
    harness.run_steps(3);
    harness
}

/// Like [`window`], measured by timestamps as on a GPU.
pub fn measured(preset: &str, size: Vec2) -> Harness<'static, Window> {
    let mut setup = wgpu_setup();
    if let egui_wgpu::WgpuSetup::CreateNew(setup) = &mut setup {
        setup.device_descriptor = std::sync::Arc::new(device);
    }
    let builder = Harness::builder().with_size(size).wgpu_setup(setup);
    let renderer = |window: &eframe::CreationContext<'_>| {
        let mut renderer = ViewportRenderer::new(window)?;
        renderer.use_timestamps();
        Ok(renderer)
    };
    settled(builder, renderer, start(preset, ShaderFolder::None))
}

/// Opens the menu of the row whose control has this name.
pub fn row_menu(harness: &mut Harness<'_, Window>, name: &str) {
    let pos = row_name(harness, name);
    click_at(harness, pos, egui::PointerButton::Secondary);
}

/// Returns the position of a row's name, to the left of its control.
pub fn row_name(harness: &Harness<'_, Window>, name: &str) -> egui::Pos2 {
    let is_control = |node: &egui_kittest::Node<'_>| {
        [egui::Role::Slider, egui::Role::ComboBox, egui::Role::SpinButton].contains(&node.accesskit_node().role())
    };
    let control = harness.get_all_by_label(name).find(is_control).unwrap().rect();
    control.left_center() - egui::vec2(115.0, 0.0)
}

/// Sends a click of the pointer.
pub fn click_at(harness: &mut Harness<'_, Window>, pos: egui::Pos2, button: egui::PointerButton) {
    harness.hover_at(pos);
    for pressed in [true, false] {
        let modifiers = egui::Modifiers::NONE;
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
    }
    harness.run_steps(3);
}

/// Returns an image of the window.
pub fn screenshot(harness: &mut Harness<'_, Window>) -> RgbaImage {
    harness.step();
    harness.render().unwrap()
}

/// Returns the mean brightness of a part of an image, 0 to 255.
pub fn brightness(image: &RgbaImage, part: egui::Rect) -> f64 {
    let mut sum = 0.0;
    let mut count = 0.0;
    for y in part.top() as u32..part.bottom() as u32 {
        for x in part.left() as u32..part.right() as u32 {
            let [r, g, b, _] = image.get_pixel(x, y).0;
            sum += (f64::from(r) + f64::from(g) + f64::from(b)) / 3.0;
            count += 1.0;
        }
    }
    sum / count
}
