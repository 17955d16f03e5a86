//! Checks a sprite's image for visible defects.

use std::path::Path;

use glam::{UVec2, Vec3, Vec4, Vec4Swizzles};
use haze_core::assets::sprite::{Sprite, SpriteLayout};
use haze_core::error::AssetError;
use image::RgbaImage;

use super::opacity::is_opaque;
use super::y_direction::{MIN_CONFIDENCE, normal, y_direction};
use crate::finding::Finding;

/// Minimum amount of a texel that is examined.
const MIN_AMOUNT: f32 = 0.1;
/// Minimum fraction of texels for a finding. Filters of paint programs may leave a few wrong texels at edges.
const MIN_FRACTION: f32 = 0.02;
/// Accepted length of a normal. Rounding to 8 bits and rescaling cause smaller deviations.
const LENGTHS: [f32; 2] = [0.85, 1.1];

/// Returns the defects that would be visible. `layout` gives the frames and, by `y_down`, the intended direction of
/// green.
///
/// - `empty`: the amount is 0 everywhere.
/// - `opaque`: the amount is 1 everywhere inside the borders.
/// - `normals`: the image holds colors or heights, not normals.
/// - `length`: normals do not have unit length.
/// - `y_down`: green points in the other direction.
/// - `border`: a frame is not clear at its border.
/// - `premultiplied`: normals fade to black or gray with alpha.
/// - `loop`: the last frame differs from the first more than neighbouring frames differ.
///
/// # Errors
/// As [`Sprite::from_image`] if the layout does not fit.
pub fn lint_sprite(path: &Path, image: &RgbaImage, layout: SpriteLayout) -> Result<Vec<Finding>, AssetError> {
    let mut findings = Vec::new();
    let mut find = |name, description: String| findings.push(Finding { name, description, is_warning: false });
    // A border that is not clear is a finding, not an error: it is cleared so that the other checks can run.
    let mut image = image.clone();
    let border = clear_borders(&mut image, layout);
    let sprite = Sprite::from_image(path, &image, layout)?;
    if let Some((frame, alpha)) = border {
        find(
            "border",
            format!("frame {frame} has alpha {alpha} on its border; expected 0, or the sprite shows as a square"),
        );
    }
    if is_clear(&sprite) {
        find("empty", EMPTY_MESSAGE.into());
        return Ok(findings);
    }
    if is_square(&sprite) {
        find("opaque", OPAQUE_MESSAGE.into());
    }
    if let Some(description) = describe_non_normals(&sprite) {
        find("normals", description.into());
        return Ok(findings);
    }
    let lengths = |least: f32, most: f32| {
        let texels = texels(&sprite).filter(|texel| (least..most).contains(&texel.w));
        texels.map(|texel| normal(texel).length()).collect::<Vec<_>>()
    };
    let off = |lengths: &[f32]| {
        let off = lengths.iter().filter(|length| !(LENGTHS[0]..LENGTHS[1]).contains(length)).count();
        off as f32 / lengths.len().max(1) as f32
    };
    // Normals that are wrong only at small amounts are premultiplied or painted over gray.
    let faint = lengths(MIN_AMOUNT, 0.6);
    let solid = lengths(0.9, 2.0);
    let fades = premultiplied(&sprite);
    if let Some(towards) = fades {
        find(
            "premultiplied",
            format!("normals fade to {towards} with alpha; expected straight alpha, with unit normals up to the edge"),
        );
    } else if off(&[faint, solid].concat()) > MIN_FRACTION {
        let fraction = (off(&lengths(MIN_AMOUNT, 2.0)) * 100.0).round();
        find(
            "length",
            format!("{fraction} % of normals are not of unit length; expected unit normals: normalise the map"),
        );
    }
    if let Some(found) = y_direction(&sprite).filter(|found| found.is_down && found.confidence >= MIN_CONFIDENCE) {
        let sure = (found.confidence * 100.0).round();
        // `from_image` has already flipped green if the layout has `y_down`.
        let (is, option) = if layout.y_down { ("up", "no y_down") } else { ("down", "y_down") };
        find("y_down", format!("green points {is}, {sure} % sure; expected {option}"));
    }
    if let Some((seam, mean)) = loop_seam(&sprite) {
        let times = seam / mean;
        find(
            "loop",
            format!(
                "the last frame differs from the first {times:.1} times as much as neighbouring frames do; expected a loop"
            ),
        );
    }
    Ok(findings)
}

/// Clears the borders of all frames. Returns the frame with the largest alpha on its border, and that alpha; `None` if
/// all were clear.
pub(super) fn clear_borders(image: &mut RgbaImage, layout: SpriteLayout) -> Option<(u32, u8)> {
    let columns = layout.columns.max(1);
    let rows = layout.rows.max(1);
    let size = UVec2::new(image.width() / columns, image.height() / rows).max(UVec2::ONE);
    let mut most: Option<(u32, u8)> = None;
    for (x, y, texel) in image.enumerate_pixels_mut() {
        let inside = UVec2::new(x, y) % size;
        if size.min_element() > 2 && (inside.min_element() == 0 || (inside + 1).cmpeq(size).any()) {
            if texel.0[3] > most.map_or(0, |(_, alpha)| alpha) {
                most = Some((y / size.y * columns + x / size.x, texel.0[3]));
            }
            texel.0[3] = 0;
        }
    }
    most
}

