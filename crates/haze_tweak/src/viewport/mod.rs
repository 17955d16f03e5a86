//! Viewport: the image, and its control by pointer and keys.

mod camera_input;
pub mod camera_moves;
mod context_menu;
mod handle_drag;
mod light_gizmo;
mod light_handle;
mod light_marker;
mod outlined_painter;
mod overlay;
pub mod path_traced_puff;
pub mod pixel_readout;
pub mod probe_job;
mod ramp_highlight;
mod ray;
mod screen_projection;
mod smoke_paint;
mod split_view;
mod toolbar;

use eframe::egui::{self, Response, Sense, Ui};
use glam::UVec2;
use haze::{Bounds, Light, LightKind, LightRole};

use crate::document::light_defaults::new_light;
use crate::session::Session;
use crate::session::action::InView;
use crate::session::light_view::{LightTurn, LightView};
use crate::session::smoke_geometry::{SmokeGeometry, place_behind};
use crate::viewport_renderer::{ViewportFrame, ViewportRenderer};
use camera_input::CameraInput;
use context_menu::Menu;
use light_gizmo::LightGizmo;
use outlined_painter::OutlinedPainter;
use path_traced_puff::PathTracedPuff;
use ray::Ray;
use screen_projection::ScreenProjection;
use smoke_paint::SmokePaint;
use split_view::{comparison_image, divider};

/// State of the viewport.
#[derive(Default)]
pub struct Viewport {
    steering: CameraInput,
    smoke: SmokeGeometry,
    gizmo: LightGizmo,
    paint: SmokePaint,
    menu: Menu,
    puff: PathTracedPuff,
}

/// Radius around a light that is framed, metres.
const CLOSE: f32 = 0.75;

