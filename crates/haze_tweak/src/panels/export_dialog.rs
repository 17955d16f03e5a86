//! Export dialog, with progress, and the sheet that was made.

use eframe::egui::{self, Ui};

use crate::files::export_job::{ExportJob, ExportKind, ExportOptions, FileKind, MAX_PIXELS, Sheet};
use crate::platform::IS_PAGE;
use crate::platform::clock::Duration;
use crate::platform::render_job::{Alpha, Background, BitDepth, Emission, Engine, burns};
use crate::session::Session;
use crate::session::setting_search::matches;

/// Position below the menus and the toolbar of the viewport, points.
const CORNER: [f32; 2] = [24.0, 76.0];

/// Draws the export dialog and the sheet while they are open.
pub fn panel(ui: &Ui, export_job: &mut ExportJob, session: &mut Session) {
    export_job.advance(session);
    let progress = export_job.progress();
    if progress.is_some() {
        // Progress needs frames, but no more than it changes.
        ui.ctx().request_repaint_after(Duration::from_millis(200));
    }
    let mut is_open = export_job.is_open;
    let window = egui::Window::new("Export").default_pos(CORNER).collapsible(false).resizable(false);
    // A long export is always shown and can be stopped, even if it was started from elsewhere.
    let is_long = progress.is_some_and(|(_, count)| count > 1);
    let window = if is_long && !is_open { window } else { window.open(&mut is_open) };
    window.show(ui.ctx(), |ui| match progress {
        Some((done, count)) => {
            let fraction = done as f32 / count.max(1) as f32;
            ui.add(egui::ProgressBar::new(fraction).text(format!("{done} of {count}")));
            if ui.button("Stop").on_hover_text("Files that are already written stay").clicked() {
                export_job.stop();
            }
        }
        None => export_options(ui, export_job, session),
    });
    export_job.is_open = is_open;
    sheet(ui, export_job, session);
}

const BACKGROUNDS: [(&str, Background, &str); 2] = [
    ("Scene", Background::Auto, "The scene of the preset; transparent if that is empty"),
    ("Transparent", Background::Transparent, "The smoke alone, with its opacity in the alpha channel"),
];

const ALPHAS: [(&str, Alpha, &str); 2] = [
    ("Straight", Alpha::Straight, "The smoke's own color, not multiplied by alpha"),
    ("Premultiplied", Alpha::Premultiplied, "The smoke as before black: keeps the glow of fire where alpha is low"),
];

const FLIPBOOK_ALPHAS: [(&str, Option<Alpha>, &str); 3] = [
    ("Auto", None, "Premultiplied if a system burns, straight otherwise"),
    (ALPHAS[0].0, Some(ALPHAS[0].1), ALPHAS[0].2),
    (ALPHAS[1].0, Some(ALPHAS[1].1), ALPHAS[1].2),
];

const EMISSIONS: [(&str, Emission, &str); 2] = [
    ("In the Color", Emission::Contained, "The color is complete; emission.png is for materials that light the smoke"),
    ("Separate", Emission::Separate, "The color is without the light of fire; emission.png is to be added to it"),
];

const FILES: [(&str, (FileKind, BitDepth), &str); 3] = [
    ("PNG", (FileKind::Png, BitDepth::Eight), "8 bits per channel, dithered"),
    ("PNG 16", (FileKind::Png, BitDepth::Sixteen), "16 bits per channel"),
    (
        "EXR",
        (FileKind::Exr, BitDepth::Eight),
        "Linear half floats, premultiplied. Without background: layers for amount, normals, depth, motion and fire",
    ),
];

const ENGINES: [(&str, Engine, &str); 5] = [
    ("Unreal", Engine::Unreal, "Ramps, and HLSL for a Custom node"),
    ("Unity", Engine::Unity, "Ramps, and HLSL for a Custom Function node of Shader Graph"),
    ("Godot", Engine::Godot, "Ramps, and a spatial shader"),
    ("WGSL", Engine::Wgsl, "Ramps, and functions for wgpu and Bevy"),
    ("three.js", Engine::Three, "Ramps, the sprite, and a material"),
];