fn texels(sprite: &Sprite) -> impl Iterator<Item = Vec4> + '_ {
    let size = sprite.size();
    (0..sprite.frame_count() * size * size).map(move |index| {
        let frame = index / (size * size);
        let at = index % (size * size);
        sprite.texel(0, frame, at % size, at / size)
    })
}

/// Message for a sprite that is clear everywhere.
pub const EMPTY_MESSAGE: &str = "alpha is 0 everywhere; expected the amount in alpha";

/// True if the amount is 0 in every texel.
pub fn is_clear(sprite: &Sprite) -> bool {
    texels(sprite).all(|texel| texel.w <= 0.0)
}

/// Message for a sprite that is opaque up to its borders.
const OPAQUE_MESSAGE: &str =
    "alpha is 255 everywhere inside the borders, so that each frame shows as a square; expected the amount in alpha";

/// True if the amount is 1 in nearly all texels inside the borders of the frames.
fn is_square(sprite: &Sprite) -> bool {
    let inside = 1..sprite.size().saturating_sub(1);
    // Frames of few texels may well be full.
    let positions = inside.clone().flat_map(|y| inside.clone().map(move |x| UVec2::new(x, y)));
    let alphas = (0..sprite.frame_count()).flat_map(|frame| {
        positions.clone().map(move |at| (sprite.texel(0, frame, at.x, at.y).w * 255.0).round() as u8)
    });
    sprite.size() > 4 && is_opaque(alphas)
}

/// Returns a description of the sprite's contents if they are not normals.
pub fn describe_non_normals(sprite: &Sprite) -> Option<&'static str> {
    let mut count = 0.0_f32;
    let mut sum = Vec3::ZERO;
    let mut gray = 0.0;
    let mut away = 0.0;
    let mut unlike = 0.0;
    for texel in texels(sprite).filter(|texel| texel.w >= 0.5) {
        count += 1.0;
        sum += normal(texel);
        let color = texel.xyz();
        gray += f32::from(color.max_element() - color.min_element() < 0.02);
        away += f32::from(color.z < 0.45);
        unlike += f32::from((normal(texel).length() - 1.0).abs() > 0.4);
    }
    // Premultiplied normals are a separate finding.
    if count <= 0.0 || premultiplied(sprite).is_some() {
        return None;
    }
    if gray > 0.9 * count {
        return Some("shades of gray; expected normals: `haze sprite import` converts heights or alpha");
    }
    // The mean normal of a whole sprite points at the viewer; colors of a painting have another mean.
    let mean = sum / count;
    let leans = mean.z < 0.15 || mean.truncate().length() > 0.35;
    let is_painted = away > 0.15 * count || unlike > 0.5 * count;
    (leans || is_painted)
        .then_some("colors, not normals; expected x in red, y in green and z, mostly above 1/2, in blue")
}

/// Returns the color that normals fade to at small amounts: black if they were multiplied by alpha, gray if they were
/// painted over gray. `None` for straight alpha.
fn premultiplied(sprite: &Sprite) -> Option<&'static str> {
    let mut count = 0.0_f32;
    let mut straight = 0.0;
    let mut black = 0.0;
    let mut gray = 0.0;
    for texel in texels(sprite).filter(|texel| (MIN_AMOUNT..0.7).contains(&texel.w)) {
        let off = |normal: Vec3| (normal.length() - 1.0).abs();
        count += 1.0;
        straight += off(normal(texel));
        black += off(texel.xyz() / texel.w * 2.0 - 1.0);
        gray += off(normal(texel) / texel.w);
    }
    // Undoing the multiplication restores unit length.
    let explains = |off: f32| count > 0.0 && straight > 0.15 * count && off < 0.5 * straight;
    match () {
        () if explains(black) && black <= gray => Some("black"),
        () if explains(gray) => Some("gray"),
        () => None,
    }
}

/// Returns the difference between the last and first frame and the mean difference of neighbouring frames, if the
/// former is much larger.
fn loop_seam(sprite: &Sprite) -> Option<(f32, f32)> {
    let count = sprite.frame_count();
    if count < 3 {
        return None;
    }
    let size = sprite.size();
    let premultiplied = |frame, index| {
        let texel = sprite.texel(0, frame, index % size, index / size);
        (normal(texel) * texel.w).extend(texel.w)
    };
    let apart = |a, b| (0..size * size).map(|index| (premultiplied(a, index) - premultiplied(b, index)).length()).sum();
    let mean = (1..count).map(|frame| -> f32 { apart(frame - 1, frame) }).sum::<f32>() / (count - 1) as f32;
    let seam: f32 = apart(count - 1, 0);
    (mean > 0.0 && seam > 1.6 * mean).then_some((seam, mean))
}

