//! Rows for a settings struct: each field of its table with range, unit and doc comment.

use std::collections::{HashMap, HashSet};
use std::ops::RangeInclusive;

use eframe::egui::{self, Ui};
use glam::Vec3;
use haze_author::preset::Tooltips;
use haze_core::settings::{BackdropKind, Choice, Curve, FieldValue, FieldVisitor, Fields, ImageRole, field_path};
use haze_preset::backdrop_endings;

use super::curve_editor;
use super::image_gallery::gallery;
use super::key_mark::KeyMarks;
use super::value_text::shown_value;
use super::{Row, RowRequest, value_control};
use crate::document::display_names::display_name;
use crate::session::image_thumbnails::ImageThumbnails;
use crate::session::slider_range::UsualRange;

/// Step on the path to a field: its name, and its index if it is in a list.
pub type FieldStep = (&'static str, Option<usize>);

/// Data that rows read, and requests that they return.
pub struct RowContext<'a> {
    pub tooltips: &'a Tooltips,
    /// Thumbnails of images.
    pub thumbnails: &'a ImageThumbnails,
    /// Paths of the fields that differ from the preset on disk.
    pub changed: &'a HashSet<String>,
    /// Values of the second image's settings that differ, by path; `None` if it has no settings of its own.
    pub second: Option<&'a HashMap<String, FieldValue>>,
    /// The fields belong to the preset, so sheets of their values can be made.
    pub has_sheets: bool,
    /// Keyframes of the preset's settings; `None` if the fields cannot have any.
    pub keys: Option<&'a KeyMarks>,
    /// Returns the reason why the field of a path has no effect.
    pub reason_without_effect: &'a dyn Fn(&str) -> Option<&'static str>,
    /// Requests, with the paths of their fields.
    pub requests: Vec<(RowRequest, String)>,
    /// Reason why typed text was refused.
    pub refused: Option<String>,
    /// Path of the field that is brought into view.
    pub searched_path: Option<&'a str>,
}

impl RowContext<'_> {
    /// Returns the second image's value of a field as text, if it differs; the outer `None` means that it has no
    /// settings of its own.
    pub fn second(&self, path: &str, unit: &str) -> Option<Option<String>> {
        Some(self.second?.get(path).map(|value| shown_value(value, unit)))
    }
}

/// Labels of the button that makes a sheet, for a number, a seed, and all values of a choice or flag.
pub const FIVE_VALUES: Option<&str> = Some("Five values side by side");
const SEEDS: Option<&str> = Some("Nine seeds side by side");
const ALL: Option<&str> = Some("All values side by side");

/// Draws the fields of the struct at `path`. Groups and headings are collapsible; the first heading is open.
pub fn show(ui: &mut Ui, context: &mut RowContext<'_>, path: &[FieldStep], fields: &mut dyn Fields) {
    let table = fields.headings();
    if table.is_empty() {
        show_where(ui, context, path, fields, &|_| true);
    }
    for part in table.chunk_by(|_, (_, heading)| heading.is_none()) {
        let mut rows = |ui: &mut Ui, context: &mut RowContext<'_>| {
            show_where(ui, context, path, fields, &|name| part.iter().any(|(field, _)| *field == name));
        };
        let Some(&(first, Some(heading))) = part.first() else {
            rows(ui, context);
            continue;
        };
        let holds = |field: &str| {
            let below = field.strip_prefix(&field_path(path)).and_then(|rest| rest.strip_prefix('.'));
            part.iter().any(|(name, _)| below.is_some_and(|below| is_at(below, name)))
        };
        let header =
            header(context, &display_name(heading), &holds).id_salt((path, heading)).default_open(first == table[0].0);
        header.show_unindented(ui, |ui| rows(ui, context));
    }
}

/// Draws the fields of a struct whose names are wanted.
pub fn show_where(
    ui: &mut Ui,
    context: &mut RowContext<'_>,
    path: &[FieldStep],
    fields: &mut dyn Fields,
    is_wanted: &dyn Fn(&str) -> bool,
) {
    fields.visit(&mut Rows { ui, context, path: path.to_vec(), is_wanted, only: None });
}

/// Returns a collapsible header. It opens if the searched field is inside, and shows the marks of the fields inside.
pub fn header(context: &RowContext<'_>, title: &str, holds: &dyn Fn(&str) -> bool) -> egui::CollapsingHeader {
    let mark = if context.changed.iter().any(|changed| holds(changed)) { " •" } else { "" };
    let is_apart = context.second.is_some_and(|second| second.keys().any(|apart| holds(apart)));
    let apart = if is_apart { " ≠" } else { "" };
    egui::CollapsingHeader::new(format!("{title}{mark}{apart}"))
        .open(context.searched_path.is_some_and(holds).then_some(true))
}

