//! Reads color tables: `.cpt` of GMT, and palettes of GIMP (`.gpl`) and Paint Shop Pro (`.pal`) as evenly spaced stops.

use glam::Vec3;
use haze_core::error::one_line;

use super::gradient_text::{GradientParseError, parse_numbers};
use super::ramp_recipe::Blend;
use super::source_gradient::{Interpolation, SourceGradient, SourcePoint};

fn error(line: usize, reason: impl Into<String>) -> GradientParseError {
    GradientParseError { line, reason: reason.into() }
}

fn is_code(color: Vec3) -> bool {
    color == color.clamp(Vec3::ZERO, Vec3::splat(255.0))
}

/// Reads a color palette table of GMT: pieces from a value and a color to another. The lowest value becomes 0, the
/// highest 1. (GMT, "Color palette tables")
pub fn read_cpt(text: &str) -> Result<SourceGradient, GradientParseError> {
    let mut points = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.trim();
        if let Some(comment) = text.strip_prefix('#') {
            let model = comment.split_once("COLOR_MODEL").map(|(_, model)| model.trim_matches([' ', '=', '+']));
            if let Some(model) = model.filter(|model| !model.eq_ignore_ascii_case("rgb")) {
                let model = one_line(model);
                return Err(error(
                    line,
                    format!("the color model is {model}; expected RGB: convert it by makecpt -Fr"),
                ));
            }
            continue;
        }
        // Labels follow a semicolon. B, F and N are the colors below, above and without a value.
        let words: Vec<_> = text.split(';').next().unwrap_or_default().split_whitespace().collect();
        if words.is_empty() || ["B", "F", "N"].contains(&words[0]) {
            continue;
        }
        let expected = "value, color, value, color, with colors as 64/32/16, #402010 or three numbers";
        let piece = piece(&words).ok_or_else(|| error(line, format!("not a piece; expected {expected}")))?;
        points.extend(piece);
    }
    let low = points.iter().map(|point: &SourcePoint| point.at).fold(f32::INFINITY, f32::min);
    let high = points.iter().map(|point| point.at).fold(f32::NEG_INFINITY, f32::max);
    if low >= high {
        return Err(error(1, "no pieces; expected lines of value, color, value, color"));
    }
    for point in &mut points {
        point.at = (point.at - low) / (high - low);
    }
    Ok(SourceGradient::new(Blend::Srgb, Interpolation::Linear, points))
}

/// Reads the two ends of a piece. An annotation (L, U, B) may follow.
fn piece(words: &[&str]) -> Option<[SourcePoint; 2]> {
    let (start, rest) = end(words)?;
    let (end, _) = end(rest)?;
    (start.at <= end.at).then_some([start, end])
}

/// Reads a value and a color; returns the words that follow.
fn end<'a, 'b>(words: &'a [&'b str]) -> Option<(SourcePoint, &'a [&'b str])> {
    let (value, rest) = words.split_first()?;
    let at: f32 = value.parse().ok().filter(|at: &f32| at.is_finite())?;
    let point = |color: Vec3| is_code(color).then(|| SourcePoint { at, code: (color / 255.0).extend(1.0) });
    if let Some(&[r, g, b]) = rest.get(..3).and_then(|words| parse_numbers(&words.join(" "))).as_deref() {
        return Some((point(Vec3::new(r, g, b))?, &rest[3..]));
    }
    let (color, rest) = rest.split_first()?;
    if let Some([r, g, b]) = parse_numbers(&color.replace('/', " ")).as_deref() {
        return Some((point(Vec3::new(*r, *g, *b))?, rest));
    }
    let named = csscolorparser::parse(color).ok()?;
    Some((point(Vec3::new(named.r, named.g, named.b) * 255.0)?, rest))
}