#[cfg(test)]
mod tests {
    use super::*;
    use haze_core::assets::image::decode_png;
    use haze_preset::builtin;
    use image::Rgba;

    const LAYOUT: SpriteLayout = SpriteLayout { columns: 4, rows: 2, y_down: false };

    fn wisp() -> RgbaImage {
        let wisp = builtin::find(builtin::SPRITES, "wisp").unwrap();
        decode_png(Path::new("wisp"), wisp.bytes).unwrap().to_rgba8()
    }

    fn names(image: &RgbaImage, layout: SpriteLayout) -> Vec<&'static str> {
        lint_sprite(Path::new("a.png"), image, layout).unwrap().into_iter().map(|finding| finding.name).collect()
    }

    /// The wisp with every texel changed.
    fn changed(change: impl Fn([f32; 4]) -> [f32; 4]) -> RgbaImage {
        let mut image = wisp();
        for texel in image.pixels_mut() {
            texel.0 = change(texel.0.map(f32::from)).map(|channel| channel.round() as u8);
        }
        image
    }

    #[test]
    fn built_in_sprites_have_no_findings() {
        for builtin in builtin::SPRITES {
            let sprite = builtin.sprite().unwrap();
            let found = y_direction(&sprite).unwrap();
            assert!(!found.is_down && found.confidence > MIN_CONFIDENCE, "{}: {found:?}", builtin.name);
            let image = decode_png(Path::new(builtin.name), builtin.bytes).unwrap().to_rgba8();
            let columns = image.width() / sprite.size();
            let layout = SpriteLayout { columns, rows: sprite.frame_count() / columns, y_down: false };
            assert_eq!(lint_sprite(Path::new(builtin.name), &image, layout).unwrap(), [], "{}", builtin.name);
        }
    }

    #[test]
    fn every_finding_is_found() {
        assert_eq!(names(&changed(|[r, g, b, a]| [r, 255.0 - g, b, a]), LAYOUT), ["y_down"]);
        assert_eq!(names(&wisp(), SpriteLayout { y_down: true, ..LAYOUT }), ["y_down"]);
        assert!(
            names(&changed(|[r, g, b, a]| [r, 255.0 - g, b, a]), SpriteLayout { y_down: true, ..LAYOUT }).is_empty()
        );
        let scaled = |by: f32| move |channel: f32| 127.5 + (channel - 127.5) * by;
        let short = scaled(0.7);
        assert_eq!(names(&changed(|[r, g, b, a]| [short(r), short(g), short(b), a]), LAYOUT), ["length"]);
        assert_eq!(
            names(&changed(|[r, g, b, a]| [r * a / 255.0, g * a / 255.0, b * a / 255.0, a]), LAYOUT),
            ["premultiplied"]
        );
        let over_gray = |[r, g, b, a]: [f32; 4]| {
            let fade = scaled(a / 255.0);
            [fade(r), fade(g), fade(b), a]
        };
        assert_eq!(names(&changed(over_gray), LAYOUT), ["premultiplied"]);
        assert_eq!(names(&changed(|[_, g, _, a]| [g, g, g, a]), LAYOUT), ["normals"]);
        // Colors of fire and of a sky.
        assert_eq!(names(&changed(|[r, g, _, a]| [255.0, g * 0.6, r * 0.2, a]), LAYOUT), ["normals"]);
        assert_eq!(names(&changed(|[r, g, _, a]| [r * 0.5, g * 0.9, 255.0, a]), LAYOUT), ["normals"]);
        assert_eq!(names(&changed(|[r, g, b, _]| [r, g, b, 0.0]), LAYOUT), ["empty"]);
        assert_eq!(names(&changed(|[r, g, b, _]| [r, g, b, 255.0]), LAYOUT)[..2], ["border", "opaque"]);
        let mut square = wisp();
        square.put_pixel(300, 0, Rgba([128, 128, 255, 9]));
        assert_eq!(names(&square, LAYOUT), ["border"]);
        // The smoke fades over the loop and is complete again in the first frame.
        let mut fading = wisp();
        let size = fading.width() / 4;
        for frame in 0..8 {
            let first = wisp();
            for (x, y) in (0..size * size).map(|index| (index % size, index / size)) {
                let mut texel = *first.get_pixel(x, y);
                texel.0[3] = (u32::from(texel.0[3]) * (10 - frame) / 10) as u8;
                fading.put_pixel(frame % 4 * size + x, frame / 4 * size + y, texel);
            }
        }
        assert_eq!(names(&fading, LAYOUT), ["loop"]);
    }

    #[test]
    fn sprites_of_few_texels_do_not_panic() {
        for size in [1, 2, 3, 4] {
            names(&RgbaImage::from_pixel(size, size, Rgba([128, 128, 255, 255])), SpriteLayout::default());
        }
    }
}
