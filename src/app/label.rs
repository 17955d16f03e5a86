//! Text on pictures.

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use image::{Rgb, RgbImage};

/// Writes `text` with its upper left corner at (`x`, `y`); what does not fit is cut off.
pub fn draw_text(picture: &mut RgbImage, x: f32, y: f32, height: f32, colour: Rgb<u8>, text: &str) {
    let Ok(font) = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT) else { return };
    let scaled = font.as_scaled(PxScale::from(height));
    let mut pen = point(x, y + scaled.ascent());
    let mut previous = None;
    for character in text.chars() {
        let id = scaled.glyph_id(character);
        if let Some(previous) = previous {
            pen.x += scaled.kern(previous, id);
        }
        previous = Some(id);
        let advance = scaled.h_advance(id);
        if let Some(outline) = font.outline_glyph(id.with_scale_and_position(height, pen)) {
            let bounds = outline.px_bounds();
            outline.draw(|dx, dy, coverage| {
                let (px, py) = (bounds.min.x as i64 + i64::from(dx), bounds.min.y as i64 + i64::from(dy));
                let inside =
                    (0..i64::from(picture.width())).contains(&px) && (0..i64::from(picture.height())).contains(&py);
                if inside {
                    let pixel = picture.get_pixel_mut(px as u32, py as u32);
                    for (channel, ink) in pixel.0.iter_mut().zip(colour.0) {
                        let mixed = f32::from(*channel) + (f32::from(ink) - f32::from(*channel)) * coverage.min(1.0);
                        *channel = mixed.round() as u8;
                    }
                }
            });
        }
        pen.x += advance;
    }
}
