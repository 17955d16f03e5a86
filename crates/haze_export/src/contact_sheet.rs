//! Lays out labelled images on a sheet.

use glam::UVec2;
use image::{Rgb, RgbImage, imageops};

use super::text_drawing::{draw_text, wrap_text};

const MARGIN: u32 = 12;
/// Height of a label's row, pixels.
const LABEL_HEIGHT: u32 = 28;
/// Height of the text, pixels.
const TEXT_HEIGHT: f32 = 20.0;
/// Height of a footer line, pixels.
const FOOTER_LINE_HEIGHT: u32 = 24;
/// Color of labels, sRGB.
pub const TEXT_COLOR: Rgb<u8> = Rgb([225, 225, 220]);
/// Color of margins, sRGB.
pub const BACKGROUND: Rgb<u8> = Rgb([24, 25, 28]);

/// Grid of cells of one size, row by row.
pub struct ContactSheet {
    /// The sheet.
    pub image: RgbImage,
    columns: u32,
    cell: UVec2,
}

impl ContactSheet {
    /// Creates an empty sheet for `count` images of `size` pixels.
    pub fn new(size: UVec2, columns: u32, count: u32) -> Self {
        let cell = size + UVec2::new(MARGIN, MARGIN + LABEL_HEIGHT);
        let rows = count.div_ceil(columns);
        let image = RgbImage::from_pixel(cell.x * columns + MARGIN, cell.y * rows + MARGIN, BACKGROUND);
        Self { image, columns, cell }
    }

    /// Puts an image and its label into a cell.
    pub fn place(&mut self, index: u32, label: &str, image: &RgbImage) {
        let corner = UVec2::new(index % self.columns, index / self.columns) * self.cell + MARGIN;
        draw_text(&mut self.image, corner.x as f32 + 2.0, corner.y as f32, TEXT_HEIGHT, TEXT_COLOR, label);
        imageops::replace(&mut self.image, image, i64::from(corner.x), i64::from(corner.y + LABEL_HEIGHT));
    }

    /// Draws an inset over the lower left corner of a cell's image.
    pub fn inset(&mut self, index: u32, inset: &RgbImage) {
        let end = UVec2::new(index % self.columns, index / self.columns + 1) * self.cell;
        let corner = end + UVec2::new(MARGIN, 0) - UVec2::new(0, inset.height());
        imageops::replace(&mut self.image, inset, i64::from(corner.x), i64::from(corner.y));
    }

    /// Adds text below the cells, wrapped to the width of the sheet.
    pub fn add_footer(&mut self, text: &str) {
        let (width, height) = self.image.dimensions();
        let left = MARGIN as f32 + 2.0;
        let lines = wrap_text(TEXT_HEIGHT, width as f32 - 2.0 * left, text);
        let mut image = RgbImage::from_pixel(width, height + FOOTER_LINE_HEIGHT * lines.len() as u32, BACKGROUND);
        imageops::replace(&mut image, &self.image, 0, 0);
        for (line, text) in (0..).zip(&lines) {
            draw_text(
                &mut image,
                left,
                (height + FOOTER_LINE_HEIGHT * line) as f32 - 4.0,
                TEXT_HEIGHT,
                TEXT_COLOR,
                text,
            );
        }
        self.image = image;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn footer_text_is_wrapped_to_the_width_of_the_sheet() {
        let text = "ms: all sprites once, median of 5 rounds; 450x253, llvmpipe (LLVM 15.0.6, 256 bits) (Vulkan, \
            llvmpipe Mesa 22.3.6 (LLVM 15.0.6), software)";
        // Returns the number of text pixels, whether any is beyond the right margin, and the number of lines.
        let ink = |side: u32| {
            let mut sheet = ContactSheet::new(UVec2::new(side, 10), 2, 2);
            let above = sheet.image.height();
            sheet.add_footer(text);
            let margin = sheet.image.width() - MARGIN;
            let inked: Vec<_> =
                sheet.image.enumerate_pixels().filter(|(_, y, p)| *y >= above && **p != BACKGROUND).collect();
            (inked.len(), inked.iter().any(|(x, ..)| *x >= margin), (sheet.image.height() - above) / FOOTER_LINE_HEIGHT)
        };
        let (whole, _, lines) = ink(900);
        assert_eq!(lines, 1);
        for side in [450, 300, 100] {
            let (inked, beyond, lines) = ink(side);
            assert!(!beyond && lines > 1, "{side}: {lines} lines");
            // Glyphs differ only by their position between pixels.
            assert!(inked.abs_diff(whole) < whole / 10, "{side}: {inked} pixels for {whole}");
        }
    }
}
