//! Icon of the copy button in egui's color picker, which the fonts of the window lack.

use eframe::egui::{Color32, ColorImage, GlyphBitmap, GlyphRasterizer, GlyphRasterizerRequest, RasterizedGlyph, vec2};

/// Clipboard, the label of the button.
const CLIPBOARD: &str = "\u{1f4cb}";

/// Offset of the upper sheet from the lower one, and side of a sheet, relative to the size of the font.
const OFFSET: f32 = 0.22;
const SHEET: f32 = 0.6;

/// Returns the rasterizer that draws the icon.
pub fn rasterizer() -> GlyphRasterizer {
    GlyphRasterizer::new("haze::copy_icon", draw)
}

/// Draws two sheets, the upper one over the lower one.
fn draw(request: &GlyphRasterizerRequest<'_>) -> Option<RasterizedGlyph> {
    if request.cluster != CLIPBOARD {
        return None;
    }
    let size = request.font_size_px.max(4.0);
    let side = ((OFFSET + SHEET) * size).ceil() as usize;
    let offset = (OFFSET * size).round() as usize;
    let sheet = (SHEET * size).floor() as usize;
    let mut image = ColorImage::filled([side, side], Color32::TRANSPARENT);
    for (start, is_upper) in [(0, false), (offset, true)] {
        let end = (start + sheet).min(side);
        for y in start..end {
            for x in start..end {
                let is_edge = x == start || y == start || x + 1 == end || y + 1 == end;
                if is_edge || is_upper {
                    image[(x, y)] = if is_edge { Color32::WHITE } else { Color32::TRANSPARENT };
                }
            }
        }
    }
    let bitmap = GlyphBitmap { image, offset_px: vec2(0.0, -0.78 * size), is_color: false };
    Some(RasterizedGlyph { bitmap, advance_px: side as f32 })
}

#[cfg(test)]
mod tests {
    use eframe::egui::FontFamily;

    use super::*;

    #[test]
    fn only_the_clipboard_is_drawn() {
        let draw = |cluster| {
            let family = FontFamily::Proportional;
            draw(&GlyphRasterizerRequest { cluster, family: &family, font_size_px: 14.0, subpixel_offset_px: 0.0 })
        };
        let drawn = draw(CLIPBOARD).unwrap().bitmap.image;
        let inked = drawn.pixels.iter().filter(|pixel| pixel.a() > 0).count();
        assert!(inked > 30 && inked < drawn.pixels.len() / 2, "{inked} of {}", drawn.pixels.len());
        assert!(draw("a").is_none());
    }
}
