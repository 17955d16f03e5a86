//! Cost tab: time of the smoke by pass, what is drawn, memory by use, and a budget.

use std::collections::HashSet;

use eframe::egui::{self, Color32, Rect, Sense, Ui, pos2, vec2};

use haze_core::settings::ScaleMode;

use super::rows::setting_rows::{self, RowContext};
use super::rows::value_text::grouped;
use crate::document::display_names::display_name;
use crate::session::Session;
use crate::viewport_renderer::RenderStats;
use crate::viewport_renderer::cached_render::set_scale;
use crate::viewport_renderer::frame_timings::{FrameTimings, MAX_KEPT_IMAGES};
use crate::viewport_renderer::smoke_times::TimeSource;

/// Height of the plot, points.
const PLOT: f32 = 120.0;

/// Colors that are distinguishable on light and dark backgrounds, also with color blindness.
const COLORS: [Color32; 7] = [
    Color32::from_rgb(230, 159, 0),
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(204, 121, 167),
    Color32::from_rgb(0, 114, 178),
    Color32::from_rgb(170, 160, 60),
];

pub fn panel(ui: &mut Ui, session: &mut Session) {
    egui::ScrollArea::vertical().id_salt("performance").auto_shrink(false).show(ui, |ui| {
        times(ui, &session.timings);
        section(ui, "Budget", |ui| budget(ui, session));
        section(ui, "Drawn", |ui| drawn(ui, &session.timings));
        section(ui, "Memory", |ui| memory(ui, &session.timings));
    });
}

fn section(ui: &mut Ui, title: &str, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(title).default_open(true).show(ui, add);
}

/// Draws the time of each pass, and the stacked times of the last images.
fn times(ui: &mut Ui, timings: &FrameTimings) {
    ui.label(match timings.stats.time_source {
        TimeSource::Timestamps => "GPU time of the smoke by pass",
        TimeSource::WallTime => "Wall time of the smoke (this adapter is the CPU)",
        TimeSource::CpuTime => "CPU time of each frame (this device cannot measure GPU time)",
    });
    plot(ui, timings);
    egui::Grid::new("passes").num_columns(3).min_col_width(0.0).striped(true).show(ui, |ui| {
        for (index, name) in timings.names.iter().enumerate() {
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            ui.painter().rect_filled(rect, 1.0, COLORS[index % COLORS.len()]);
            ui.label(display_name(name));
            ui.monospace(format!("{:6.3} ms", timings.mean(index)));
            ui.end_row();
        }
        ui.label("");
        ui.strong("Total");
        // The sum of an empty iterator is -0.
        let sum = (0..timings.names.len()).map(|index| timings.mean(index)).sum::<f32>().max(0.0);
        ui.monospace(format!("{sum:6.3} ms"));
        ui.end_row();
    });
    ui.weak(match timings.frame_times.len() {
        0 | 1 => "Last frame".into(),
        count => format!("Average of the last {count} frames"),
    });
}

fn plot(ui: &mut Ui, timings: &FrameTimings) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), PLOT), Sense::hover());
    let limit = timings.is_held.then_some(timings.budget.milliseconds);
    let sums = timings.frame_times.iter().map(|image| image.iter().sum::<f32>());
    let most = sums.fold(limit.unwrap_or(0.0), f32::max).max(0.001) * 1.1;
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Time of the last frames"));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let height = |ms: f32| ms / most * rect.height();
    let width = rect.width() / MAX_KEPT_IMAGES as f32;
    for (index, image) in timings.frame_times.iter().enumerate() {
        let left = rect.right() - (timings.frame_times.len() - index) as f32 * width;
        let mut bottom = rect.bottom();
        for (ms, color) in image.iter().zip(COLORS.iter().cycle()) {
            let top = bottom - height(*ms);
            painter.rect_filled(Rect::from_min_max(pos2(left, top), pos2(left + width, bottom)), 0.0, *color);
            bottom = top;
        }
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let text = |y: f32, align, text| {
        painter.text(pos2(rect.left() + 3.0, y), align, text, font.clone(), ui.visuals().text_color())
    };
    text(rect.top() + 2.0, egui::Align2::LEFT_TOP, format!("{most:.2} ms"));
    if let Some(limit) = limit {
        let y = rect.bottom() - height(limit);
        painter.hline(rect.x_range(), y, egui::Stroke::new(1.0, ui.visuals().text_color()));
        text(y, egui::Align2::LEFT_BOTTOM, format!("{limit} ms"));
    }
}

