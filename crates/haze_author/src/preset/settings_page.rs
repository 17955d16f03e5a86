//! Generates `docs/settings.md`, one page with every setting, from the rows and doc comments of the settings.

use std::collections::HashMap;
use std::fmt::{Display, Write as _};
use std::ops::RangeInclusive;

use glam::Vec3;
use haze_core::frame::Light;
use haze_core::settings::{
    BackdropKind, Choice, Curve, FieldValue, FieldVisitor, Fields, ImageRole, MAX_CURVE_POINTS, field_values,
};
use haze_preset::{Ease, Flicker, MAX_KEYFRAMES, Preset, PresetSystem, backdrop_endings, builtin};

use super::no_effect::effect_conditions;
use super::schema::preset_with_widest_ranges;
use super::tooltips::Tooltips;

const HEAD: &str = "\
# Settings

`haze preset settings > docs/settings.md` generates this page from the tables in the code that the sliders of the window use too.
[Another page](looks.md) says which settings to move for which look. A field that is left out of a preset has its default. Fields of
lights are those of each entry of `lights`, fields of systems those of each entry of `systems`. A setting with a *When* has no effect
otherwise: `haze preset check` reports such settings of your preset, and the window grays them out.
";

/// Returns the page as Markdown.
pub fn settings_page() -> String {
    let mut preset = preset_with_widest_ranges();
    let plain = Preset { lights: vec![Light::default()], systems: vec![PresetSystem::default()], ..Preset::default() };
    let defaults = field_values(&plain).into_iter().map(|(path, value)| (path.replace("[0]", ""), value)).collect();
    let mut page = Page { tooltips: Tooltips::of::<Preset>(), defaults, path: Vec::new(), sections: Vec::new() };
    page.section("preset", "Contents of a preset file.".into(), &mut preset);
    page.animation();
    let mut text = HEAD.to_owned();
    for Section { title, description, rows } in page.sections.iter().filter(|section| !section.rows.is_empty()) {
        let head = "| field | what it does | range | default |\n|---|---|---|---|";
        let _ = write!(text, "\n## {title}\n\n{description}\n\n{head}\n{rows}");
    }
    text
}

/// Section of the page: a struct with its fields.
struct Section {
    title: String,
    description: String,
    rows: String,
}

struct Page {
    tooltips: Tooltips,
    /// Defaults by path without list indices.
    defaults: HashMap<String, FieldValue>,
    path: Vec<&'static str>,
    sections: Vec<Section>,
}

impl Page {
    /// Adds a section for the fields of a struct, followed by the sections of its nested structs.
    fn section(&mut self, title: &str, description: String, fields: &mut dyn Fields) {
        self.sections.push(Section { title: title.to_owned(), description, rows: String::new() });
        fields.visit(&mut SectionWriter { section: self.sections.len() - 1, page: self });
    }
}

impl Page {
    /// Adds the sections of tracks, which are no settings of the preset.
    fn animation(&mut self) {
        let description = |page: &Self, path: &str| page.tooltips.field(path).unwrap_or_default().replace('\n', " ");
        let tracks = [
            ("setting", "the full name of a number, vector, color, switch or choice".into(), ""),
            ("keys", format!("at most {MAX_KEYFRAMES} in a preset"), "none"),
            ("period", "0 to 100000 s".into(), "0"),
        ];
        let keys = [
            ("time", "-100000 to 100000 s".into(), ""),
            ("value", "that of the setting".into(), ""),
            ("ease", self.eases(), "`smooth`"),
        ];
        for (title, rows) in [("animation", tracks), ("animation.keys", keys)] {
            let row = |(name, range, default): (&str, String, &str)| {
                let description = description(self, &format!("{title}.{name}"));
                format!("| `{name}` | {description} | {range} | {default} |\n")
            };
            let rows = rows.into_iter().map(row).collect();
            let description = description(self, title);
            self.sections.push(Section { title: title.to_owned(), description, rows });
        }
        let title = "animation.flicker";
        let mut flicker = Flicker::default();
        let defaults = field_values(&flicker).into_iter().map(|(name, value)| (format!("{title}.{name}"), value));
        self.defaults.extend(defaults);
        self.path = vec!["animation", "flicker"];
        self.section(title, description(self, title), &mut flicker);
    }

    fn eases(&self) -> String {
        let ease = |name: &&str| {
            format!("`{name}`: {}", self.tooltips.choice("animation.keys.ease", name).unwrap_or_default())
        };
        Ease::NAMES.iter().map(ease).collect::<Vec<_>>().join("<br>")
    }
}

/// Writes the rows of one section.
struct SectionWriter<'a> {
    page: &'a mut Page,
    section: usize,
}

