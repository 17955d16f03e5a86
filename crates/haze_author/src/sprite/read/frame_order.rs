//! Order of the frames on a sheet.

use glam::UVec2;

use super::answer::Answer;
use super::frame_grid::FrameOrder;
use super::small_frames::SmallFrames;

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
