//! Writes the gradient of a ramp for other programs: SVG, CSS and GIMP.

use std::fmt::Write as _;
use std::path::Path;

use glam::Vec3;
use haze_core::error::FieldError;

use super::blend_space::srgb_from_linear;
use super::ramp_recipe::{RampRecipe, RampStop};
use super::source_gradient::add_straight_stops;

/// Extensions of the formats.
pub const EXPORT_ENDINGS: [&str; 3] = ["svg", "css", "ggr"];

/// Largest error of the straight pieces, steps of 255.
const MAX_ERROR: f32 = 0.5;

/// Returns the text of a file. The format follows from the extension of `path`, one of [`EXPORT_ENDINGS`]; its name becomes
/// the name of the gradient.
///
/// # Errors
/// [`FieldError`] for a recipe that is not valid or has more than one row, and for another extension.
pub fn export_gradient(recipe: &RampRecipe, path: &Path) -> Result<String, FieldError> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let stops = straight_stops(recipe)?;
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => Ok(svg(&name, &stops)),
        Some("css") => Ok(css(&stops)),
        Some("ggr") => Ok(ggr(&name, &stops)),
        _ => {
            let expected = format!("a name that ends in .{}", EXPORT_ENDINGS.join(", ."));
            Err(FieldError::new("--output", path.display(), expected))
        }
    }
}

/// Returns stops with straight pieces of sRGB between them. Two at one position are a hard edge.
fn straight_stops(recipe: &RampRecipe) -> Result<Vec<RampStop>, FieldError> {
    let gradient = recipe.gradient()?;
    if recipe.rows.len() != 1 || !recipe.times.is_empty() {
        return Err(FieldError::from_problem("rows", "the ramp has two axes", "a ramp of one row, without times"));
    }
    let code = |at: f32| gradient.sample(at, 0.0).min(Vec3::ONE).map(srgb_from_linear);
    let inner = recipe.rows[0].stops.iter().map(|stop| stop.at).filter(|at| *at > 0.0 && *at < 1.0);
    let mut edges: Vec<f32> = [0.0].into_iter().chain(inner).chain([1.0]).collect();
    edges.sort_by(f32::total_cmp);
    edges.dedup();
    let mut stops = Vec::new();
    for ends in edges.windows(2) {
        let from = ends[0];
        let to = ends[1];
        // The end of a piece belongs to the next one if an edge is there.
        let before = |at: f32| code(at.min(to.next_down()));
        add_straight_stops(&mut stops, from, to, MAX_ERROR, &before);
    }
    stops.dedup_by(|next, stop| (next.at, next.color) == (stop.at, stop.color));
    Ok(stops)
}

fn svg(name: &str, stops: &[RampStop]) -> String {
    let is_plain = |character: char| character.is_ascii_alphanumeric() || character == '_' || character == '-';
    let id: String = name.chars().map(|character| if is_plain(character) { character } else { '_' }).collect();
    // An id begins with a letter.
    let id = if id.starts_with(|first: char| first.is_ascii_alphabetic()) { id } else { format!("ramp_{id}") };
    let mut text = String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"512\" height=\"64\">\n");
    let _ = writeln!(text, "  <linearGradient id=\"{id}\">");
    for stop in stops {
        let _ = writeln!(text, "    <stop offset=\"{}\" stop-color=\"{}\"/>", stop.at, String::from(stop.color));
    }
    let _ = writeln!(text, "  </linearGradient>\n  <rect width=\"512\" height=\"64\" fill=\"url(#{id})\"/>\n</svg>");
    text
}

fn css(stops: &[RampStop]) -> String {
    // Four decimals are finer than the texels of any ramp.
    let percent = |at: f32| (f64::from(at) * 1.0e6).round() / 1.0e4;
    let stop = |stop: &RampStop| format!("{} {}%", String::from(stop.color), percent(stop.at));
    let stops: Vec<_> = stops.iter().map(stop).collect();
    format!("linear-gradient(to right, {})\n", stops.join(", "))
}

fn ggr(name: &str, stops: &[RampStop]) -> String {
    let pieces: Vec<_> = stops.windows(2).filter(|ends| ends[0].at < ends[1].at).collect();
    let name = name.replace(['\r', '\n'], " ");
    let mut text = format!("GIMP Gradient\nName: {name}\n{}\n", pieces.len());
    for ends in pieces {
        let [from, to] = [ends[0].color.srgb(), ends[1].color.srgb()];
        let middle = f32::midpoint(ends[0].at, ends[1].at);
        let _ = writeln!(
            text,
            "{} {middle} {} {} {} {} 1 {} {} {} 1 0 0",
            ends[0].at, ends[1].at, from.x, from.y, from.z, to.x, to.y, to.z
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::import_gradient::import_gradient;
    use super::super::ramp_recipe::{Curve, HexColor, RampRow};
    use super::*;

    #[test]
    fn exported_gradients_are_read_back_within_a_step() {
        let stop = |at: f32, color: [u8; 3], curve: Curve| RampStop { at, color: HexColor(color), curve };
        let stops = vec![
            stop(0.1, [255, 240, 210], Curve::Monotone),
            stop(0.4, [122, 80, 48], Curve::Constant),
            stop(0.7, [0, 0, 255], Curve::Linear),
            stop(0.9, [0, 0, 0], Curve::Linear),
        ];
        let recipe = RampRecipe { rows: vec![RampRow { stops, ..RampRow::default() }], ..RampRecipe::default() };
        let code = |recipe: &RampRecipe, at: f32| recipe.gradient().unwrap().sample(at, 0.0).map(srgb_from_linear);
        let folder = tempfile::tempdir().unwrap();
        for ending in EXPORT_ENDINGS {
            let path = folder.path().join(format!("my ramp.{ending}"));
            std::fs::write(&path, export_gradient(&recipe, &path).unwrap()).unwrap();
            let read = import_gradient(&path, Some(1.0), None).unwrap().fit.recipe;
            for index in 0..1000 {
                let at = (index as f32 + 0.5) / 1000.0;
                let off = (code(&read, at) - code(&recipe, at)).abs().max_element() * 255.0;
                assert!(off <= 1.3, "{ending}: {off} steps off at {at}");
            }
        }
        let refused = export_gradient(&recipe, Path::new("a.png")).unwrap_err().to_string();
        assert!(refused.ends_with("expected a name that ends in .svg, .css, .ggr"), "{refused}");
        let two = RampRecipe { rows: vec![RampRow::default(), RampRow { at: 1.0, ..RampRow::default() }], ..recipe };
        assert!(export_gradient(&two, Path::new("a.svg")).is_err());
    }
}
