//! Ramps tab: the ramps in use, and the parts of the ramps that this image samples.

mod fire_display;

use eframe::egui::{self, Color32, Mesh, Rect, Response, Sense, Stroke, Ui, Vec2};
use glam::UVec2;
use haze::MaterialAssets;
use haze_core::assets::ramp::Ramp;
use haze_core::formula::color::luminance;
use haze_core::formula::ramp::sample_ramp_2d;
use haze_core::settings::{ImageRole, RampFilter, set_field};
use haze_reference::SystemProbe;

use fire_display::FireDisplay;

use super::look_browser;
use super::ramp_stops::{self, AxisSamples, Bins, Mark, NamedRamp};
use super::rows::image_gallery::gallery;
use crate::document::display_names::display_name;
use crate::document::ramp_edits::ramp_name;
use crate::session::Session;
use crate::session::inspection::PixelValues;
use crate::session::light_view::name_in_image;
use crate::session::ramp_survey::{Histogram, RampPosition, RampSurvey, SIDE, TwoAxisRamp};
use crate::viewport_renderer::compared_side::ComparedSide;

/// Heights of a ramp and of a histogram, points.
const RAMP_HEIGHT: f32 = 20.0;
const HISTOGRAM_HEIGHT: f32 = 56.0;
/// Largest number of rows that a strip shows.
const MAX_STRIP_ROWS: u32 = 20;
/// Largest width of a ramp with two axes, points.
const PLANE_WIDTH: f32 = 220.0;

/// Colors of the lights, reused cyclically; distinguishable also with color blindness.
const LIGHT_COLORS: [Color32; 6] = [
    Color32::from_rgb(230, 159, 0),
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 121, 167),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(120, 120, 240),
];

/// Colors of the sampled positions over dark and over light parts of a ramp with two axes.
const SAMPLED_OVER_DARK: Color32 = Color32::from_rgb(120, 210, 255);
const SAMPLED_OVER_LIGHT: Color32 = Color32::from_rgb(0, 50, 130);
/// Linear luminance that separates them.
const MIDDLE_GRAY: f32 = 0.18;

/// Draws the tab. Returns the position on a ramp under the pointer.
pub fn panel(ui: &mut Ui, session: &mut Session, index: usize) -> Option<RampPosition> {
    let system = &session.document.preset.systems.get(index)?.clone();
    let material = &session.materials().into_iter().nth(index)?;
    let is_first = |values: &&PixelValues| values.side == ComparedSide::First && session.inspect.position().is_some();
    let values = session.inspect.pixel_values.as_ref().filter(is_first);
    let probe = values.and_then(|values| values.probe.systems.iter().find(|probe| probe.system == index)).cloned();
    let filter = system.settings.ramp_filter;
    let is_forward = system.settings.is_forward();
    let survey = session.inspect.survey.clone().filter(|_| !is_forward);
    let lookups = Lookups { system: index, survey: survey.as_deref(), probe: probe.as_ref(), is_forward };
    let mut ramp_position = None;
    ui.weak(
        "Hover a ramp to highlight the smoke that uses that color. Hover the smoke to mark its place on the ramps.",
    );
    if is_forward {
        ui.weak("No histograms: the forward path lights each sprite separately.");
    }
    for RampEntry { field, title, tooltip, switch } in &RAMPS {
        let field = *field;
        let path = format!("systems[{index}].material.{field}");
        let Some(name) = ramp_name(&session.document.preset, index, field) else { continue };
        let name = name.as_str();
        ui.add_space(6.0);
        choose(ui, session, title, tooltip, &path, name);
        if let Some(reason) = session.no_effect_reason(&session.document.preset, &path) {
            off(ui, session, index, field, switch.as_ref(), reason);
            continue;
        }
        let ramp = NamedRamp { system: index, field, name };
        ui.horizontal_wrapped(|ui| {
            look_browser::button(ui, session, index, field);
            ramp_stops::offer_stops(ui, session, ramp);
            ramp_stops::grip(ui, session, ramp);
        });
        let spoken = display_name(field);
        let ink = ui.visuals().text_color();
        if let Some(two_axes) = two_axes(field, material) {
            ramp_position = ramp_position.or(two_axis_ramp(ui, session, ramp, &two_axes, filter, &lookups));
            continue;
        }
        let lights = match lookups.survey.filter(|_| is_diffuse(field)) {
            Some(survey) => survey.by_light(index),
            None => Vec::new(),
        };
        let (image, mut bins, marks) = ramp_samples(field, material, &lookups, &lights, ink);
        if bins.is_empty() && !is_not_counted(field) && !is_forward {
            // Reserves the space of the histogram, so that nothing moves under the pointer when it arrives.
            bins.push((ink, Vec::new()));
        }
        let across = (bins, marks);
        let edited = ramp_stops::editor(ui, session, ramp, &across, &AxisSamples::default());
        let at = edited.map(|position| position.map(|position| position.x)).unwrap_or_else(|| {
            let at = strip(ui, &spoken, image, filter, &across.1);
            let rows = image.size().y;
            if is_diffuse(field) && rows > 1 {
                ui.weak(format!("{rows} rows by amount: thin smoke at the bottom"));
            }
            let name = if is_diffuse(field) { "Histogram of N·L" } else { "Histogram of amounts" };
            histogram(ui, name, ui.available_width(), &across.0);
            at
        });
        if field == "diffuse_ramp" && lookups.survey.is_some() {
            if lights.is_empty() {
                ui.weak("No light reaches the smoke in this image");
            } else {
                legend(ui, session, &lights);
            }
        }
        ramp_position = ramp_position.or(at.and_then(|at| match field {
            "diffuse_ramp" | "backlight_ramp" => Some(RampPosition::Diffuse(at)),
            "soft_scatter_ramp" => Some(RampPosition::SoftScatter(at)),
            "coverage_ramp" => Some(RampPosition::Coverage(at)),
            _ => None,
        }));
    }
    session.follow_ramps(true);
    ramp_position
}

