//! Labelled pictures on one sheet.

use glam::UVec2;
use image::{Rgb, RgbImage, imageops};

use super::label::draw_text;

pub const MARGIN: u32 = 12;
/// Height of a label.
pub const LABEL: u32 = 28;
pub const INK: Rgb<u8> = Rgb([225, 225, 220]);
pub const PAPER: Rgb<u8> = Rgb([24, 25, 28]);

/// Cells of one size, row by row.
pub struct Sheet {
    pub picture: RgbImage,
    columns: u32,
    cell: UVec2,
}

impl Sheet {
    /// An empty sheet with `foot` pixels to spare at the bottom.
    pub fn new(size: UVec2, columns: u32, count: u32, foot: u32) -> Self {
        let cell = size + UVec2::new(MARGIN, MARGIN + LABEL);
        let rows = count.div_ceil(columns);
        let picture = RgbImage::from_pixel(cell.x * columns + MARGIN, cell.y * rows + MARGIN + foot, PAPER);
        Self { picture, columns, cell }
    }

    /// Puts a picture and its label into a cell.
    pub fn place(&mut self, index: u32, label: &str, picture: &RgbImage) {
        let corner = UVec2::new(index % self.columns, index / self.columns) * self.cell + MARGIN;
        draw_text(&mut self.picture, corner.x as f32 + 2.0, corner.y as f32, 20.0, INK, label);
        imageops::replace(&mut self.picture, picture, i64::from(corner.x), i64::from(corner.y + LABEL));
    }
}