/// Reads a palette of GIMP or Paint Shop Pro.
pub fn read_palette(text: &str) -> Result<SourceGradient, GradientParseError> {
    let mut lines = (1..).zip(text.lines().map(str::trim));
    let first = lines.next().map(|(_, line)| line).unwrap_or_default();
    let is_gimp = first == "GIMP Palette";
    if !is_gimp && first != "JASC-PAL" {
        return Err(error(1, "not a palette; expected \"GIMP Palette\" or \"JASC-PAL\" in the first line"));
    }
    let mut expected_count = None;
    if !is_gimp {
        // The version.
        lines.next();
        let count = lines.next().and_then(|(_, line)| line.parse::<usize>().ok());
        expected_count = Some(count.ok_or_else(|| error(3, "no number of colors; expected a whole number"))?);
    }
    let mut colors = Vec::new();
    for (line, text) in lines {
        let is_header = ["Name:", "Columns:"].iter().any(|name| text.starts_with(name));
        if text.is_empty() || text.starts_with('#') || is_gimp && is_header {
            continue;
        }
        let words: Vec<_> = text.split_whitespace().take(3).collect();
        match parse_numbers(&words.join(" ")).as_deref() {
            Some(&[r, g, b]) if is_code(Vec3::new(r, g, b)) => colors.push(Vec3::new(r, g, b) / 255.0),
            _ => return Err(error(line, "not a color; expected red, green and blue of 0 to 255")),
        }
    }
    if let Some(count) = expected_count.filter(|count| *count != colors.len()) {
        return Err(error(3, format!("{} colors follow; expected {count}", colors.len())));
    }
    if colors.is_empty() {
        return Err(error(1, "no colors; expected lines of red, green and blue"));
    }
    let last = (colors.len() - 1).max(1) as f32;
    let point = |(index, color): (usize, &Vec3)| SourcePoint { at: index as f32 / last, code: color.extend(1.0) };
    let points: Vec<SourcePoint> = colors.iter().enumerate().map(point).collect();
    Ok(SourceGradient::new(Blend::Srgb, Interpolation::Linear, points))
}

#[cfg(test)]
mod tests {
    use super::*;

    type Reader = fn(&str) -> Result<SourceGradient, GradientParseError>;

    fn codes(read: Reader, text: &str, positions: &[f32]) -> Vec<[u8; 3]> {
        let Ok(gradient) = read(text) else { panic!("{text} is refused") };
        positions.iter().map(|at| (gradient.code(*at) * 255.0).round().to_array().map(|code| code as u8)).collect()
    }

    fn refused(read: Reader, text: &str) -> String {
        read(text).err().map(|error| format!("{}: {}", error.line, error.reason)).unwrap_or_default()
    }

    #[test]
    fn tables_of_gmt_are_scaled_to_0_to_1() {
        let table =
            "# COLOR_MODEL = RGB\n-10 0 0 0 0 200 100 50 L\n0 #ff0000 10 0/0/255 ; warm\nB black\nF white\nN gray\n";
        let found = codes(read_cpt, table, &[0.0, 0.25, 0.51, 1.0]);
        assert_eq!(found, [[0, 0, 0], [100, 50, 25], [250, 0, 5], [0, 0, 255]]);
        assert_eq!(codes(read_cpt, "0 black 1 white", &[0.5]), [[128; 3]]);
        for (text, expected) in [
            ("# COLOR_MODEL = +HSV", "1: the color model is HSV; expected RGB: convert it by makecpt -Fr"),
            ("\n0 0 0 0 x", "2: not a piece; expected value, color, value, color"),
            ("# nothing", "1: no pieces; expected lines of value, color, value, color"),
        ] {
            assert!(refused(read_cpt, text).starts_with(expected), "{}", refused(read_cpt, text));
        }
    }

    #[test]
    fn palettes_become_evenly_spaced_stops() {
        let gimp = "GIMP Palette\nName: Fire\nColumns: 3\n#\n  0   0   0\tBlack\n200 100 0 Embers\n255 255 255\n";
        assert_eq!(
            codes(read_palette, gimp, &[0.0, 0.25, 0.5, 1.0]),
            [[0, 0, 0], [100, 50, 0], [200, 100, 0], [255; 3]]
        );
        let jasc = "JASC-PAL\n0100\n2\n0 0 0\n255 0 0\n";
        assert_eq!(codes(read_palette, jasc, &[0.0, 1.0]), [[0, 0, 0], [255, 0, 0]]);
        assert_eq!(refused(read_palette, "JASC-PAL\n0100\n3\n0 0 0\n"), "3: 1 colors follow; expected 3");
        assert!(refused(read_palette, "GIMP Palette\n0 256 0").starts_with("2: not a color"));
        assert!(refused(read_cpt, "0 0 0 0 1 300 0 0").starts_with("1: not a piece"));
        assert!(refused(read_palette, "RIFF").starts_with("1: not a palette"));
        assert_eq!(
            refused(read_palette, "GIMP Palette\n1 2"),
            "2: not a color; expected red, green and blue of 0 to 255"
        );
    }
}