/// Lookups of a system's ramps: by the image, and by the probed pixel.
struct Lookups<'a> {
    system: usize,
    /// `None` until it is there, and on the forward path.
    survey: Option<&'a RampSurvey>,
    probe: Option<&'a SystemProbe>,
    is_forward: bool,
}

/// Ramp with two axes, as the tab shows it.
struct TwoAxes<'a> {
    ramp: TwoAxisRamp,
    image: &'a Ramp,
    /// Explanation of the axes.
    axes: &'static str,
    /// Name of the histogram along the bottom axis.
    histogram: &'static str,
}

/// Returns the ramp in a field, if it has two axes.
fn two_axes<'a>(field: &str, material: &'a MaterialAssets) -> Option<TwoAxes<'a>> {
    Some(match field {
        "shadow_ramp" => TwoAxes {
            ramp: TwoAxisRamp::Shadow,
            image: &material.shadow_ramp,
            axes: "Across: smoke in front of the light. Up: light from the viewer's side to light from behind.",
            histogram: "Histogram of smoke in front of lights",
        },
        "specular_ramp" => TwoAxes {
            ramp: TwoAxisRamp::Specular,
            image: &material.specular_ramp,
            axes: "Across: squared distance from the light. Up: amount.",
            histogram: "Histogram of squared distances",
        },
        "fire_ramp" => TwoAxes {
            ramp: TwoAxisRamp::Fire,
            image: &material.fire_ramp,
            axes: "Across: heat. Up: amount of the smoke that burns, times boost.",
            histogram: "Histogram of heat",
        },
        _ => return None,
    })
}

/// Ramp of a system, as the tab shows it.
struct RampEntry {
    field: &'static str,
    title: &'static str,
    tooltip: &'static str,
    switch: Option<RampSwitch>,
}

/// Setting that turns a ramp on: its path below the system, and the value to set.
struct RampSwitch {
    label: &'static str,
    setting: &'static str,
    value: &'static str,
}

const fn ramp(
    field: &'static str,
    title: &'static str,
    tooltip: &'static str,
    switch: Option<RampSwitch>,
) -> RampEntry {
    RampEntry { field, title, tooltip, switch }
}

const fn switch(label: &'static str, setting: &'static str, value: &'static str) -> Option<RampSwitch> {
    Some(RampSwitch { label, setting, value })
}

/// Explanation of two terms in the titles.
const AMOUNT: &str = "Amount: smoke along the line of sight, 0 (none) to 1 (opaque)";
const COVERAGE: &str = "Coverage: how much the smoke hides. Boost multiplies the amount into it.";

