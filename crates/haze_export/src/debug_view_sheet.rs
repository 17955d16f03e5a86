//! Labelled sheet of every debug view, as OTEE's slide "Shade tree" shows the stages.

use haze_core::settings::DebugView;
use haze_demo::shot::Shot;

/// Stages in the order of the frame.
pub const DEBUG_VIEWS: [(DebugView, &str); DebugView::ALL.len()] = [
    (DebugView::ReducedDepth, "Reduced depth"),
    (DebugView::Normals, "Accumulated normals"),
    (DebugView::Amount, "Accumulated amount"),
    (DebugView::Overdraw, "Overdraw"),
    (DebugView::Shadow, "Shadow"),
    (DebugView::ShadowSlice, "Slice of shadow"),
    (DebugView::Diffuse, "Diffuse"),
    (DebugView::SoftScatter, "Soft scatter and ambient"),
    (DebugView::SpecularScatter, "Specular scatter"),
    (DebugView::Combined, "Combined lighting"),
    (DebugView::Final, "Final"),
];

/// Images per row of the sheet.
pub const COLUMNS: u32 = 4;

/// Returns one shot per stage, with its label.
pub fn stages(shot: &Shot) -> Vec<(String, Shot)> {
    DEBUG_VIEWS.map(|(stage, label)| (label.into(), Shot { debug_view: stage, ..shot.clone() })).into()
}