/// Returns true if a field is at a path or below it.
pub fn is_at(field: &str, path: &str) -> bool {
    field.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

/// One field of a struct.
#[derive(Clone, Copy)]
pub struct LabelledField<'a> {
    /// Replaces its name.
    pub title: &'a str,
    /// Path relative to the struct.
    pub path: &'a str,
    /// Usual range of its slider.
    pub usual: UsualRange,
}

/// Draws one field of the struct at `path`.
pub fn show_named(
    ui: &mut Ui,
    context: &mut RowContext<'_>,
    path: &[FieldStep],
    fields: &mut dyn Fields,
    field: LabelledField<'_>,
) {
    let only = Some(Only { field, depth: path.len() });
    fields.visit(&mut Rows { ui, context, path: path.to_vec(), is_wanted: &|_| true, only });
}

/// Brings the row that begins at a position into view and marks it, because it was searched for.
pub fn scroll_to_and_mark(ui: &Ui, begin: egui::Pos2) {
    let rect = egui::Rect::from_min_max(begin, ui.cursor().min + egui::vec2(ui.available_width(), 0.0));
    ui.scroll_to_rect(rect, Some(egui::Align::Center));
    ui.painter().rect_stroke(rect, 2.0, ui.visuals().selection.stroke, egui::StrokeKind::Outside);
}

struct Rows<'a, 'd, 'u> {
    ui: &'u mut Ui,
    context: &'a mut RowContext<'d>,
    path: Vec<FieldStep>,
    /// Returns true if the field of this name is drawn.
    is_wanted: &'a dyn Fn(&str) -> bool,
    /// Draws a single field; `None` draws all.
    only: Option<Only<'a>>,
}

/// Selection of a single field.
#[derive(Clone, Copy)]
struct Only<'a> {
    field: LabelledField<'a>,
    /// Number of steps to the struct of the field.
    depth: usize,
}

/// Properties of a row that depend on the kind of its field.
#[derive(Clone, Copy)]
struct RowKind<'a> {
    unit: &'a str,
    /// Label of the button that makes a sheet; `None` for no button.
    sheet: Option<&'static str>,
    /// True if the field can have keyframes.
    has_keys: bool,
}

impl RowKind<'_> {
    /// Field without a unit that can have keyframes.
    const ANIMATED: Self = Self { unit: "", sheet: None, has_keys: true };
    /// Field that stays the same over time.
    const FIXED: Self = Self { unit: "", sheet: None, has_keys: false };
}

impl Rows<'_, '_, '_> {
    fn row(
        &mut self,
        name: &'static str,
        RowKind { unit, sheet, has_keys }: RowKind<'_>,
        control: impl FnOnce(&mut Ui, &egui::Response, &mut Option<String>, &str, &Tooltips),
    ) {
        if !(self.is_wanted)(name) {
            return;
        }
        self.path.push((name, None));
        let path = field_path(&self.path);
        let plain = self.path.iter().map(|step| step.0).collect::<Vec<_>>().join(".");
        let below = self.only.map(|only| field_path(&self.path[only.depth..]));
        self.path.pop();
        if self.only.zip(below).is_some_and(|(only, path)| path != only.field.path) {
            return;
        }
        let context = &mut *self.context;
        let second = context.second(&path, unit);
        let title = self.only.map_or(name, |only| only.field.title);
        let mut tooltip = context.tooltips.field(&plain).unwrap_or_default().to_owned();
        if display_name(title) != display_name(name) && self.only.is_some() {
            tooltip += &format!("\n\nIn files: {path}");
        }
        let row = Row {
            name: title,
            tooltip: &tooltip,
            is_changed: context.changed.contains(&path),
            second: second.as_ref().map(Option::as_deref),
            sheet: sheet.filter(|_| context.has_sheets),
            key: context.keys.filter(|_| has_keys).map(|keys| keys.of(&path)),
            reason_without_effect: (context.reason_without_effect)(&path),
        };
        let refused = &mut context.refused;
        let tooltips = context.tooltips;
        let before = self.ui.cursor().min;
        let request = row.show(self.ui, |ui, label| control(ui, label, refused, &path, tooltips));
        context.requests.extend(request.map(|request| (request, path.clone())));
        if let Some(what) = &mut context.refused
            && !what.contains(": ")
        {
            *what = format!("{}: {what}", display_name(title));
        }
        if context.searched_path == Some(path.as_str()) {
            scroll_to_and_mark(self.ui, before);
        }
    }

    fn nested(&mut self, step: FieldStep, title: &str, fields: &mut dyn Fields) {
        if !(self.is_wanted)(step.0) {
            return;
        }
        self.path.push(step);
        if self.only.is_some() {
            let path = self.path.clone();
            fields.visit(&mut Rows { ui: self.ui, context: self.context, path, is_wanted: &|_| true, only: self.only });
        } else {
            let path = field_path(&self.path);
            let header = header(self.context, &display_name(title), &|field| is_at(field, &path)).id_salt(&path);
            header.show(self.ui, |ui| show(ui, self.context, &self.path, fields));
        }
        self.path.pop();
    }
}