/// All ramps, in the order of the tab.
const RAMPS: [RampEntry; 9] = [
    ramp("diffuse_ramp", "Diffuse", "Color by the angle between the surface of the smoke and the light", None),
    ramp(
        "backlight_ramp",
        "Diffuse, backlit",
        "Color of smoke between the viewer and the light",
        switch("Turn on backlight ramp", "settings.diffuse.backlight", "ramp"),
    ),
    ramp(
        "shadow_ramp",
        "Shadow",
        "Light that remains behind smoke, by the smoke in front of the light and the angle of the light",
        switch("Turn on shadows", "settings.shadow.strength", "1"),
    ),
    ramp(
        "soft_scatter_ramp",
        "Soft scatter, by amount",
        AMOUNT,
        switch("Turn on soft scatter ramp", "settings.soft_scatter.mode", "ramp"),
    ),
    ramp(
        "specular_ramp",
        "Specular, by distance and amount",
        "Glow of a light through the smoke",
        switch("Turn on specular scatter", "settings.specular_scatter.intensity", "1"),
    ),
    ramp(
        "coverage_ramp",
        "Coverage, by amount × boost",
        COVERAGE,
        switch("Turn on coverage ramp", "settings.coverage", "ramp"),
    ),
    ramp(
        "age_ramp",
        "Age, from birth to death",
        "Color of particles over their lifetime",
        switch("Turn on color by age", "settings.sprite.age_color", "1"),
    ),
    ramp(
        "heat_ramp",
        "Heat, from birth to death",
        "Heat of particles over their lifetime",
        switch("Turn on fire", "settings.fire.intensity", "1"),
    ),
    ramp(
        "fire_ramp",
        "Fire, by heat and amount",
        "Color of the fire",
        switch("Turn on fire", "settings.fire.intensity", "1"),
    ),
];

/// Draws the reason why a ramp is not used. If one setting turns it on, draws a button for it instead.
fn off(ui: &mut Ui, session: &mut Session, system: usize, field: &str, switch: Option<&RampSwitch>, reason: &str) {
    let turned_on = switch.and_then(|switch| {
        let mut preset = session.document.preset.clone();
        preset.set_field(&format!("systems[{system}].{}", switch.setting), switch.value).ok()?;
        let path = format!("systems[{system}].material.{field}");
        session.no_effect_reason(&preset, &path).is_none().then_some((switch.label, preset))
    });
    let Some((label, preset)) = turned_on else {
        ui.weak(format!("Off: {reason}"));
        return;
    };
    ui.horizontal(|ui| {
        ui.weak("Off");
        let button = ui.button(label);
        let name = format!("{label}: {}", display_name(field));
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if button.clicked() {
            session.document.preset = preset;
        }
    });
}

fn is_diffuse(field: &str) -> bool {
    matches!(field, "diffuse_ramp" | "backlight_ramp")
}

/// True for ramps whose lookups are not counted: each particle looks them up, not each pixel.
fn is_not_counted(field: &str) -> bool {
    matches!(field, "age_ramp" | "heat_ramp")
}

/// Returns a ramp with one axis, the histograms of the coordinates that the image samples, and the marks of the probed
/// pixel. `lights`: histograms of the diffuse ramps.
fn ramp_samples<'a>(
    field: &str,
    material: &'a MaterialAssets,
    lookups: &Lookups<'_>,
    lights: &[Histogram],
    ink: Color32,
) -> (&'a Ramp, Vec<Bins>, Vec<Mark>) {
    let Lookups { system, survey, probe, .. } = *lookups;
    let one = |at: Option<f32>| at.map(|at| (at, Color32::WHITE)).into_iter().collect();
    match field {
        "diffuse_ramp" | "backlight_ramp" => {
            let looking = probe.iter().flat_map(|probe| &probe.lights);
            let marks = looking.map(|light| (light.coordinate, mark_color(Some(light.light)))).collect();
            let bins = lights.iter().map(|of| (bins_color(of.light, ink), of.bins.clone()));
            let ramp = if field == "diffuse_ramp" { &material.diffuse_ramp } else { &material.backlight_ramp };
            (ramp, bins.collect(), marks)
        }
        "soft_scatter_ramp" => {
            let bins = survey.map(|survey| (ink, survey.by_amount(system)));
            (&material.soft_scatter_ramp, bins.into_iter().collect(), one(probe.map(|probe| probe.amount)))
        }
        "coverage_ramp" => {
            let bins = survey.map(|survey| (ink, survey.by_coverage(system)));
            let at = probe.map(|probe| probe.coverage_coordinate);
            (&material.coverage_ramp, bins.into_iter().collect(), one(at))
        }
        "heat_ramp" => (&material.heat_ramp, Vec::new(), Vec::new()),
        _ => (&material.age_ramp, Vec::new(), Vec::new()),
    }
}