fn budget(ui: &mut Ui, session: &mut Session) {
    let timings = &mut session.timings;
    let hint = "Lowers the resolution of the smoke until it meets the budget. The preset does not change.";
    ui.add_enabled_ui(timings.stats.time_source != TimeSource::CpuTime, |ui| {
        let text = format!("Keep the smoke under {} ms", timings.budget.milliseconds);
        ui.checkbox(&mut timings.is_held, text)
            .on_hover_text(hint)
            .on_disabled_hover_text("This device cannot measure GPU time");
    });
    let mut context = RowContext {
        tooltips: &timings.tooltips,
        thumbnails: &session.thumbnails,
        changed: &HashSet::new(),
        reason_without_effect: &|_| None,
        second: None,
        has_sheets: false,
        keys: None,
        requests: Vec::new(),
        refused: None,
        searched_path: None,
    };
    let before = timings.budget;
    setting_rows::show(ui, &mut context, &[], &mut timings.budget);
    let refused = context.refused;
    let is_edited = session.timings.budget != before;
    session.report_refused_input(refused, is_edited);
    let timings = &session.timings;
    let preset = &mut session.document.preset;
    let of_preset = preset.systems.first().map(|system| &system.settings.accumulate);
    let of_preset =
        of_preset.filter(|accumulate| accumulate.scale_mode == ScaleMode::Fixed).map(|fixed| fixed.downscale);
    let Some(scale) = timings.scale() else { return };
    ui.horizontal_wrapped(|ui| {
        let of_preset_text = of_preset.map_or("automatic".into(), |scale| scale.to_string());
        ui.label(format!("Current scale: {scale} (preset: {of_preset_text})"));
        let keep = egui::Button::new("Use this scale");
        if ui
            .add_enabled(Some(scale) != of_preset, keep)
            .on_hover_text("Sets this scale in every system of the preset")
            .clicked()
        {
            set_scale(preset, scale);
        }
    });
}

fn drawn(ui: &mut Ui, timings: &FrameTimings) {
    let RenderStats { counts, overdraw, .. } = &timings.stats;
    rows(
        ui,
        "drawn",
        &[
            ("Visible systems", counts.systems.to_string(), "Systems in the image"),
            ("Sprites", grouped(counts.sprites), "Sprites of these systems"),
            (
                "Fragments",
                grouped(overdraw.fragments.round() as u64),
                "Area of all sprites in texels. Each texel is shaded unless the scene hides it.",
            ),
            (
                "Average overdraw",
                format!("{:.2}", overdraw.mean()),
                "Sprites on top of each other, averaged over their box",
            ),
            ("Texels", grouped(counts.texels), "Texels of the smoke buffers in use"),
        ],
    );
    // Empty for systems that leave no choice.
    for choice in &timings.stats.choices {
        ui.label(format!("Automatic path: {choice}"));
    }
    for choice in &timings.stats.scale_choices {
        ui.label(format!("Automatic scale: {choice}")).on_hover_text(
            "The coarsest scale whose predicted error is within the limit of the preset, \"Largest error\"",
        );
    }
    for choice in &timings.stats.lighting_choices {
        ui.label(format!("Automatic lighting resolution: {choice}")).on_hover_text(
            "Smoke is lit once per texel (target) where no ramp has hard steps, and else once per pixel (full)",
        );
    }
}

fn memory(ui: &mut Ui, timings: &FrameTimings) {
    let memory = &timings.stats.memory;
    let beside = timings.stats.other_memory;
    rows(
        ui,
        "memory",
        &[
            ("Smoke buffers", size(memory.smoke.targets), "Accumulation targets, reduced depths and baked light"),
            ("Particles", size(memory.smoke.buffers), "Buffers of particles and uniforms"),
            (
                "Of these, tiled path",
                size(memory.smoke.tiled.total()),
                "Path: the way sprites are drawn. `tiled` keeps sorted lists of the visible particles.",
            ),
            ("Materials", size(memory.materials), "Ramps and sprites"),
            ("Scene", size(memory.scene), "Buffers of the scene, and the image"),
            ("Thumbnails and image B", size(beside), "Debug views below the image, and the compared image"),
        ],
    );
}

fn rows(ui: &mut Ui, salt: &str, rows: &[(&str, String, &str)]) {
    egui::Grid::new(salt).num_columns(2).striped(true).show(ui, |ui| {
        for (name, value, tooltip) in rows {
            ui.label(*name).on_hover_text(*tooltip);
            ui.monospace(value);
            ui.end_row();
        }
    });
}

/// Formats a number of bytes.
fn size(bytes: u64) -> String {
    format!("{:8.2} MiB", bytes as f64 / 1024.0 / 1024.0)
}

#[cfg(test)]
mod tests {
    use eframe::wgpu;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;

    use super::*;
    use crate::window::Window;
    use crate::window::testing::{measured, screenshot, window};

