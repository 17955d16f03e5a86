//! Gizmos of lights: marks for all lights, handles of the selected one, and pointer interaction.

use eframe::egui::{Color32, CursorIcon, Key, Pos2, Response, Ui};
use glam::Vec3;
use haze::{Light, LightKind};
use haze_preset::Track;

use super::handle_drag::HandleDrag;
use super::light_handle::{Cone, Handle, SQUARE, Shape, handles, hovered};
use super::light_marker::{self, light_position};
use super::outlined_painter::{AXES, HOVERED, OutlinedPainter, PLAIN, SELECTED};
use super::screen_projection::ScreenProjection;
use crate::session::Session;
use crate::session::view_options::Tab;

/// Dragged and hovered handle.
#[derive(Default)]
pub struct LightGizmo {
    drag: Option<HandleDrag>,
    /// Keyframes and time of the playback before the drag.
    before: (Vec<Track>, f64),
    hovered: Option<Handle>,
    /// The button that started the drag is still down.
    is_busy: bool,
}

/// Number of corners of a circle.
const CORNERS: u32 = 72;
/// A circle with a larger radius is not drawn, points.
const MAX_CIRCLE_RADIUS: f32 = 1.0e4;

impl LightGizmo {
    /// Selects and drags lights. Returns true while the pointer is used for that.
    pub fn interact(
        &mut self,
        ui: &Ui,
        response: &Response,
        projection: &ScreenProjection,
        session: &mut Session,
    ) -> bool {
        let (pointer, pressed, down, held) = ui.input(|input| {
            let pointer = &input.pointer;
            (pointer.interact_pos(), pointer.primary_pressed(), pointer.primary_down(), input.modifiers)
        });
        let selected = session.view.lights.selected.filter(|_| session.view.lights.turn.is_none());
        let light = selected.and_then(|index| session.document.preset.lights.get(index).map(|light| (index, light)));
        let at = pointer.filter(|_| response.contains_pointer() || self.drag.is_some());
        let was_busy = self.is_busy;
        self.is_busy &= down;
        self.hovered = None;
        if let Some((index, light)) = light {
            let under = at.and_then(|at| hovered(&handles(light, projection), at));
            if let (Some(handle), Some(at), true) =
                (under, at, pressed && response.is_pointer_button_down_on() && !held.alt)
            {
                self.drag = Some(HandleDrag::new(index, handle, *light, projection, at));
                self.before = (session.document.preset.animation.clone(), session.playback.time);
                self.is_busy = true;
            }
            if let Some(light) = session.document.preset.lights.get_mut(index)
                && self.drag(ui, index, light, projection, pointer.filter(|_| down), held)
            {
                let (tracks, time) = std::mem::take(&mut self.before);
                session.document.preset.animation = tracks;
                session.playback.time = time;
            }
            self.hovered = self.drag.as_ref().map(|drag| drag.handle).or(under.filter(|_| !down));
            if self.hovered.is_some() {
                ui.ctx().set_cursor_icon(if self.drag.is_some() { CursorIcon::Grabbing } else { CursorIcon::Grab });
            }
        } else {
            self.drag = None;
        }
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked() && !was_busy) {
            let lights: Vec<_> =
                session.document.preset.lights.iter().map(|light| session.view.lights.turned(light)).collect();
            session.view.lights.selected = light_marker::pick(&lights, projection, at);
            if session.view.lights.selected.is_some() {
                session.view.tab = Tab::Light;
            }
        }
        self.is_busy || was_busy
    }

    /// Moves the light. Returns true if the drag is canceled.
    fn drag(
        &mut self,
        ui: &Ui,
        index: usize,
        light: &mut Light,
        projection: &ScreenProjection,
        pointer: Option<Pos2>,
        held: eframe::egui::Modifiers,
    ) -> bool {
        // The light was changed by undo or by other means, so the drag ends.
        let Some(drag) = self.drag.as_mut().filter(|drag| drag.index == index && drag.left == *light) else {
            self.drag = None;
            return false;
        };
        if ui.input_mut(|input| input.consume_key(eframe::egui::Modifiers::NONE, Key::Escape)) {
            *light = drag.before;
            self.drag = None;
            return true;
        } else if let Some(pointer) = pointer {
            *light = drag.drag(projection, pointer, held);
        } else {
            self.drag = None;
        }
        false
    }

    pub fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    pub fn draw(&self, outlined: &OutlinedPainter<'_>, projection: &ScreenProjection, session: &Session) {
        let lights = &session.view.lights;
        for (index, light) in session.document.preset.lights.iter().enumerate() {
            let is_selected = lights.selected == Some(index);
            // A rotating light cannot be dragged.
            if is_selected && lights.turn.is_none() {
                self.draw_selected(outlined, light, projection);
            }
            light_marker::draw(outlined, &lights.turned(light), projection, is_selected, lights.is_shown(index));
        }
    }

    fn draw_selected(&self, outlined: &OutlinedPainter<'_>, light: &Light, projection: &ScreenProjection) {
        match light.kind {
            LightKind::Directional => draw_sun(outlined, light, projection),
            kind => {
                draw_depth(outlined, light.position, projection);
                let faint = hue_of(light).gamma_multiply(0.45);
                circle(
                    outlined,
                    projection,
                    light.position,
                    projection.right * light.range,
                    projection.up * light.range,
                    1.0,
                    faint,
                );
                let right = projection.right * light.radius;
                let up = projection.up * light.radius;
                circle(outlined, projection, light.position, right, up, 1.5, self.color(Handle::Radius, PLAIN));
                if kind == LightKind::Spot {
                    self.draw_cone(outlined, light, projection);
                }
            }
        }
        for (handle, shape) in handles(light, projection) {
            let color = self.color(handle, plain(handle));
            match shape {
                Shape::Arrow([from, to]) => {
                    outlined.line(&[from, to], 2.0, color);
                    outlined.arrow_head(to, to - from, color);
                }
                Shape::Quad(corners) => outlined.quad(corners, color),
                Shape::Square(center) => outlined.square(center, SQUARE, color),
                Shape::Knob(center) => outlined.knob(center, color),
            }
        }
    }

    fn draw_cone(&self, outlined: &OutlinedPainter<'_>, light: &Light, projection: &ScreenProjection) {
        let cone = Cone::new(light, projection);
        let across = cone.side.cross(cone.way);
        let angles = [
            (light.inner_angle, self.color(Handle::InnerAngle, PLAIN.gamma_multiply(0.5))),
            (light.outer_angle, self.color(Handle::OuterAngle, SELECTED)),
        ];
        for (angle, color) in angles {
            let sine = angle.to_radians().sin() * cone.length;
            let center = light.position + cone.way * (angle.to_radians().cos() * cone.length);
            circle(outlined, projection, center, cone.side * sine, across * sine, 1.0, color);
            for side in [cone.side, -cone.side] {
                if let Some(ends) = projection.segment(light.position, cone.rim(angle, side)) {
                    outlined.line(&ends, 1.0, color);
                }
            }
        }
        if let Some(ends) = projection.segment(light.position, cone.rim(0.0, cone.side)) {
            outlined.dashes(ends, self.color(Handle::Aim, PLAIN));
        }
    }

    fn color(&self, handle: Handle, plain: Color32) -> Color32 {
        if self.hovered == Some(handle) { HOVERED } else { plain }
    }
}