/// Draws a ramp with two axes, then its editor, or, if it has no stops, the histograms along the bottom axis. Returns the
/// place under the pointer.
fn two_axis_ramp(
    ui: &mut Ui,
    session: &mut Session,
    named: NamedRamp<'_>,
    two_axes: &TwoAxes<'_>,
    filter: RampFilter,
    lookups: &Lookups<'_>,
) -> Option<RampPosition> {
    let ramp = two_axes.ramp;
    let ink = ui.visuals().text_color();
    let width = ui.available_width().min(PLANE_WIDTH);
    let display = if ramp == TwoAxisRamp::Fire { FireDisplay::choose(ui, session, lookups.system) } else { None };
    let shown = |light: glam::Vec3| display.as_ref().map_or(light, |display| display.shown(light));
    let color = |at| shown(sample_ramp_2d(two_axes.image, filter, at));
    let position = plane(ui, &display_name(named.field), width, ramp, lookups, color);
    let histograms = |axis| lookups.survey.map_or_else(Vec::new, |survey| survey.along(axis, ramp, lookups.system));
    let marks: Vec<_> = lookups.probe.into_iter().flat_map(|probe| ramp.lookups(probe)).collect();
    let samples = |axis: usize, histograms: &[Histogram]| {
        let mut bins: Vec<_> = histograms.iter().map(|of| (bins_color(of.light, ink), of.bins.clone())).collect();
        if bins.is_empty() && !lookups.is_forward {
            // Reserves the space.
            bins.push((ink, Vec::new()));
        }
        (bins, marks.iter().map(|(light, at)| (at[axis], mark_color(*light))).collect())
    };
    let of_lights = histograms(0);
    let across: AxisSamples = samples(0, &of_lights);
    let edited = if ramp_stops::has_stops(session, named) {
        ui.weak(two_axes.axes);
        ramp_stops::editor(ui, session, named, &across, &samples(1, &histograms(1))).flatten()
    } else {
        histogram(ui, two_axes.histogram, width, &across.0);
        ui.weak(two_axes.axes);
        None
    };
    if ramp != TwoAxisRamp::Fire && !lookups.is_forward {
        legend(ui, session, &of_lights);
    }
    position.or(edited.map(|at| RampPosition::TwoAxes(ramp, at)))
}

/// Draws the title of a ramp and the choice of its image.
fn choose(ui: &mut Ui, session: &mut Session, title: &str, tooltip: &str, path: &str, name: &str) {
    let label = ui.strong(title).on_hover_text(tooltip);
    let mut chosen = name.to_owned();
    gallery(ui, &session.thumbnails, ImageRole::Ramp, &mut chosen, path).labelled_by(label.id);
    if chosen != name
        && let Err(error) = set_field(&mut session.document.preset, path, &chosen)
    {
        session.messages.error("ramp", error);
    }
}

/// Color of the histogram of a light, or of fire.
fn bins_color(light: Option<usize>, ink: Color32) -> Color32 {
    light.map_or(ink, |index| LIGHT_COLORS[index % LIGHT_COLORS.len()])
}

/// Color of the mark of a light, or of fire.
fn mark_color(light: Option<usize>) -> Color32 {
    bins_color(light, Color32::WHITE)
}

/// Allocates space for an image with a name. Returns the pointer position in it, in fractions of its sides.
fn space(ui: &mut Ui, size: Vec2, name: &str) -> (Rect, Option<Vec2>) {
    let (rect, response): (Rect, Response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name));
    (rect, response.hover_pos().map(|at| (at - rect.min) / rect.size()))
}