impl Viewport {
    pub fn show(&mut self, ui: &mut Ui, session: &mut Session, renderer: &ViewportRenderer) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let pixels = rect.size() * ui.pixels_per_point();
        let size = UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32);
        if size.min_element() == 0 {
            return;
        }
        session.view.size = size;
        session.inspect.point(&response);
        session.view.aspect = size.x as f32 / size.y as f32;
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "viewport"));
        self.begin_gesture(ui, session);
        let edit = session.begin_edit();
        session.view.lights.follow(&session.document.preset.lights);
        let projection = ScreenProjection::new(&session.document.preset.camera, rect);
        // While the inspector is on, a click pins a pixel, and a drag with Ctrl paints.
        let is_taken = match session.inspect.is_on {
            true => self.paint.interact(ui, &response, session),
            false => self.gizmo.interact(ui, &response, &projection, session),
        };
        if !is_taken {
            if !session.inspect.is_on {
                smoke_paint::explain(ui, &response, session);
            }
            self.steer(ui, &response, &projection, session);
        }
        self.menu(&response, &projection, session);
        session.end_edit(edit);
        if let Some(turn) = &mut session.view.lights.turn {
            turn.advance(ui.input(|input| input.stable_dt.min(0.1)));
            ui.ctx().request_repaint();
        }
        let shot = session.shot(size);
        let other = comparison_image(ui, session, &shot);
        let compare = &mut session.compare;
        let frame = ViewportFrame { shot, other, split: compare.split, difference: compare.difference };
        renderer.show(ui, rect, frame);
        session.psnr_job.update(ui.ctx(), renderer, &session.repaint, compare.against.is_some());
        if compare.against.is_some() && compare.difference == 0.0 {
            divider(ui, rect, &mut compare.split);
        }
        let edit = session.begin_edit();
        // Above the image, and below everything else that is drawn on it.
        ramp_highlight::paint(ui, rect, &session.inspect, session.view.system);
        let projection = ScreenProjection::new(&session.document.preset.camera, rect);
        let painter = ui.painter_at(rect);
        let outlined = OutlinedPainter(&painter);
        if session.view.overlays.is_any() {
            let smoke = session.measure(&mut self.smoke);
            overlay::draw(&outlined, &projection, &session.view, smoke, &renderer.texels());
        }
        self.gizmo.draw(&outlined, &projection, session);
        split_view::labels(ui, rect, session);
        self.puff.show(ui, rect, session);
        if let Some(action) = toolbar::toolbar(ui, rect, session) {
            self.act(action, session);
            ui.ctx().request_repaint();
        }
        session.end_edit(edit);
    }

    fn menu(&mut self, response: &Response, projection: &ScreenProjection, session: &mut Session) {
        // A flight that did not turn the view is no click.
        let is_click = !self.steering.has_flown;
        if is_click && let Some(action) = self.menu.show(response, projection, session, &mut self.smoke) {
            match self.menu.at.filter(|_| action == InView::Behind) {
                Some(at) => self.place_behind(session, Some(projection.ray(at))),
                None => self.act(action, session),
            }
        }
    }

    /// Returns true while a change is in progress without a pressed button.
    pub fn is_held(&self, ui: &Ui) -> bool {
        self.steering.is_wheeling(ui)
    }

    /// A press ends the gesture of the wheel before it.
    fn begin_gesture(&mut self, ui: &Ui, session: &mut Session) {
        if self.steering.is_wheeling(ui) && ui.input(|input| input.pointer.any_pressed()) {
            self.steering.forget_wheel();
            session.track(false);
        }
    }

    fn steer(&mut self, ui: &Ui, response: &Response, projection: &ScreenProjection, session: &mut Session) {
        if self.steering.steer(ui, response, projection, &mut session.document.preset.camera) {
            session.messages.info("flight", format!("Flight speed {:.2} m/s", self.steering.speed));
        }
    }

    /// Returns true while a handle of a light is dragged, which then receives the keys.
    pub fn is_dragging(&self) -> bool {
        self.gizmo.is_dragging()
    }

    /// Runs the action of a key or a menu.
    pub fn act(&mut self, action: InView, session: &mut Session) {
        let edit = session.begin_edit();
        self.change(action, session);
        session.end_edit(edit);
    }

    fn change(&mut self, action: InView, session: &mut Session) {
        let saved = session.saved().with_keyframes_at(session.playback.time).camera;
        let camera = &mut session.document.preset.camera;
        match action {
            InView::Frame => self.frame(session),
            InView::Home => *camera = saved,
            InView::Delete => session.change_light(LightView::remove),
            InView::Duplicate => session.change_light(LightView::duplicate),
            InView::Behind => self.place_behind(session, None),
            InView::Overlay(overlay) => session.view.overlays.toggle(overlay),
            InView::Turntable => {
                let middle = session.measure(&mut self.smoke).bounds().center();
                let turn = &mut session.view.lights.turn;
                *turn = if turn.is_some() { None } else { Some(LightTurn { middle, angle: 0.0 }) };
            }
            InView::Face(side) => camera_moves::face(camera, side.way()),
        }
    }

    /// Puts the selected light, or a new one, behind the smoke on the ray, or else behind the smoke in the image.
    fn place_behind(&mut self, session: &mut Session, at: Option<Ray>) {
        let smoke = session.measure(&mut self.smoke);
        let preset = &mut session.document.preset;
        let met = at.and_then(|ray| smoke.center_on_ray(ray.origin, ray.direction));
        let point = met.unwrap_or_else(|| smoke.visible_center(&preset.camera, session.view.size));
        let eye = preset.camera.position;
        let selected = session.view.lights.selected.and_then(|index| preset.lights.get_mut(index));
        if let Some(light) = selected {
            return place_behind(light, eye, point, &smoke.bounds);
        }
        let mut light = Light { role: LightRole::Rim, ..new_light(LightKind::Point, &preset.lights) };
        place_behind(&mut light, eye, point, &smoke.bounds);
        session.add_light(light);
    }

    /// Frames the selected light, or all smoke.
    fn frame(&mut self, session: &mut Session) {
        let mut bounds = session.measure(&mut self.smoke).bounds();
        let preset = &mut session.document.preset;
        let selected = session.view.lights.selected.and_then(|index| preset.lights.get(index));
        let light = selected.filter(|light| light.kind != LightKind::Directional);
        if let Some(light) = light {
            bounds = Bounds::EMPTY;
            bounds.include(light.position, light.radius.max(CLOSE));
        }
        camera_moves::frame(&mut preset.camera, &bounds, session.view.aspect);
    }
}

#[cfg(test)]
mod tests;