fn plain(handle: Handle) -> Color32 {
    match handle {
        Handle::Axis(axis) | Handle::Plane(axis) => AXES[axis],
        Handle::Center | Handle::OuterAngle | Handle::Aim => SELECTED,
        Handle::Radius | Handle::InnerAngle => PLAIN,
    }
}

fn hue_of(light: &Light) -> Color32 {
    light_marker::full_brightness(light.color)
}

/// Draws a sun: a line from its position on the sun sphere to the camera's target.
fn draw_sun(outlined: &OutlinedPainter<'_>, light: &Light, projection: &ScreenProjection) {
    let (center, radius) = projection.sun_sphere;
    circle(
        outlined,
        projection,
        center,
        projection.right * radius,
        projection.up * radius,
        1.0,
        PLAIN.gamma_multiply(0.3),
    );
    let from = light_position(light, projection);
    let tip = from.lerp(center, 0.6);
    if let Some([from, to]) = projection.segment(from, tip) {
        outlined.line(&[from, to], 2.0, SELECTED);
        if from.distance(to) > 12.0 {
            outlined.arrow_head(to, to - from, SELECTED);
        }
    }
    if let Some(ends) = projection.segment(tip, center) {
        outlined.dashes(ends, SELECTED);
    }
}

/// Draws a line straight down to the ground, with a cross there.
fn draw_depth(outlined: &OutlinedPainter<'_>, at: Vec3, projection: &ScreenProjection) {
    let foot = at.with_y(0.0);
    let color = AXES[1].gamma_multiply(0.8);
    if let Some(ends) = projection.segment(at, foot) {
        outlined.dashes(ends, color);
    }
    let reach = 7.0 * projection.metres_per_point(foot);
    for arm in [Vec3::X * reach, Vec3::Z * reach] {
        if let Some(ends) = projection.segment(foot - arm, foot + arm) {
            outlined.line(&ends, 1.0, color);
        }
    }
}

/// Draws a circle in the world, given two perpendicular radii.
fn circle(
    outlined: &OutlinedPainter<'_>,
    projection: &ScreenProjection,
    center: Vec3,
    u: Vec3,
    v: Vec3,
    width: f32,
    color: Color32,
) {
    if !u.is_finite() || u.length() > MAX_CIRCLE_RADIUS * projection.metres_per_point(center) {
        return;
    }
    let corner = |index: u32| {
        let (sine, cosine) = (std::f32::consts::TAU * (index % CORNERS) as f32 / CORNERS as f32).sin_cos();
        center + u * cosine + v * sine
    };
    let corners: Option<Vec<_>> = (0..=CORNERS).map(|index| projection.project(corner(index))).collect();
    if let Some(corners) = corners {
        return outlined.line(&corners, width, color);
    }
    // The near plane cuts the circle, so each segment is clipped.
    for index in 0..CORNERS {
        if let Some(ends) = projection.segment(corner(index), corner(index + 1)) {
            outlined.line(&ends, width, color);
        }
    }
}
