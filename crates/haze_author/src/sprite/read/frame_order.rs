//! Order of the frames on a sheet.

use glam::UVec2;
use haze_core::settings::choice;

use super::answer::Answer;
use super::small_frames::SmallFrames;

choice! {
    /// Order of the frames on a sheet.
    FrameOrder {
        /// Left to right, then down.
        #[default]
        Rows = "rows",
        /// Left to right, then up, from the bottom row.
        RowsUp = "rows_up",
        /// Down, then right.
        Columns = "columns",
    }
}

impl FrameOrder {
    /// Returns the cell of a frame.
    pub(super) fn cell(self, cells: UVec2, frame: u32) -> UVec2 {
        match self {
            Self::Rows => UVec2::new(frame % cells.x, frame / cells.x),
            Self::RowsUp => UVec2::new(frame % cells.x, cells.y - 1 - frame / cells.x),
            Self::Columns => UVec2::new(frame / cells.y, frame % cells.y),
        }
    }
}

/// Finds the order in which frames follow each other most smoothly. `frames` are all cells in the order of rows.
pub(super) fn find_order(frames: &SmallFrames, cells: UVec2) -> Answer<FrameOrder> {
    if cells.y == 1 {
        return Answer::found(FrameOrder::Rows, 1.0);
    }
    if cells.x == 1 {
        // One column: nothing tells up from down.
        return Answer::found(FrameOrder::Rows, 0.5);
    }
    let count = cells.element_product();
    let cost = |order: FrameOrder| {
        let cell = |frame| {
            let at = order.cell(cells, frame);
            at.y * cells.x + at.x
        };
        let steps = (1..count).map(|frame| frames.difference(cell(frame - 1), cell(frame)));
        steps.sum::<f32>()
    };
    let mut costs: Vec<_> = FrameOrder::ALL.iter().map(|&order| (order, cost(order))).collect();
    costs.sort_by(|a, b| a.1.total_cmp(&b.1));
    let [(order, least), (_, second), ..] = costs[..] else { return Answer::found(FrameOrder::Rows, 0.0) };
    if second <= 0.0 {
        return Answer::found(FrameOrder::Rows, 0.0);
    }
    // Nearly all sheets run along rows, then down: another order must be clearly smoother.
    let rows = cost(FrameOrder::Rows);
    let gap = (second - least) / second;
    if order != FrameOrder::Rows && least > 0.97 * rows {
        return Answer::found(FrameOrder::Rows, 0.2);
    }
    let usual = if order == FrameOrder::Rows { 0.3 } else { 0.0 };
    Answer::found(order, usual + gap * 5.0)
}
