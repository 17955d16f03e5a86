//! Tests of what is drawn again, and what is not.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use eframe::egui::Theme;
use eframe::egui_wgpu::RenderState;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

use super::*;
use crate::session::Session;
use crate::viewport_renderer::compared_side::ComparedSide;
use crate::window::Window;
use crate::window::testing::{brightness, screenshot, start_of};

/// Opens a window, and returns the render state of its egui.
fn window() -> (Harness<'static, Window>, RenderState) {
    let session = Session::open(Path::new("column"), None).unwrap();
    let start = start_of(session);
    let state = Rc::new(RefCell::new(None));
    let its = Rc::clone(&state);
    let builder = Harness::builder().with_size(egui::vec2(640.0, 400.0)).with_theme(Theme::Dark).wgpu();
    let mut harness = builder.build_eframe(move |context| {
        *its.borrow_mut() = context.wgpu_render_state.clone();
        Window::new(ViewportRenderer::new(context).unwrap(), start).unwrap()
    });
    harness.run_steps(3);
    let state = state.borrow_mut().take().unwrap();
    (harness, state)
}

fn shown(harness: &mut Harness<'static, Window>) -> f64 {
    let part = harness.get_by_label("viewport").rect();
    brightness(&screenshot(harness), part)
}

#[test]
fn a_frame_dropped_by_egui_is_drawn_in_the_next() {
    let (mut harness, state) = window();
    let before = shown(&mut harness);
    let session = harness.state_mut().session_mut();
    session.document.preset.lights.iter_mut().for_each(|light| light.intensity *= 4.0);
    harness.step();
    let renderer = harness.state().renderer().clone();
    let session = &harness.state().session;
    let frame = ViewportFrame { shot: session.shot(session.view.size), other: None, split: 0.5, difference: 0.0 };
    let rect = harness.get_by_label("viewport").rect();
    renderer.want_capture(Some(ComparedSide::First));
    let callback = Callback { renderer: renderer.clone(), rect, content: Content::Viewport(Box::new(frame)) };
    let mut encoder = state.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let screen = ScreenDescriptor { size_in_pixels: [640, 400], pixels_per_point: 1.0 };
    callback.prepare(&state.device, &state.queue, &screen, &mut encoder, &mut CallbackResources::default());
    assert!(renderer.is_capturing());
    drop(encoder);
    let after = shown(&mut harness);
    assert!(after > before + 5.0, "{before} {after}");
    assert!(!renderer.is_capturing(), "what was dropped is not waited for");
}

#[test]
fn a_new_exposure_only_repeats_the_tonemapping() {
    let (mut harness, _) = window();
    let before = shown(&mut harness);
    let drawn = harness.state().renderer().render_stats().renders;
    harness.state_mut().session_mut().document.preset.camera.exposure += 1.0;
    let after = shown(&mut harness);
    assert!(after > before + 5.0, "{before} {after}");
    assert_eq!(harness.state().renderer().render_stats().renders, drawn);
    harness.state_mut().session_mut().document.preset.time += 1.0;
    harness.state_mut().session_mut().playback.time += 1.0;
    shown(&mut harness);
    assert_eq!(harness.state().renderer().render_stats().renders, drawn + 1);
}
