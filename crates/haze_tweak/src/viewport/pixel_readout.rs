//! Values of a pixel, in a corner of the viewport or docked beside it.

use eframe::egui::{self, Color32, Rect, RichText, Sense, Stroke, Ui, Vec2};
use glam::{Vec3, Vec4, Vec4Swizzles};
use haze_core::formula::color::luminance;
use haze_core::formula::tonemap::DisplayTransform;
use haze_reference::{LightProbe, ShadowProbe, SystemProbe};

use crate::session::Session;
use crate::session::comparison::CompareWith;
use crate::session::inspection::{PixelValues, srgb_code};
use crate::session::light_view::name_in_image;
use crate::viewport_renderer::compared_side::ComparedSide;

/// Distance from the corner, points.
const MARGIN: f32 = 8.0;

/// A smaller viewport uses small text, points.
const LARGE: Vec2 = Vec2::new(480.0, 400.0);
/// A narrower viewport shows the colors of lights without numbers, points. The second is for lights with shadow.
const WIDE: [f32; 2] = [540.0, 720.0];

/// Width of the docked inspector, points, and the most of a narrow window that it takes.
const DOCK_WIDTH: f32 = 290.0;
const DOCK_FRACTION: f32 = 0.22;

/// Values of a pixel, as far as there are any.
enum Readout<'a> {
    Values(&'a PixelValues),
    /// The pixel is of the CPU renderer's image.
    Reference,
}

/// Returns what is known of the pixel at a position, as a fraction of the viewport.
fn readout(session: &Session, position: Vec2) -> Option<Readout<'_>> {
    let side = session.compare.side(position.x);
    if side == ComparedSide::Second && session.compare.against == Some(CompareWith::Reference) {
        return Some(Readout::Reference);
    }
    session.inspect.pixel_values.as_ref().filter(|values| values.side == side).map(Readout::Values)
}

/// Draws the values beside the image, if the inspector is docked there. Call it before the image, which takes the rest.
pub fn docked_panel(ui: &mut Ui, session: &mut Session) {
    if !session.inspect.is_on || !session.inspect.is_docked {
        return;
    }
    // The image stays the largest part.
    let width = DOCK_WIDTH.min(DOCK_FRACTION * ui.ctx().content_rect().width());
    let panel = egui::Panel::left("docked inspector").default_size(width).size_range(140.0..=1.5 * width);
    panel.show(ui, |ui| {
        let is_undocked = ui.button("Undock").on_hover_text("Show the values over the image").clicked();
        ui.separator();
        // A popup would have half of a viewport.
        let room = Vec2::new(2.0 * ui.available_width(), LARGE.y);
        egui::ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            match session.inspect.position().and_then(|position| readout(session, position)) {
                Some(readout) => show(ui, &readout, session, room),
                None => drop(ui.weak("Point at the image")),
            }
        });
        if is_undocked {
            session.inspect.is_docked = false;
        }
    });
}

fn show(ui: &mut Ui, readout: &Readout<'_>, session: &Session, room: Vec2) {
    match readout {
        Readout::Values(values) => numbers(ui, values, session, room),
        Readout::Reference => drop(ui.weak("The CPU image cannot be inspected")),
    }
}

/// Marks the pixel while the inspector is on, and draws its values on the side away from the pointer if they are not docked.
pub fn panel(ui: &Ui, viewport: Rect, session: &mut Session) {
    let inspect = &session.inspect;
    let Some(position) = inspect.position().filter(|_| inspect.is_on && !inspect.is_painting) else { return };
    let Some(readout) = readout(session, position) else { return };
    let is_pinned = inspect.pinned.is_some();
    cross(ui, viewport.min + position * viewport.size(), is_pinned);
    if inspect.is_docked {
        return;
    }
    let (corner, pivot) = if position.x < 0.5 {
        (viewport.right_top() + Vec2::new(-MARGIN, MARGIN), egui::Align2::RIGHT_TOP)
    } else {
        (viewport.left_top() + Vec2::splat(MARGIN), egui::Align2::LEFT_TOP)
    };
    let area = egui::Area::new(egui::Id::unique("inspector")).fixed_pos(corner).pivot(pivot).interactable(is_pinned);
    let size = viewport.size();
    let mut is_docked = false;
    area.constrain_to(viewport).show(ui.ctx(), |ui| {
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            if is_small(size) {
                ui.style_mut().override_font_id = Some(egui::FontId::proportional(11.0));
                ui.spacing_mut().item_spacing = Vec2::new(4.0, 1.0);
                ui.spacing_mut().interact_size = Vec2::new(26.0, 14.0);
            }
            show(ui, &readout, session, size);
            // Values that follow the pointer cannot be clicked.
            if is_pinned {
                is_docked = ui.button("Dock").on_hover_text("Show the values beside the image").clicked();
            }
        });
    });
    session.inspect.is_docked = is_docked;
}

