//! Reads gradients of Godot from text resources, `*.tres`.

use glam::Vec4;
use haze_core::error::one_line;

use super::gradient_text::{ChosenGradient, GradientName, GradientParseError, choose_gradient, parse_numbers};
use super::ramp_recipe::Blend;
use super::source_gradient::{Interpolation, NotedGradient, SourceGradient, SourcePoint};

/// A section that holds a gradient.
struct Section<'a> {
    /// Id of a sub-resource; `resource` for the file's own gradient.
    name: &'a str,
    /// Index of the heading.
    line: usize,
    /// Lines of `key = value`, with their indices.
    fields: Vec<(usize, &'a str, &'a str)>,
}

/// Reads the gradient of a name; without a name, the first. A name is the id of a sub-resource, or `resource`.
pub fn read(text: &str, name: Option<&str>) -> Result<NotedGradient, GradientParseError> {
    let sections = sections(text);
    if sections.is_empty() {
        return Err(error(0, "no gradient; expected a Gradient saved by Godot as text"));
    }
    let names: Vec<_> =
        sections.iter().map(|section| GradientName { name: section.name, line: Some(section.line + 1) }).collect();
    let ChosenGradient { index, note } = choose_gradient(&names, name)?;
    Ok(NotedGradient { gradient: sections[index].gradient()?, note })
}

fn error(line: usize, reason: &str) -> GradientParseError {
    GradientParseError { line: line + 1, reason: reason.into() }
}

/// Returns the sections that hold gradients.
fn sections(text: &str) -> Vec<Section<'_>> {
    let mut sections = Vec::new();
    let mut is_gradient_file = false;
    let mut is_inside = false;
    for (line, text) in text.lines().enumerate() {
        let text = text.trim();
        if let Some(heading) = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            let kind = heading.split_whitespace().next().unwrap_or_default();
            let has_gradient = attribute(heading, "type") == Some("Gradient");
            is_gradient_file |= kind == "gd_resource" && has_gradient;
            let name = match kind {
                "resource" if is_gradient_file => Some("resource"),
                "sub_resource" if has_gradient => Some(attribute(heading, "id").unwrap_or_default()),
                _ => None,
            };
            is_inside = name.is_some();
            sections.extend(name.map(|name| Section { name, line, fields: Vec::new() }));
        } else if let (true, Some(section), Some((key, value))) = (is_inside, sections.last_mut(), text.split_once('='))
        {
            section.fields.push((line, key.trim(), value.trim()));
        }
    }
    sections
}

/// Returns an attribute of a heading: `id="Gradient_a"` or `id=1`.
fn attribute<'a>(heading: &'a str, name: &str) -> Option<&'a str> {
    let (_, value) = heading.split_once(&format!(" {name}="))?;
    match value.strip_prefix('"') {
        Some(quoted) => quoted.split('"').next(),
        None => value.split_whitespace().next(),
    }
}

impl Section<'_> {
    fn gradient(&self) -> Result<SourceGradient, GradientParseError> {
        let (_, offsets) = self.list("offsets", &[0.0, 1.0])?;
        let (line, colors) = self.list("colors", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0])?;
        if offsets.is_empty() || colors.len() != 4 * offsets.len() {
            let reason = format!("{} numbers; expected four for each of {} offsets", colors.len(), offsets.len());
            return Err(error(line, &reason));
        }
        // Godot's cubic is a Catmull-Rom spline.
        let interpolations = [Interpolation::Linear, Interpolation::Constant, Interpolation::Cardinal(0.5)];
        let interpolation = interpolations[self.choice("interpolation_mode", 2)?];
        let blend = [Blend::Srgb, Blend::Linear, Blend::Oklab][self.choice("interpolation_color_space", 2)?];
        let point = |(at, color): (&f32, &[f32])| SourcePoint { at: at.clamp(0.0, 1.0), code: Vec4::from_slice(color) };
        let points = offsets.iter().zip(colors.chunks_exact(4)).map(point).collect();
        Ok(SourceGradient::new(blend, interpolation, points))
    }

    /// Returns the line and the value of a field.
    fn find(&self, name: &str) -> Option<(usize, &str)> {
        let field = self.fields.iter().find(|(_, key, _)| *key == name);
        field.map(|(line, _, value)| (*line, *value))
    }

    fn list(&self, name: &str, default: &[f32]) -> Result<(usize, Vec<f32>), GradientParseError> {
        let Some((line, value)) = self.find(name) else { return Ok((self.line, default.to_vec())) };
        let inside = value.split_once('(').and_then(|(_, rest)| rest.strip_suffix(')'));
        match inside.and_then(parse_numbers) {
            Some(numbers) => Ok((line, numbers)),
            None => Err(error(line, &format!("{name} is no list of numbers; expected a packed list of numbers"))),
        }
    }

    fn choice(&self, name: &str, max: usize) -> Result<usize, GradientParseError> {
        let (line, value) = self.find(name).unwrap_or((self.line, "0"));
        let index = value.parse().ok().filter(|index: &usize| *index <= max);
        index.ok_or_else(|| error(line, &format!("{name}: {} is not valid; expected 0 to {max}", one_line(value))))
    }
}