impl FieldVisitor for Rows<'_, '_, '_> {
    fn number(&mut self, name: &'static str, value: &mut f32, range: RangeInclusive<f32>, unit: &'static str) {
        let usual = self.only.and_then(|only| only.field.usual);
        self.row(name, RowKind { unit, sheet: FIVE_VALUES, has_keys: true }, |ui, label, refused, _, _| {
            value_control::number(ui, label, value, &range, usual, unit, refused);
        });
    }

    fn integer(&mut self, name: &'static str, value: &mut u32, range: RangeInclusive<u32>, unit: &'static str) {
        self.row(name, RowKind { unit, sheet: FIVE_VALUES, has_keys: true }, |ui, label, refused, _, _| {
            value_control::integer(ui, label, value, &range, unit, refused);
        });
    }

    fn vector(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>, unit: &'static str) {
        self.row(name, RowKind { unit, sheet: None, has_keys: true }, |ui, label, refused, _, _| {
            value_control::vector(ui, value, &range, unit, label, refused);
        });
    }

    fn color(&mut self, name: &'static str, value: &mut Vec3, range: RangeInclusive<f32>) {
        self.row(name, RowKind::ANIMATED, |ui, label, _, _, _| value_control::color(ui, value, &range, label));
    }

    fn curve(&mut self, name: &'static str, value: &mut Curve, range: RangeInclusive<f32>) {
        self.row(name, RowKind::FIXED, |ui, label, _, _, _| {
            curve_editor::curve(ui, value, &range, label);
        });
    }

    fn flag(&mut self, name: &'static str, value: &mut bool) {
        self.row(name, RowKind { sheet: ALL, ..RowKind::ANIMATED }, |ui, label, _, _, _| {
            ui.checkbox(value, "").labelled_by(label.id);
        });
    }

    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        let plain = self.path.iter().map(|step| step.0).chain([name]).collect::<Vec<_>>().join(".");
        self.row(name, RowKind { sheet: ALL, ..RowKind::ANIMATED }, |ui, label, _, path, tooltips| {
            value_control::choice(ui, value, path, |choice| tooltips.choice(&plain, choice)).labelled_by(label.id);
        });
    }

    fn text(&mut self, name: &'static str, value: &mut String) {
        self.row(name, RowKind::FIXED, |ui, label, _, _, _| {
            ui.add(egui::TextEdit::singleline(value).desired_width(f32::INFINITY)).labelled_by(label.id);
        });
    }

    fn image(&mut self, name: &'static str, value: &mut String, role: ImageRole) {
        let thumbnails = self.context.thumbnails;
        self.row(name, RowKind::FIXED, |ui, label, _, path, _| {
            gallery(ui, thumbnails, role, value, path).labelled_by(label.id);
        });
    }

    fn particles(&mut self, name: &'static str, value: &mut String) {
        self.row(name, RowKind::FIXED, |ui, label, _, path, _| {
            value_control::path(ui, value, path, "smoke_####.ply").labelled_by(label.id);
        });
    }

    fn backdrop(&mut self, name: &'static str, value: &mut String, kind: BackdropKind) {
        let mut is_asked = false;
        self.row(name, RowKind::FIXED, |ui, label, _, path, _| {
            is_asked = ui.button("Choose…").on_hover_text("Or drop the file on the window").clicked();
            let hint = format!("none (.{})", backdrop_endings(kind).join(", ."));
            value_control::path(ui, value, path, &hint).labelled_by(label.id);
        });
        if is_asked {
            self.context.requests.push((RowRequest::ChooseBackdrop(kind), String::new()));
        }
    }

    fn seed(&mut self, name: &'static str, value: &mut u32) {
        self.row(name, RowKind { sheet: SEEDS, ..RowKind::FIXED }, |ui, label, _, _, _| {
            ui.add(egui::DragValue::new(value)).labelled_by(label.id);
            if ui.button("Next").clicked() {
                *value = value.wrapping_add(1);
            }
        });
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.nested((name, None), name, fields);
    }

    fn item(&mut self, name: &'static str, index: usize, fields: &mut dyn Fields) {
        self.nested((name, Some(index)), &format!("{} {}", name.trim_end_matches('s'), index + 1), fields);
    }
}