/// Draws a ramp from left to right with marks. Returns the coordinate under the pointer.
fn strip(ui: &mut Ui, name: &str, ramp: &Ramp, filter: RampFilter, marks: &[(f32, Color32)]) -> Option<f32> {
    let rows = ramp.size().y;
    let height = if rows > 1 { 2.0 * RAMP_HEIGHT } else { RAMP_HEIGHT };
    let (rect, at) = space(ui, Vec2::new(ui.available_width(), height), name);
    paint_cells(ui, rect, UVec2::new(128, rows.min(MAX_STRIP_ROWS)), |at| {
        sample_ramp_2d(ramp, filter, glam::Vec2::new(at.x, 1.0 - at.y))
    });
    for &(coordinate, color) in marks {
        let x = rect.left() + coordinate * rect.width();
        for (width, color) in [(4.0, Color32::BLACK), (2.0, color)] {
            ui.painter().vline(x, rect.y_range(), Stroke::new(width, color));
        }
    }
    at.map(|at| at.x)
}

/// Draws a linear image from a function of the position, in fractions of its sides, cell by cell.
fn paint_cells(ui: &Ui, rect: Rect, cells: UVec2, color: impl Fn(glam::Vec2) -> glam::Vec3) {
    let mut mesh = Mesh::default();
    let side = rect.size() / Vec2::new(cells.x as f32, cells.y as f32);
    for y in 0..cells.y {
        for x in 0..cells.x {
            let at = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / cells.as_vec2();
            let [r, g, b] = color(at).to_array();
            let corner = rect.min + Vec2::new(x as f32, y as f32) * side;
            mesh.add_colored_rect(Rect::from_min_size(corner, side), egui::Rgba::from_rgb(r, g, b).into());
        }
    }
    ui.painter().add(mesh);
}

/// Draws histograms on top of each other.
fn histogram(ui: &mut Ui, name: &str, width: f32, histograms: &[Bins]) {
    if histograms.is_empty() {
        return;
    }
    let (rect, _) = space(ui, Vec2::new(width, HISTOGRAM_HEIGHT), name);
    ui.painter().rect_filled(rect, 0.0, ui.visuals().extreme_bg_color);
    histograms.iter().for_each(|(color, bins)| egui_gradient::histogram(ui, rect, bins, *color));
}

/// Draws the names of lights in the colors of their histograms.
fn legend(ui: &mut Ui, session: &Session, histograms: &[Histogram]) {
    let names = session.view.lights.shown_names(&session.document.preset.lights);
    ui.horizontal_wrapped(|ui| {
        for light in histograms.iter().filter_map(|histogram| histogram.light) {
            ui.colored_label(mark_color(Some(light)), name_in_image(&names, light));
        }
    });
}

/// Draws a ramp with two axes, the second upwards, and the sampled positions over it. `color`: linear, at a position.
fn plane(
    ui: &mut Ui,
    name: &str,
    width: f32,
    ramp: TwoAxisRamp,
    lookups: &Lookups<'_>,
    color: impl Fn(glam::Vec2) -> glam::Vec3,
) -> Option<RampPosition> {
    let (rect, at) = space(ui, Vec2::new(width, 0.6 * width), name);
    paint_cells(ui, rect, UVec2::splat(48), |at| color(glam::Vec2::new(at.x, 1.0 - at.y)));
    let mut mesh = Mesh::default();
    let cell = rect.size() / SIDE as f32;
    let density = lookups.survey.map_or_else(Vec::new, |survey| survey.over_both_axes(ramp, lookups.system));
    for (index, density) in density.iter().enumerate().filter(|(_, density)| **density > 0.0) {
        let column = (index % SIDE) as f32;
        let row = (index / SIDE) as f32;
        let below = color((glam::Vec2::new(column, row) + 0.5) / SIDE as f32);
        let color = if luminance(below) < MIDDLE_GRAY { SAMPLED_OVER_DARK } else { SAMPLED_OVER_LIGHT };
        let corner = rect.min + Vec2::new(column, (SIDE - 1) as f32 - row) * cell;
        // Even the rarest positions stay visible.
        mesh.add_colored_rect(Rect::from_min_size(corner, cell), color.gamma_multiply(0.15 + 0.7 * density.sqrt()));
    }
    ui.painter().add(mesh);
    for (light, at) in lookups.probe.into_iter().flat_map(|probe| ramp.lookups(probe)) {
        let position = rect.min + Vec2::new(at.x, 1.0 - at.y) * rect.size();
        ui.painter().circle(position, 4.0, mark_color(light), Stroke::new(1.5, Color32::BLACK));
    }
    at.map(|at| RampPosition::TwoAxes(ramp, glam::Vec2::new(at.x, 1.0 - at.y)))
}
