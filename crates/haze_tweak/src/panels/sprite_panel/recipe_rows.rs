//! Fields of a recipe as rows.

use std::collections::HashSet;
use std::ops::RangeInclusive;

use eframe::egui::Ui;
use glam::Vec3;
use haze_author::preset::Tooltips;
use haze_core::settings::{FieldVisitor, Fields};

use crate::panels::rows::setting_rows::{self, RowContext};
use crate::session::Session;

/// Draws the fields of a recipe by its table, and returns it as edited. `locked`: the reason why none can be changed.
pub fn rows<R: Fields + Clone>(
    ui: &mut Ui,
    session: &mut Session,
    tooltips: &Tooltips,
    recipe: &R,
    locked: Option<&'static str>,
) -> R {
    let mut edited = recipe.clone();
    let reason_without_effect = |_: &str| locked;
    let unchanged = HashSet::new();
    let requests = Vec::new();
    let mut context = RowContext {
        tooltips,
        thumbnails: &session.thumbnails,
        changed: &unchanged,
        second: None,
        has_sheets: false,
        keys: None,
        reason_without_effect: &reason_without_effect,
        requests,
        refused: None,
        searched_path: None,
    };
    setting_rows::show(ui, &mut context, &[], &mut edited);
    let refused = context.refused;
    // Ranges may depend on the values that were changed.
    edited.visit(&mut RangeClamp);
    if let Some(refused) = refused {
        session.messages.error("typed", refused);
    }
    edited
}

/// Clamps numbers to their ranges.
struct RangeClamp;

impl RangeClamp {
    fn clamp<T: PartialOrd + Copy>(value: &mut T, range: &RangeInclusive<T>) {
        if *value > *range.end() {
            *value = *range.end();
        }
        if *value < *range.start() {
            *value = *range.start();
        }
    }
}

impl FieldVisitor for RangeClamp {
    fn number(&mut self, _: &'static str, value: &mut f32, range: RangeInclusive<f32>, _: &'static str) {
        Self::clamp(value, &range);
    }

    fn integer(&mut self, _: &'static str, value: &mut u32, range: RangeInclusive<u32>, _: &'static str) {
        Self::clamp(value, &range);
    }

    fn vector(&mut self, _: &'static str, _: &mut Vec3, _: RangeInclusive<f32>, _: &'static str) {}

    fn group(&mut self, _: &'static str, fields: &mut dyn Fields) {
        fields.visit(self);
    }

    fn item(&mut self, _: &'static str, _: usize, fields: &mut dyn Fields) {
        fields.visit(self);
    }
}
