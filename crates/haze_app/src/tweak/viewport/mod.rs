//! The picture, and what is done to it with pointer and keys.

mod camera;
mod compare;
mod gizmo;
mod grab;
mod handle;
mod ink;
mod lens;
mod mark;
mod menu;
mod overlay;
mod puff;
mod ray;
mod steer;
mod toolbar;

use eframe::egui::{self, Response, Sense, Ui};
use glam::UVec2;
use haze::{Bounds, LightKind};

use super::action::InView;
use super::easel::{Easel, Exhibit};
use super::inspect::lit;
use super::lights::{ShownLights, Turn, fresh};
use super::session::Session;
use super::smoke::{Smoke, put_behind};
use compare::{divider, other};
use gizmo::Gizmo;
use ink::Ink;
use lens::Lens;
use menu::Menu;
use puff::TruePuff;
use ray::Ray;
use steer::Steering;

/// What goes on in the viewport.
#[derive(Default)]
pub struct Viewport {
    steering: Steering,
    smoke: Smoke,
    gizmo: Gizmo,
    menu: Menu,
    puff: TruePuff,
}

/// Metres round a light that are shown when it is looked at.
const CLOSE: f32 = 0.75;

impl Viewport {
    pub fn show(&mut self, ui: &mut Ui, session: &mut Session, easel: &Easel) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let pixels = rect.size() * ui.pixels_per_point();
        let size = UVec2::new(pixels.x.round() as u32, pixels.y.round() as u32);
        if size.min_element() == 0 {
            return;
        }
        session.show.size = size;
        session.inspect.point(&response);
        session.show.aspect = size.x as f32 / size.y as f32;
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "viewport"));
        self.begin_gesture(ui, session);
        session.show.lights.follow(&session.document.preset.lights);
        let lens = Lens::new(&session.document.preset.camera, rect);
        // While a pixel is inspected, a click is for it.
        let is_taken = !session.inspect.is_on && self.gizmo.interact(ui, &response, &lens, session);
        if !is_taken {
            self.steer(ui, &response, &lens, session);
        }
        self.menu(&response, &lens, session);
        if let Some(turn) = &mut session.show.lights.turn {
            turn.advance(ui.input(|input| input.stable_dt.min(0.1)));
            ui.ctx().request_repaint();
        }
        let shot = session.shot(size);
        let other = other(ui, session, &shot);
        let compare = &mut session.compare;
        let exhibit = Exhibit { shot, other, split: compare.split, difference: compare.difference };
        easel.show(ui, rect, exhibit);
        session.gauge.update(ui.ctx(), easel, &session.wake, compare.against.is_some());
        if compare.against.is_some() && compare.difference == 0.0 {
            divider(ui, rect, &mut compare.split);
        }
        // Over the picture, and under all that stands on it.
        lit::paint(ui, rect, &session.inspect, session.show.system);
        let lens = Lens::new(&session.document.preset.camera, rect);
        let painter = ui.painter_at(rect);
        let ink = Ink(&painter);
        if session.show.overlays.is_any() {
            let smoke = self.smoke.of(session);
            overlay::draw(&ink, &lens, &session.show, smoke, &easel.texels());
        }
        self.gizmo.draw(&ink, &lens, session);
        compare::labels(ui, rect, session);
        self.puff.show(ui, rect, session);
        if let Some(action) = toolbar::toolbar(ui, rect, session) {
            self.act(action, session);
            ui.ctx().request_repaint();
        }
    }

    fn menu(&mut self, response: &Response, lens: &Lens, session: &mut Session) {
        // A flight that did not look round is no click.
        let is_click = !self.steering.has_flown;
        if is_click && let Some(action) = self.menu.show(response, lens, session, &mut self.smoke) {
            match self.menu.at.filter(|_| action == InView::Behind) {
                Some(at) => self.put_behind(session, Some(lens.ray(at))),
                None => self.act(action, session),
            }
        }
    }

    /// Something is moved without a button being held.
    pub fn is_held(&self, ui: &Ui) -> bool {
        self.steering.is_wheeling(ui)
    }

    /// What is pressed now is no part of what the wheel did just before.
    fn begin_gesture(&mut self, ui: &Ui, session: &mut Session) {
        if self.steering.is_wheeling(ui) && ui.input(|input| input.pointer.any_pressed()) {
            self.steering.forget_wheel();
            session.track(false);
        }
    }

    fn steer(&mut self, ui: &Ui, response: &Response, lens: &Lens, session: &mut Session) {
        if self.steering.steer(ui, response, lens, &mut session.document.preset.camera) {
            session.messages.say("flight", format!("flying at {:.2} m/s", self.steering.speed));
        }
    }

    /// A handle of a light is being dragged; keys are for it.
    pub fn is_dragging(&self) -> bool {
        self.gizmo.is_dragging()
    }

    /// Does what a key or a menu asks for.
    pub fn act(&mut self, action: InView, session: &mut Session) {
        let saved = session.saved().camera;
        let camera = &mut session.document.preset.camera;
        match action {
            InView::Frame => self.frame(session),
            InView::Home => *camera = saved,
            InView::Delete => session.change_light(ShownLights::remove),
            InView::Duplicate => session.change_light(ShownLights::duplicate),
            InView::Behind => self.put_behind(session, None),
            InView::Overlay(overlay) => session.show.overlays.toggle(overlay),
            InView::Turntable => {
                let middle = self.smoke.of(session).bounds().centre();
                let turn = &mut session.show.lights.turn;
                *turn = if turn.is_some() { None } else { Some(Turn { middle, angle: 0.0 }) };
            }
            InView::Face(side) => camera::face(camera, side.way()),
        }
    }

    /// Puts the selected light, or a new one, behind the smoke that is pointed at, or else behind what is in the picture.
    fn put_behind(&mut self, session: &mut Session, at: Option<Ray>) {
        let smoke = self.smoke.of(session);
        let preset = &mut session.document.preset;
        let met = at.and_then(|ray| smoke.met(ray.origin, ray.direction));
        let point = met.unwrap_or_else(|| smoke.seen(&preset.camera, session.show.size));
        let eye = preset.camera.position;
        let selected = session.show.lights.selected.and_then(|index| preset.lights.get_mut(index));
        if let Some(light) = selected {
            return put_behind(light, eye, point, &smoke.bounds);
        }
        let mut light = fresh(LightKind::Point, &preset.lights);
        put_behind(&mut light, eye, point, &smoke.bounds);
        session.add_light(light);
    }

    /// Shows the selected light, or all of the smoke.
    fn frame(&mut self, session: &mut Session) {
        let mut bounds = self.smoke.of(session).bounds();
        let preset = &mut session.document.preset;
        let selected = session.show.lights.selected.and_then(|index| preset.lights.get(index));
        let light = selected.filter(|light| light.kind != LightKind::Directional);
        if let Some(light) = light {
            bounds = Bounds::EMPTY;
            bounds.include(light.position, light.radius.max(CLOSE));
        }
        camera::frame(&mut preset.camera, &bounds, session.show.aspect);
    }
}

#[cfg(test)]
mod tests;
