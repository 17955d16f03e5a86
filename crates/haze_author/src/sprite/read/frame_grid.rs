//! Cells of a sheet, and the order of the frames in them.

use glam::UVec2;
use haze_core::settings::choice;

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

/// Cells of a sheet and the order of the frames in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameGrid {
    /// Columns and rows.
    pub cells: UVec2,
    /// Order of frames.
    pub order: FrameOrder,
}

impl FrameGrid {
    /// Returns the cell of a frame.
    pub(super) fn cell(&self, frame: u32) -> UVec2 {
        self.order.cell(self.cells, frame)
    }
}
