//! Flipbook of the sprite under a light.

use eframe::egui::{self, Color32, Pos2, Rect, Sense, Stroke, Ui, Vec2, pos2};
use haze::{MaterialAssets, Settings};

use crate::panels::rows::icon_button::{self, Icon};
use crate::session::sprite_preview::{SpritePreview, View};
use crate::session::sprite_view::{SPRITE_CHANNELS, SpriteChannel, SpriteView};
use haze_author::light_angles::{Angles, MAX_ELEVATION, from_angles};

/// Largest side of the image in points and in pixels. The image is small, because the CPU draws it.
const SIDE: f32 = 300.0;
const MAX_PIXELS: f32 = 256.0;
/// Least side in points, and largest fraction of the tab's height, which leaves room for the recipe.
const MIN_SIDE: f32 = 96.0;
const SIDE_FRACTION: f32 = 0.42;
/// Rotation of the light, degrees per point of a drag.
const DRAG: f32 = 0.6;

/// Draws the flipbook with its controls.
pub fn panel(
    ui: &mut Ui,
    look: &mut SpriteView,
    painted: &mut Option<SpritePreview>,
    material: &MaterialAssets,
    settings: &Settings,
) {
    look.advance(&material.sprite, ui.input(|input| input.stable_dt));
    ui.horizontal_wrapped(|ui| {
        for (channel, name, tooltip) in SPRITE_CHANNELS {
            let needs_detail = matches!(channel, SpriteChannel::Depth | SpriteChannel::Motion);
            let button = egui::Button::selectable(look.channel == channel, name);
            let button = ui.add_enabled(!needs_detail || material.detail.is_some(), button);
            if button.on_hover_text(tooltip).on_disabled_hover_text("The sprite has no detail map").clicked() {
                look.channel = channel;
            }
        }
    });
    // In a scroll area the available height is unlimited, so the visible part counts.
    let height = ui.available_height().min(ui.clip_rect().height());
    let side = ui.available_width().min(SIDE).min((SIDE_FRACTION * height).max(MIN_SIDE));
    ui.vertical_centered(|ui| image(ui, look, painted, side, material, settings));
    time(ui, look, material.sprite.frame_count());
    if look.channel == SpriteChannel::Lit {
        light(ui, look);
    }
    if look.is_moving() {
        ui.ctx().request_repaint();
    }
}

fn image(
    ui: &mut Ui,
    look: &mut SpriteView,
    painted: &mut Option<SpritePreview>,
    side: f32,
    material: &MaterialAssets,
    settings: &Settings,
) {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Flipbook"));
    // The movement before the drag began does not count.
    if response.dragged() && !response.drag_started() {
        let drag = response.drag_delta() * DRAG;
        look.turn_to(look.light.azimuth + drag.x);
        look.light.elevation = (look.light.elevation - drag.y).clamp(-MAX_ELEVATION, MAX_ELEVATION);
    }
    let to_light = -from_angles(look.light);
    let view = View {
        channel: look.channel,
        frame: look.frame,
        to_light,
        filter: settings.ramp_filter,
        motion: settings.sprite.motion,
        side: (side * ui.pixels_per_point()).clamp(1.0, MAX_PIXELS) as u32,
    };
    let texture = SpritePreview::show(painted, ui.ctx(), view, material);
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    ui.painter().image(texture, rect, whole, Color32::WHITE);
    if look.channel == SpriteChannel::Lit {
        // Marks the direction of the light; hollow if it is behind the sprite.
        let reach = 0.5 * side - 6.0;
        let at = rect.center() + Vec2::new(to_light.x, -to_light.y) * reach;
        let fill = if to_light.z < 0.0 { Color32::TRANSPARENT } else { Color32::WHITE };
        ui.painter().circle(at, 4.0, fill, Stroke::new(1.5, Color32::from_gray(160)));
    }
    response.on_hover_text("Drag to move the light");
}

fn time(ui: &mut Ui, look: &mut SpriteView, count: u32) {
    ui.horizontal(|ui| {
        let (sign, name) =
            if look.is_playing { (Icon::Pause, "Pause flipbook") } else { (Icon::Play, "Play flipbook") };
        if icon_button::button(ui, sign, look.is_playing, name).clicked() {
            look.is_playing = !look.is_playing;
        }
        let rate = egui::DragValue::new(&mut look.rate).range(1.0..=60.0).speed(0.1).max_decimals(1);
        ui.add(rate.suffix(" fps")).on_hover_text("Playback speed of the flipbook, frames per second");
        let name = ui.label("Frame");
        ui.spacing_mut().slider_width = ui.available_width();
        let slider = egui::Slider::new(&mut look.frame, 0.0..=count as f32).show_value(false);
        let slider = slider.clamping(egui::SliderClamping::Never);
        let slider = ui.add(slider).labelled_by(name.id).on_hover_text("A position between two frames blends them");
        if slider.changed() {
            look.is_playing = false;
        }
    });
}

fn light(ui: &mut Ui, look: &mut SpriteView) {
    ui.horizontal_wrapped(|ui| {
        let angle =
            |value, most: f32| egui::DragValue::new(value).range(-most..=most).speed(1.0).max_decimals(1).suffix("°");
        let Angles { azimuth, elevation } = &mut look.light;
        ui.label("Azimuth");
        ui.add(angle(azimuth, 180.0))
            .on_hover_text("Azimuth of the light: 0° is in front of the sprite, 90° to its right");
        ui.label("Elevation");
        ui.add(angle(elevation, MAX_ELEVATION))
            .on_hover_text("Elevation of the light: 0° is level with the sprite, 90° above it");
        ui.checkbox(&mut look.is_turning, "Rotate").on_hover_text("Rotates the light, one turn in 5 seconds");
    });
}
