//! Draws text on images.

use ab_glyph::{Font, FontRef, GlyphId, InvalidFont, PxScale, ScaleFont, point};
use image::{Rgb, RgbImage};

/// Draws `text`, `height` pixels high, with its upper left corner at (`x`, `y`); text beyond the image is cut off.
pub fn draw_text(image: &mut RgbImage, x: f32, y: f32, height: f32, color: Rgb<u8>, text: &str) {
    let Ok(font) = font() else { return };
    let baseline = y + font.as_scaled(PxScale::from(height)).ascent();
    for (id, left) in lay_out_glyphs(&font, height, text).0 {
        if let Some(outline) = font.outline_glyph(id.with_scale_and_position(height, point(x + left, baseline))) {
            let bounds = outline.px_bounds();
            outline.draw(|dx, dy, coverage| {
                let px = bounds.min.x as i64 + i64::from(dx);
                let py = bounds.min.y as i64 + i64::from(dy);
                let inside =
                    (0..i64::from(image.width())).contains(&px) && (0..i64::from(image.height())).contains(&py);
                if inside {
                    let pixel = image.get_pixel_mut(px as u32, py as u32);
                    for (channel, ink) in pixel.0.iter_mut().zip(color.0) {
                        let mixed = f32::from(*channel) + (f32::from(ink) - f32::from(*channel)) * coverage.min(1.0);
                        *channel = mixed.round() as u8;
                    }
                }
            });
        }
    }
}

/// Width of `text`, pixels.
pub fn text_width(height: f32, text: &str) -> f32 {
    font().map_or(0.0, |font| lay_out_glyphs(&font, height, text).1)
}

/// Breaks `text` between words into lines of at most `width` pixels; a wider word gets its own line.
pub fn wrap_text(height: f32, width: f32, text: &str) -> Vec<String> {
    let Ok(font) = font() else { return Vec::new() };
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let longer = format!("{line} {word}");
            if lay_out_glyphs(&font, height, &longer).1 <= width {
                *line = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
}

fn font() -> Result<FontRef<'static>, InvalidFont> {
    FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT)
}

/// Returns the glyphs with their left edges, and the width of all, pixels.
fn lay_out_glyphs(font: &FontRef<'_>, height: f32, text: &str) -> (Vec<(GlyphId, f32)>, f32) {
    let scaled = font.as_scaled(PxScale::from(height));
    let mut x = 0.0;
    let mut previous = None;
    let mut glyphs = Vec::new();
    for id in text.chars().map(|character| scaled.glyph_id(character)) {
        if let Some(previous) = previous.replace(id) {
            x += scaled.kern(previous, id);
        }
        glyphs.push((id, x));
        x += scaled.h_advance(id);
    }
    (glyphs, x)
}