fn is_small(viewport: Vec2) -> bool {
    viewport.x < LARGE.x || viewport.y < LARGE.y
}

/// Marks the pixel with a cross.
fn cross(ui: &Ui, at: egui::Pos2, is_pinned: bool) {
    let reach = if is_pinned { 9.0 } else { 6.0 };
    for (width, color) in [(3.0, Color32::from_black_alpha(150)), (1.0, Color32::WHITE)] {
        for way in [Vec2::new(1.0, 0.0), Vec2::new(-1.0, 0.0), Vec2::new(0.0, 1.0), Vec2::new(0.0, -1.0)] {
            ui.painter().line_segment([at + way * 3.0, at + way * reach], Stroke::new(width, color));
        }
    }
}

fn numbers(ui: &mut Ui, values: &PixelValues, session: &Session, size: Vec2) {
    let PixelValues { pixel, side, names, probe, front_fraction, transform } = values;
    let keep = if session.inspect.pinned.is_some() { "Pinned" } else { "Click to pin" };
    ui.horizontal(|ui| {
        ui.strong(format!("Pixel {}, {}", pixel.x, pixel.y));
        ui.weak(keep);
        if let Some(against) = session.compare.against.as_ref().filter(|_| *side == ComparedSide::Second) {
            ui.weak(format!("Image B: {}", against.name()));
        }
    });
    let preset = session.compare.against.as_ref().filter(|_| *side == ComparedSide::Second);
    let preset = preset.and_then(|against| against.settings(session.saved())).unwrap_or(&session.document.preset);
    let lights = session.view.lights.shown_names(&preset.lights);
    // The nearest system comes first.
    for system in probe.systems.iter().rev() {
        ui.separator();
        ui.label(RichText::new(names.get(system.system).map_or("Smoke", String::as_str)).strong());
        system_values(ui, system, &lights, size);
    }
    if probe.systems.is_empty() {
        ui.weak("No smoke here");
    }
    ui.separator();
    match probe.color {
        Some(_) if *front_fraction > 0.0 => {
            let covered = 100.0 * front_fraction;
            ui.weak(format!(
                "The edge of an object in front covers {covered:.0} %\nof this pixel: values of what is behind it"
            ));
        }
        Some(color) => image(ui, color, *transform),
        None => {
            ui.weak("The forward path lights each sprite\nseparately: no values to inspect");
        }
    }
}

fn system_values(ui: &mut Ui, probe: &SystemProbe, lights: &[String], size: Vec2) {
    ui.horizontal(|ui| {
        ball(ui, probe.normal);
        ui.vertical(|ui| {
            ui.label(format!("Amount {:.3}   Coverage {:.3}", probe.amount, probe.coverage));
            let Vec3 { x, y, z } = probe.normal;
            ui.label(format!("Normal {x:.2} {y:.2} {z:.2}"));
        });
    });
    let has_shadow = probe.lights.iter().any(|light| light.shadow.is_some());
    let is_small = is_small(size);
    let columns = LightColumns {
        has_shadow,
        has_position: !is_small,
        has_numbers: !is_small && size.x >= WIDE[usize::from(has_shadow)],
    };
    egui::Grid::new(("lights", probe.system)).num_columns(7).spacing(gaps(ui)).show(ui, |ui| {
        let shadow = has_shadow.then_some("Shadow");
        for title in ["", "N·L", "Ramp", "Light"].into_iter().chain(shadow).chain(["Diffuse", "Specular"]) {
            ui.weak(title);
        }
        ui.end_row();
        probe.lights.iter().for_each(|light| light_row(ui, light, lights, columns));
    });
    egui::Grid::new(("sums", probe.system)).num_columns(3).spacing(gaps(ui)).show(ui, |ui| {
        let scatter = probe.soft_scatter_weight.map_or("by ramp".into(), |weight| format!("weight {weight:.2}"));
        let ambient = probe.ambient.map(|light| ("Of it ambient", String::new(), light));
        let fire = probe.fire.map(|fire| {
            let glam::Vec2 { x, y } = fire.coordinate;
            ("Fire", format!("heat {x:.2}, amount {y:.2}"), fire.light)
        });
        let sums = [
            ("Soft scatter", scatter, probe.soft_scatter),
            ("Specular", String::new(), probe.specular()),
            ("Blended", String::new(), probe.blended.xyz()),
        ];
        let diffuse = [("Diffuse", String::new(), probe.diffuse)];
        for (title, note, light) in diffuse.into_iter().chain(ambient).chain(fire).chain(sums) {
            ui.label(title);
            color(ui, light);
            ui.weak(note);
            ui.end_row();
        }
    });
}

