//! Reads linear gradients of CSS. (W3C, CSS Images Module Level 4)

use glam::Vec4;
use haze_core::error::one_line;

use super::gradient_text::GradientParseError;
use super::ramp_recipe::Blend;
use super::source_gradient::{NotedGradient, SourceGradient, SourcePoint};

const FUNCTION: &str = "linear-gradient(";

/// Reads the first linear gradient of a text. Colors are mixed as CSS does: multiplied by their alpha.
pub fn read(text: &str) -> Result<NotedGradient, GradientParseError> {
    let start = text.find(FUNCTION).ok_or_else(|| GradientParseError {
        line: 1,
        reason: "no gradient; expected linear-gradient(#402010, white 80%)".into(),
    })?;
    let line = 1 + text[..start].matches('\n').count();
    let refuse = |reason: String| GradientParseError { line, reason };
    if text[..start].ends_with("repeating-") {
        return Err(refuse("a repeating gradient is not read; expected linear-gradient(…)".into()));
    }
    let arguments = arguments(&text[start + FUNCTION.len()..])
        .ok_or_else(|| refuse("the gradient has no end; expected a closing bracket".into()))?;
    let mut blend = Blend::Srgb;
    let mut stops = Vec::new();
    for (index, argument) in arguments.iter().enumerate() {
        let words = words(argument);
        if index == 0 && is_direction(&words) {
            blend = color_space(&words).map_err(refuse)?;
            continue;
        }
        add_stops(&words, &mut stops).map_err(refuse)?;
    }
    if stops.is_empty() {
        return Err(refuse("the gradient has no colors; expected one or more".into()));
    }
    let count = text.matches(FUNCTION).count();
    let note = (count > 1).then(|| format!("{line}: read the first of {count} linear gradients"));
    Ok(NotedGradient { gradient: SourceGradient::premultiplied(blend, placed(&stops)), note })
}