/// Of flipbooks alone.
const FLIPBOOK_ENGINES: [(&str, Engine, &str); 2] = [
    ("Babylon.js", Engine::Babylon, "With a module that plays the flipbook"),
    ("PlayCanvas", Engine::Playcanvas, "With a module that plays the flipbook"),
];

/// Draws a row of choices.
fn choices<T: Copy + PartialEq>(ui: &mut Ui, name: &str, value: &mut T, choices: &[(&str, T, &str)]) {
    ui.label(name);
    ui.horizontal(|ui| {
        for (name, choice, tooltip) in choices {
            ui.selectable_value(value, *choice, *name).on_hover_text(*tooltip);
        }
    });
    ui.end_row();
}

/// Draws the rows of a flipbook for an engine that no other export has.
fn flipbook_rows(ui: &mut Ui, options: &mut ExportOptions, burns: bool) {
    let max_fade = options.last.saturating_sub(options.first);
    let flipbook = &mut options.engine_flipbook;
    choices(ui, "Alpha", &mut flipbook.alpha, &FLIPBOOK_ALPHAS);
    // A choice can be taken back after the fire is out.
    if burns || flipbook.emission == Emission::Separate {
        choices(ui, "Light of fire", &mut flipbook.emission, &EMISSIONS);
    }
    let about = "Number of frames after the last that are faded into the first, so that it loops; 0: it does not loop";
    let label = ui.label("Loop").id;
    ui.add(egui::DragValue::new(&mut flipbook.loop_fade).range(0..=max_fade)).labelled_by(label).on_hover_text(about);
    ui.end_row();
    let label = ui.label("Six-way maps").id;
    let about = "Two more sheets: the smoke's light from six sides, for an engine that lights it";
    ui.checkbox(&mut flipbook.has_six_way, "").labelled_by(label).on_hover_text(about);
    ui.end_row();
}