/// Columns of the table of lights.
#[derive(Clone, Copy)]
struct LightColumns {
    has_shadow: bool,
    /// Place on the shadow ramp.
    has_position: bool,
    /// Colors as numbers. Their sums are shown as numbers in any case.
    has_numbers: bool,
}

fn light_row(ui: &mut Ui, light: &LightProbe, names: &[String], columns: LightColumns) {
    let color = if columns.has_numbers { color } else { hue_swatch };
    ui.label(name_in_image(names, light.light));
    ui.label(format!("{:.2}", light.cosine));
    ui.label(format!("{:.2}", light.coordinate));
    ui.label(format!("{:.3}", light.attenuation));
    match light.shadow {
        Some(shadow) => shadow_values(ui, &shadow, columns.has_position),
        None if columns.has_shadow => drop(ui.weak("None")),
        None => {}
    }
    color(ui, light.diffuse);
    match light.glow {
        Some(glow) => color(ui, glow.specular),
        None => {
            ui.weak("None");
        }
    }
    ui.end_row();
}

/// Shows the fraction of a light that is left, and its position on the shadow ramp.
fn shadow_values(ui: &mut Ui, shadow: &ShadowProbe, has_position: bool) {
    ui.horizontal(|ui| {
        ui.label(format!("{:.0} % left", 100.0 * luminance(shadow.transmittance)));
        if has_position {
            let glam::Vec2 { x, y } = shadow.coordinate;
            ui.weak(format!("at {x:.2} {y:.2}"));
        }
    });
}

/// Returns the spacing of columns and rows.
fn gaps(ui: &Ui) -> Vec2 {
    ui.spacing().item_spacing + Vec2::new(2.0, -1.0)
}

/// Shows the image value before and after tonemapping.
fn image(ui: &mut Ui, light: Vec4, transform: DisplayTransform) {
    egui::Grid::new("image").num_columns(2).spacing(gaps(ui)).show(ui, |ui| {
        ui.label("Image, linear");
        color(ui, light.xyz());
        ui.end_row();
        ui.label("Displayed, sRGB");
        let [r, g, b] = srgb_code(light.xyz(), transform);
        ui.horizontal(|ui| {
            swatch(ui, Color32::from_rgb(r, g, b));
            ui.label(format!("{r} {g} {b}"));
        });
        ui.end_row();
    });
}

fn hue_swatch(ui: &mut Ui, light: Vec3) {
    let [r, g, b] = (light / light.max_element().max(1.0)).to_array();
    swatch(ui, egui::Rgba::from_rgb(r, g, b).into());
}

/// Shows linear light as a swatch and as numbers.
fn color(ui: &mut Ui, light: Vec3) {
    ui.horizontal(|ui| {
        hue_swatch(ui, light);
        ui.label(format!("{:.3} {:.3} {:.3}", light.x, light.y, light.z));
    });
}

fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(11.0), Sense::hover());
    ui.painter().rect(rect, 2.0, color, ui.visuals().widgets.noninteractive.bg_stroke, egui::StrokeKind::Inside);
}

/// Draws a ball with the normal on it.
fn ball(ui: &mut Ui, normal: Vec3) {
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(34.0), Sense::hover());
    let middle = rect.center();
    let radius = 15.0;
    let painter = ui.painter();
    // Dark at the edge, bright at the center.
    for step in 0..6_u8 {
        let fraction = 1.0 - f32::from(step) / 6.0;
        painter.circle_filled(middle, radius * fraction, Color32::from_gray(50 + 18 * step));
    }
    let tip = middle + Vec2::new(normal.x, -normal.y) * radius;
    painter.line_segment([middle, tip], Stroke::new(1.5, Color32::from_rgb(255, 200, 60)));
    painter.circle_filled(tip, 3.0, Color32::from_rgb(255, 200, 60));
    painter.circle_stroke(middle, radius, ui.visuals().widgets.noninteractive.bg_stroke);
}