impl SectionWriter<'_> {
    fn path(&self, name: &'static str) -> String {
        [&self.page.path[..], &[name]].concat().join(".")
    }

    fn row(&mut self, name: &'static str, range: impl Display) {
        let path = self.path(name);
        let mut description =
            self.page.tooltips.field(&path).unwrap_or_default().replace('\n', " ").replace('|', "\\|");
        let when: Vec<_> = effect_conditions(&path).collect();
        if !when.is_empty() {
            let _ = write!(description, " *When: {}.*", when.join("; "));
        }
        let default = self.page.defaults.get(&path).map(shown).unwrap_or_default();
        let rows = &mut self.page.sections[self.section].rows;
        let _ = writeln!(rows, "| `{name}` | {description} | {range} | {default} |");
    }

    fn nested(&mut self, name: &'static str, fields: &mut dyn Fields) {
        let path = self.path(name);
        let description = self.page.tooltips.field(&path).unwrap_or_default().replace('\n', " ");
        self.page.path.push(name);
        self.page.section(&path, description, fields);
        self.page.path.pop();
    }
}

impl FieldVisitor for SectionWriter<'_> {
    fn number(&mut self, name: &'static str, _: &mut f32, range: RangeInclusive<f32>, unit: &'static str) {
        self.row(name, span(&range, unit));
    }

    fn integer(&mut self, name: &'static str, _: &mut u32, range: RangeInclusive<u32>, unit: &'static str) {
        self.row(name, span(&range, unit));
    }

    fn vector(&mut self, name: &'static str, _: &mut Vec3, range: RangeInclusive<f32>, unit: &'static str) {
        self.row(name, format_args!("three numbers, {}", span(&range, unit)));
    }

    fn color(&mut self, name: &'static str, _: &mut Vec3, range: RangeInclusive<f32>) {
        self.row(name, format_args!("linear RGB, {}", span(&range, "")));
    }

    fn curve(&mut self, name: &'static str, _: &mut Curve, range: RangeInclusive<f32>) {
        let points = format_args!("1 to {MAX_CURVE_POINTS} points [x, value], {}", span(&range, ""));
        self.row(name, points);
    }

    fn flag(&mut self, name: &'static str, _: &mut bool) {
        self.row(name, "`true`, `false`");
    }

    fn choice(&mut self, name: &'static str, value: &mut dyn Choice) {
        let path = self.path(name);
        let description = |choice: &&'static str| {
            let description = self.page.tooltips.choice(&path, choice).unwrap_or_default();
            format!("`{choice}`: {}", description.replace('\n', " ").replace('|', "\\|"))
        };
        let choices: Vec<_> = value.names().iter().map(description).collect();
        self.row(name, choices.join("<br>"));
    }

    fn text(&mut self, name: &'static str, _: &mut String) {
        self.row(name, "any text");
    }

    fn image(&mut self, name: &'static str, _: &mut String, role: ImageRole) {
        if role == ImageRole::Ramp {
            return self.row(name, "[a built-in ramp](../ramps/README.md), or a PNG's path");
        }
        let names: Vec<_> = builtin::for_role(role).iter().map(|built_in| format!("`{}`", built_in.name)).collect();
        let or = if names.is_empty() { "" } else { ", or " };
        self.row(name, names.join(", ") + or + "a PNG's path");
    }

    fn particles(&mut self, name: &'static str, _: &mut String) {
        self.row(name, "the path of a [CSV or PLY](particles.md)");
    }

    fn backdrop(&mut self, name: &'static str, _: &mut String, kind: BackdropKind) {
        self.row(name, format!("the path of a [.{} file](scene.md)", backdrop_endings(kind).join(" or .")));
    }

    fn seed(&mut self, name: &'static str, _: &mut u32) {
        self.row(name, "any whole number");
    }

    fn group(&mut self, name: &'static str, fields: &mut dyn Fields) {
        self.nested(name, fields);
    }

    fn item(&mut self, name: &'static str, _: usize, fields: &mut dyn Fields) {
        self.nested(name, fields);
    }
}

fn span<T: Display + PartialEq>(range: &RangeInclusive<T>, unit: &str) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    format!("{} to {}{space}{unit}", range.start(), range.end())
}

fn shown(value: &FieldValue) -> String {
    match value {
        FieldValue::Number(number) => number.to_string(),
        FieldValue::Whole(number) => number.to_string(),
        FieldValue::Vector(vector) => vector.to_array().map(|axis| axis.to_string()).join(", "),
        FieldValue::Curve(curve) => format!("`{}`", serde_json::to_string(curve).unwrap_or_default()),
        FieldValue::Flag(flag) => format!("`{flag}`"),
        FieldValue::Choice(name) => format!("`{name}`"),
        FieldValue::Text(text) if text.is_empty() => "none".into(),
        FieldValue::Text(text) => format!("`{text}`"),
    }
}