fn export_options(ui: &mut Ui, export_job: &mut ExportJob, session: &mut Session) {
    let values = match &export_job.product {
        ExportKind::Values(path) => path.clone(),
        _ => String::new(),
    };
    let products = [
        ("Image", ExportKind::Image),
        ("Sequence", ExportKind::Sequence),
        ("Flipbook", ExportKind::Flipbook),
        ("GIF", ExportKind::Gif),
        ("Flipbook with Normals", ExportKind::EngineFlipbook),
        ("Material", ExportKind::Material),
        ("Debug Views", ExportKind::DebugView),
        ("Nine Seeds", ExportKind::Seeds),
        ("Values of a Setting", ExportKind::Values(values)),
    ];
    ui.horizontal_wrapped(|ui| {
        let is_for_engine = |product: &ExportKind| matches!(product, ExportKind::Material | ExportKind::EngineFlipbook);
        let is_offered = |product: &ExportKind| !IS_PAGE || !is_for_engine(product);
        for (name, product) in products.into_iter().filter(|(_, product)| is_offered(product)) {
            ui.selectable_value(&mut export_job.product, product, name);
        }
    });
    let product = &mut export_job.product;
    let options = &mut export_job.options;
    let is_for_engine = *product == ExportKind::EngineFlipbook;
    let has_cells = is_for_engine || *product == ExportKind::Flipbook;
    let is_moving = has_cells || matches!(product, ExportKind::Sequence | ExportKind::Gif);
    egui::Grid::new("order").num_columns(2).show(ui, |ui| {
        if *product == ExportKind::Material {
            if !ENGINES.iter().any(|(_, engine, _)| *engine == options.engine) {
                options.engine = Engine::default();
            }
            choices(ui, "Engine", &mut options.engine, &ENGINES);
            return;
        }
        if is_for_engine {
            let about = "Conventions of normals and motion vectors; a README tells how to use the files";
            let shared = ENGINES.map(|(name, engine, _)| (name, engine, about));
            let engines: Vec<_> = shared.into_iter().chain(FLIPBOOK_ENGINES).collect();
            choices(ui, "Engine", &mut options.engine, &engines);
            flipbook_rows(ui, options, burns(&session.document.preset));
        }
        let mut row = |name: &str, numbers: [(&mut u32, std::ops::RangeInclusive<u32>); 2]| {
            let label = ui.label(name).id;
            ui.horizontal(|ui| {
                for (number, range) in numbers {
                    ui.add(egui::DragValue::new(number).range(range)).labelled_by(label);
                }
            });
            ui.end_row();
        };
        let size = if is_for_engine { &mut options.frame_size } else { &mut options.size };
        row("Size", [(&mut size.x, 16..=MAX_PIXELS), (&mut size.y, 16..=MAX_PIXELS)]);
        if is_moving {
            row("Frames", [(&mut options.first, 0..=99_999), (&mut options.last, 0..=99_999)]);
        }
        if has_cells {
            row("Rows × columns", [(&mut options.cells.x, 1..=64), (&mut options.cells.y, 1..=64)]);
        }
        if is_moving {
            let label = ui.label("Frames per second").id;
            ui.add(egui::DragValue::new(&mut options.rate).range(1.0..=50.0)).labelled_by(label);
            ui.end_row();
        }
        if matches!(product, ExportKind::Image | ExportKind::Sequence | ExportKind::Flipbook) {
            let has_exr = !IS_PAGE && *product != ExportKind::Flipbook;
            let files = if has_exr { &FILES[..] } else { &FILES[..2] };
            // A flipbook is one PNG.
            let mut file = (if has_exr { options.file } else { FileKind::Png }, options.format.bits);
            choices(ui, "File", &mut file, files);
            if has_exr {
                options.file = file.0;
            }
            options.format.bits = file.1;
            choices(ui, "Background", &mut options.format.background, &BACKGROUNDS);
            let background = options.format.background.resolved(&session.document.preset, session.view.debug_view);
            if file.0 == FileKind::Png && background == Background::Transparent {
                choices(ui, "Alpha", &mut options.format.alpha, &ALPHAS);
            }
        }
    });
    if let ExportKind::Values(path) = product {
        let edit = egui::TextEdit::singleline(&mut export_job.wanted).hint_text("Find a setting");
        ui.add(edit).widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Setting to vary"));
        let found = matches(&session.document.preset, &session.tooltips, &session.view.lights, &export_job.wanted);
        for found in found.into_iter().take(6) {
            let is_chosen = found.path == *path;
            if ui.selectable_label(is_chosen, &found.name).on_hover_text(&found.tooltip).clicked() {
                path.clone_from(&found.path);
            }
        }
    }
    let is_ready = *product != ExportKind::Values(String::new());
    // A sheet is shown first, and saved from there.
    let text = if product.is_sheet() { "Preview" } else { "Export…" };
    if ui.add_enabled(is_ready, egui::Button::new(text)).clicked() {
        let product = product.clone();
        export_job.start(product, session);
    }
}

fn sheet(ui: &Ui, export_job: &mut ExportJob, session: &mut Session) {
    let Some(Sheet { image, texture, .. }) = &mut export_job.sheet else { return };
    // Uploaded once.
    let texture = texture.get_or_insert_with(|| {
        let size = [image.width() as usize, image.height() as usize];
        let image = egui::ColorImage::from_rgb(size, image);
        ui.ctx().load_texture("sheet", image, egui::TextureOptions::LINEAR)
    });
    let mut is_open = true;
    let mut is_saved = false;
    let room = ui.ctx().content_rect().size() - egui::Vec2::new(60.0, 160.0);
    let window = egui::Window::new("Sheet").default_pos(CORNER).open(&mut is_open).collapsible(false);
    window.show(ui.ctx(), |ui| {
        is_saved = ui.button("Save…").clicked();
        ui.add(egui::Image::new(&*texture).max_size(room).alt_text("Image of the sheet"));
    });
    if is_saved {
        export_job.save_sheet(session);
    } else if !is_open {
        export_job.sheet = None;
    }
}