    /// Opens the tab and waits until nothing more is measured.
    fn settle(harness: &mut Harness<'_, Window>) {
        for _ in 0..600 {
            screenshot(harness);
            if !harness.ctx.has_requested_repaint() {
                return;
            }
        }
        panic!("the window does not come to rest");
    }

    fn scale(harness: &mut Harness<'_, Window>) -> Option<u32> {
        harness.state_mut().session_mut().timings.scale()
    }

    #[test]
    fn every_pass_is_listed_by_name_only_while_the_tab_is_open() {
        let mut harness = measured("column", vec2(1000.0, 700.0));
        screenshot(&mut harness);
        assert!(harness.state_mut().session_mut().timings.frame_times.is_empty());
        harness.get_by_label("Cost").click();
        settle(&mut harness);
        let timings = &harness.state_mut().session_mut().timings;
        assert_eq!(timings.stats.time_source, TimeSource::Timestamps);
        let names = timings.names.clone();
        let memory = timings.stats.memory;
        let of_shadow = ["density_splat", "shadow_visibility", "shadow_march"];
        let of_all = [
            "depth_downsample",
            "accumulate",
            "light_target",
            "depth_slopes",
            "mark_cells",
            "transfer",
            "specular_scatter",
        ];
        assert_eq!(names, [of_shadow.as_slice(), &of_all].concat());
        for name in names.iter().chain(&[
            "Smoke buffers",
            "Particles",
            "Materials",
            "Scene",
            "Sprites",
            "Fragments",
            "Average overdraw",
            "Texels",
        ]) {
            let name = display_name(name);
            assert!(harness.query_all_by_label(&name).next().is_some(), "{name}");
        }
        assert!(memory.smoke.targets > 0 && memory.smoke.buffers > 0 && memory.materials > 0 && memory.scene > 0);
        assert!(harness.query_by_label_contains("Automatic lighting resolution: target: the largest step").is_some());
        harness.get_by_label("Look").click();
        settle(&mut harness);
        let timings = &harness.state_mut().session_mut().timings;
        assert!(timings.frame_times.is_empty());
    }

    #[test]
    fn a_small_budget_lowers_the_shown_resolution_and_not_the_preset() {
        let mut harness = measured("column", vec2(640.0, 760.0));
        let before = harness.state_mut().session_mut().document.preset.clone();
        let session = harness.state_mut().session_mut();
        session.view.tab = crate::session::view_options::Tab::Performance;
        session.timings.budget = haze_core::settings::Budget { milliseconds: 0.05, ..Default::default() };
        harness.run_steps(2);
        assert_eq!(scale(&mut harness), None);
        harness.get_by_label("Keep the smoke under 0.05 ms").click();
        settle(&mut harness);
        let of_preset = before.systems[0].settings.accumulate.downscale;
        assert_eq!(scale(&mut harness), Some(8), "the coarsest that the budget allows");
        assert!(of_preset < 8 && harness.state_mut().session_mut().document.preset == before);
        harness.get_by_label("Use this scale").click();
        settle(&mut harness);
        assert_eq!(harness.state_mut().session_mut().document.preset.systems[0].settings.accumulate.downscale, 8);
        // Without the budget, the preset's scale is shown again.
        harness.get_by_label("Keep the smoke under 0.05 ms").click();
        settle(&mut harness);
        assert_eq!(scale(&mut harness), None);
    }

    #[test]
    fn on_a_cpu_adapter_the_tab_shows_the_wall_time_of_the_smoke() {
        let mut harness = window("column", vec2(1000.0, 700.0), egui::Theme::Dark);
        harness.get_by_label("Cost").click();
        settle(&mut harness);
        let timings = &harness.state_mut().session_mut().timings;
        assert_eq!((timings.stats.time_source, &timings.names[..]), (TimeSource::WallTime, &["Smoke"][..]));
        assert!(timings.mean(0) > 0.0);
        harness.get_by_label_contains("Wall time of the smoke");
    }

    #[test]
    fn without_timestamps_a_gpu_shows_the_cpu_time_of_frames() {
        let features = wgpu::Features::empty();
        let mut adapter = wgpu::AdapterInfo::new(wgpu::DeviceType::DiscreteGpu, wgpu::Backend::Vulkan);
        assert_eq!(TimeSource::of(&adapter, features), TimeSource::CpuTime);
        assert_eq!(TimeSource::of(&adapter, wgpu::Features::TIMESTAMP_QUERY), TimeSource::Timestamps);
        adapter.device_type = wgpu::DeviceType::Cpu;
        assert_eq!(TimeSource::of(&adapter, wgpu::Features::TIMESTAMP_QUERY), TimeSource::WallTime);
    }
}
