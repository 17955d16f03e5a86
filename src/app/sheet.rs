//! Labelled pictures on one sheet.

use glam::UVec2;
use image::{Rgb, RgbImage, imageops};

use super::label::draw_text;

const MARGIN: u32 = 12;
/// Height of a label.
const LABEL: u32 = 28;
/// Height of the line at the bottom.
const FOOT: u32 = 24;
pub const INK: Rgb<u8> = Rgb([225, 225, 220]);
pub const PAPER: Rgb<u8> = Rgb([24, 25, 28]);

/// Cells of one size, row by row.
pub struct Sheet {
    pub picture: RgbImage,
    columns: u32,
    cell: UVec2,
}

impl Sheet {
    /// An empty sheet.
    pub fn new(size: UVec2, columns: u32, count: u32) -> Self {
        let cell = size + UVec2::new(MARGIN, MARGIN + LABEL);
        let rows = count.div_ceil(columns);
        let picture = RgbImage::from_pixel(cell.x * columns + MARGIN, cell.y * rows + MARGIN, PAPER);
        Self { picture, columns, cell }
    }

    /// Puts a picture and its label into a cell.
    pub fn place(&mut self, index: u32, label: &str, picture: &RgbImage) {
        let corner = UVec2::new(index % self.columns, index / self.columns) * self.cell + MARGIN;
        draw_text(&mut self.picture, corner.x as f32 + 2.0, corner.y as f32, 20.0, INK, label);
        imageops::replace(&mut self.picture, picture, i64::from(corner.x), i64::from(corner.y + LABEL));
    }

    /// Adds a line below the cells.
    pub fn add_foot(&mut self, text: &str) {
        let (width, height) = self.picture.dimensions();
        let mut picture = RgbImage::from_pixel(width, height + FOOT, PAPER);
        imageops::replace(&mut picture, &self.picture, 0, 0);
        draw_text(&mut picture, MARGIN as f32 + 2.0, height as f32 - 4.0, 20.0, INK, text);
        self.picture = picture;
    }
}