/// Splits the arguments of a function at the commas that are in no other brackets; `None` without the closing bracket.
fn arguments(text: &str) -> Option<Vec<&str>> {
    let mut arguments = Vec::new();
    let mut depth = 0;
    let mut start = 0;
    for (at, character) in text.char_indices() {
        match character {
            '(' => depth += 1,
            ')' if depth == 0 => {
                arguments.push(&text[start..at]);
                return Some(arguments);
            }
            ')' => depth -= 1,
            ',' if depth == 0 => {
                arguments.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    None
}

/// Splits at white space that is in no brackets.
fn words(argument: &str) -> Vec<&str> {
    let mut depth = 0;
    let is_space = |character: char| {
        match character {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        depth == 0 && character.is_whitespace()
    };
    argument.split(is_space).filter(|word| !word.is_empty()).collect()
}

/// True for an angle, a side or a color space, which may come before the colors.
fn is_direction(words: &[&str]) -> bool {
    let is_angle = |word: &&str| ["deg", "grad", "rad", "turn"].iter().any(|unit| number(word, unit).is_some());
    words.first().is_some_and(|first| is_angle(first) || ["to", "in"].contains(first))
}

fn color_space(words: &[&str]) -> Result<Blend, String> {
    let Some(at) = words.iter().position(|word| *word == "in") else { return Ok(Blend::Srgb) };
    match &words[at + 1..] {
        ["srgb", ..] => Ok(Blend::Srgb),
        ["srgb-linear", ..] => Ok(Blend::Linear),
        ["oklab", ..] => Ok(Blend::Oklab),
        other => {
            let space = one_line(other.join(" "));
            Err(format!("the color space {space} is not read; expected srgb, srgb-linear or oklab"))
        }
    }
}

/// A stop whose position may be missing.
struct Stop {
    color: Vec4,
    at: Option<f32>,
}

/// Adds a color, at no, one or two positions.
fn add_stops(words: &[&str], stops: &mut Vec<Stop>) -> Result<(), String> {
    let Some((color, positions)) = words.split_first() else {
        return Err("an empty color; expected a color, and its position in percent".into());
    };
    if number(color, "%").is_some() {
        return Err("a midpoint without a color is not read; expected colors with positions".into());
    }
    let parsed = csscolorparser::parse(color)
        .map_err(|_| format!("{} is no color; expected one of CSS, as #402010 or rgb(64 32 16)", one_line(*color)))?;
    let color = Vec4::new(parsed.r, parsed.g, parsed.b, parsed.a);
    let position = |word: &&str| {
        let percent = number(word, "%").or((*word == "0").then_some(0.0));
        percent.map(|percent| percent / 100.0).ok_or_else(|| {
            format!("the position {} is not read; expected percent, of which 100 is the end", one_line(*word))
        })
    };
    let positions = positions.iter().map(position).collect::<Result<Vec<f32>, _>>()?;
    match positions[..] {
        [] => stops.push(Stop { color, at: None }),
        [at] => stops.push(Stop { color, at: Some(at) }),
        [from, to] => stops.extend([from, to].map(|at| Stop { color, at: Some(at) })),
        _ => return Err("a color with more than two positions; expected at most two".into()),
    }
    Ok(())
}

fn number(word: &str, unit: &str) -> Option<f32> {
    word.strip_suffix(unit)?.parse().ok().filter(|number: &f32| number.is_finite())
}

/// Places the stops: the first at 0, the last at 1, others in between evenly, and none in front of an earlier one.
fn placed(stops: &[Stop]) -> Vec<SourcePoint> {
    let mut positions: Vec<_> = stops.iter().map(|stop| stop.at).collect();
    let last = positions.len() - 1;
    positions[0].get_or_insert(0.0);
    positions[last].get_or_insert(1.0);
    let mut most = f32::NEG_INFINITY;
    for position in positions.iter_mut().flatten() {
        most = most.max(*position);
        *position = most;
    }
    let known: Vec<_> = positions.iter().enumerate().filter_map(|(index, at)| Some((index, (*at)?))).collect();
    let position = |index: usize| {
        let next = known.partition_point(|(known, _)| *known < index).min(known.len() - 1);
        let (to, end) = known[next];
        let (from, start) = known[next.saturating_sub(1)];
        let fraction = if to > from { (index - from) as f32 / (to - from) as f32 } else { 1.0 };
        start + (end - start) * fraction
    };
    let point = |(index, stop): (usize, &Stop)| SourcePoint { at: position(index), code: stop.color };
    stops.iter().enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn code(text: &str, at: f32) -> Vec3 {
        let Ok(read) = read(text) else { panic!("{text} is refused") };
        read.gradient.code(at)
    }

    fn refused(text: &str) -> String {
        read(text).err().map(|error| format!("{}: {}", error.line, error.reason)).unwrap_or_default()
    }

    #[test]
    fn stops_are_placed_as_in_css() {
        let near = |text: &str, at: f32, expected: [f32; 3]| {
            let found = code(text, at);
            assert!(found.distance(Vec3::from(expected)) < 2.0e-3, "{text} at {at}: {found}");
        };
        near("a { background: linear-gradient(to right, black, #fff); }", 0.25, [0.25; 3]);
        near("linear-gradient(90deg, black, red, white)", 0.5, [1.0, 0.0, 0.0]);
        near("linear-gradient(black 20%, white 60%)", 0.4, [0.5; 3]);
        near("linear-gradient(black 20%, white 60%)", 0.1, [0.0; 3]);
        near("linear-gradient(black 0 50%, white 50%)", 0.49, [0.0; 3]);
        near("linear-gradient(black 0 50%, white 50%)", 0.51, [1.0; 3]);
        // A position in front of an earlier one becomes that one.
        near("linear-gradient(black 50%, white 20%, white)", 0.49, [0.0; 3]);
        near("linear-gradient(in srgb-linear, rgb(0 0 0), rgb(255 255 255))", 0.5, [0.735_36; 3]);
        // Multiplied by alpha before mixing: white stays white while it fades. Half of its light is sRGB 188.
        near("linear-gradient(white, transparent)", 0.5, [0.735_36; 3]);
    }

    #[test]
    fn what_is_not_read_is_refused_by_name() {
        for (text, expected) in [
            ("\n\nconic-gradient(red, blue)", "1: no gradient; expected linear-gradient(#402010, white 80%)"),
            (
                "repeating-linear-gradient(red, blue 9%)",
                "1: a repeating gradient is not read; expected linear-gradient(…)",
            ),
            ("\nlinear-gradient(red, blue", "2: the gradient has no end; expected a closing bracket"),
            (
                "linear-gradient(red, 30%, blue)",
                "1: a midpoint without a color is not read; expected colors with positions",
            ),
            (
                "linear-gradient(red 3px, blue)",
                "1: the position 3px is not read; expected percent, of which 100 is the end",
            ),
            ("linear-gradient(rde, blue)", "1: rde is no color; expected one of CSS, as #402010 or rgb(64 32 16)"),
            (
                "linear-gradient(in hsl, red, blue)",
                "1: the color space hsl is not read; expected srgb, srgb-linear or oklab",
            ),
        ] {
            assert_eq!(refused(text), expected);
        }
        let note = read("a {}\nlinear-gradient(red, blue) linear-gradient(red, white)").ok().and_then(|read| read.note);
        assert_eq!(note.as_deref(), Some("2: read the first of 2 linear gradients"));
    }
}
