//! Reads gradients of SVG, as Inkscape, Krita and Illustrator write them. (W3C, SVG 2, "Paint Servers")

use glam::Vec4;
use haze_core::error::one_line;
use roxmltree::{Document, Node};

use super::gradient_text::{ChosenGradient, GradientName, GradientParseError, choose_gradient};
use super::ramp_recipe::Blend;
use super::source_gradient::{Interpolation, NotedGradient, SourceGradient, SourcePoint};

/// Most links from a gradient to the one that has its stops.
const MAX_LINKS: usize = 16;

/// Reads the gradient of an id; without one, the first that has stops.
pub fn read(text: &str, name: Option<&str>) -> Result<NotedGradient, GradientParseError> {
    let document = Document::parse(text).map_err(|error| {
        // The line is told apart.
        let problem = error.to_string().replace(&format!(" at {}", error.pos()), "");
        let reason = format!("{}; expected an SVG file", one_line(problem));
        GradientParseError { line: error.pos().row as usize, reason }
    })?;
    let line_of = |node: &Node| document.text_pos_at(node.range().start).row as usize;
    let is_gradient = |node: &Node| ["linearGradient", "radialGradient"].contains(&node.tag_name().name());
    // A gradient that is used has its own position and the stops of another one.
    let gradients: Vec<_> = document.descendants().filter(|node| is_gradient(node) && has_stops(node)).collect();
    if gradients.is_empty() {
        let reason = "no gradient; expected a linearGradient or radialGradient with stops";
        return Err(GradientParseError { line: 1, reason: reason.into() });
    }
    let name_of = |node: &Node<'_, '_>| node.attribute("id").unwrap_or_default().to_owned();
    let ids: Vec<_> = gradients.iter().map(name_of).collect();
    let names: Vec<_> =
        ids.iter().zip(&gradients).map(|(name, node)| GradientName { name, line: Some(line_of(node)) }).collect();
    // An id may be that of a gradient without stops of its own.
    let linked = name.and_then(|name| with_stops(&document, name));
    let linked = linked.and_then(|linked| gradients.iter().position(|gradient| *gradient == linked));
    let ChosenGradient { index, note } = match linked {
        Some(index) => ChosenGradient { index, note: None },
        None => choose_gradient(&names, name)?,
    };
    let gradient = gradients[index];
    let sheets = StyleSheets::new(&document);
    let stops: Vec<_> = gradient.children().filter(is_stop).collect();
    for (property, nodes) in
        [("stop-color", &stops[..]), ("stop-opacity", &stops), ("color-interpolation", &[gradient])]
    {
        let node = nodes.iter().find(|node| inline(node, property).is_none());
        if let Some((line, _)) = sheets.line_of(property).zip(node) {
            let expected = "it in the style of each stop or gradient: export with inline styles";
            let reason = format!("{property} may be set by this style sheet, which is not read; expected {expected}");
            return Err(GradientParseError { line, reason });
        }
    }
    let interpolation = gradient.ancestors().find_map(|node| property(&node, "color-interpolation"));
    let is_linear = interpolation == Some("linearRGB");
    let mut points = Vec::new();
    let mut most = 0.0_f32;
    for stop in stops {
        let mut point = point(&stop).map_err(|reason| GradientParseError { line: line_of(&stop), reason })?;
        // A stop in front of an earlier one becomes that one.
        most = most.max(point.at);
        point.at = most;
        points.push(point);
    }
    let blend = if is_linear { Blend::Linear } else { Blend::Srgb };
    Ok(NotedGradient { gradient: SourceGradient::new(blend, Interpolation::Linear, points), note })
}

fn is_stop(node: &Node) -> bool {
    node.tag_name().name() == "stop"
}

fn has_stops(node: &Node) -> bool {
    node.children().any(|child| is_stop(&child))
}

/// Returns the gradient of an id, or the one with stops that it links to.
fn with_stops<'a>(document: &'a Document<'a>, id: &str) -> Option<Node<'a, 'a>> {
    let find = |id: &str| document.descendants().find(|node| node.attribute("id") == Some(id));
    let mut node = find(id)?;
    for _ in 0..MAX_LINKS {
        if has_stops(&node) {
            return Some(node);
        }
        let link = node.attributes().find(|attribute| attribute.name() == "href")?;
        node = find(link.value().strip_prefix('#')?)?;
    }
    None
}

/// Returns a property: of the style, or the attribute of its name.
fn property<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    inline(node, name).or(node.attribute(name).map(str::trim))
}

/// Returns a property of the style, which prevails over style sheets; an attribute does not.
fn inline<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    let style = node.attribute("style").unwrap_or_default();
    let of_style = style.split(';').filter_map(|part| part.split_once(':')).find(|(key, _)| key.trim() == name);
    of_style.map(|(_, value)| value.trim())
}

/// Style sheets of a file: their lines and rules; no rules for one in another file.
struct StyleSheets(Vec<(usize, Option<String>)>);

impl StyleSheets {
    fn new(document: &Document) -> Self {
        let line_of = |node: &Node| document.text_pos_at(node.range().start).row as usize;
        let sheets = document.descendants().filter_map(|node| {
            let is_other_file = node.pi().is_some_and(|pi| pi.target == "xml-stylesheet") || node.has_tag_name("link");
            if is_other_file {
                return Some((line_of(&node), None));
            }
            let is_style = node.is_element() && node.tag_name().name() == "style";
            let text: String = node.descendants().filter(Node::is_text).filter_map(|text| text.text()).collect();
            let rules = without_comments(&text);
            is_style.then(|| (line_of(&node), (!rules.contains("@import")).then_some(rules)))
        });
        Self(sheets.collect())
    }

    /// Returns the line of the first sheet that may set a property.
    fn line_of(&self, property: &str) -> Option<usize> {
        let sets = |rules: &String| {
            let mut found = rules.match_indices(property);
            // `-` and letters continue a name.
            found.any(|(at, name)| {
                let before = rules[..at].chars().next_back();
                let starts = !before.is_some_and(|c| c.is_alphanumeric() || c == '-' || c == '_');
                starts && rules[at + name.len()..].trim_start().starts_with(':')
            })
        };
        self.0.iter().find(|(_, rules)| rules.as_ref().is_none_or(sets)).map(|(line, _)| *line)
    }
}

fn without_comments(text: &str) -> String {
    let mut parts = text.split("/*");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |rules, part| rules + " " + part.split_once("*/").map_or("", |(_, rest)| rest))
}

fn point(stop: &Node) -> Result<SourcePoint, String> {
    let at = fraction(stop.attribute("offset").unwrap_or("0"))
        .ok_or("a stop without a valid offset; expected 0 to 1, or percent")?;
    if property(stop, "stop-color").is_none() && stop.attribute("class").is_some() {
        let expected = "stop-color in an attribute or in style: export with presentation attributes";
        return Err(format!("the color of a stop is in a style sheet, which is not read; expected {expected}"));
    }
    let color = property(stop, "stop-color").unwrap_or("black");
    let parsed = csscolorparser::parse(color)
        .map_err(|_| format!("stop-color {} is no color; expected one of CSS, as #402010", one_line(color)))?;
    let opacity = fraction(property(stop, "stop-opacity").unwrap_or("1"))
        .ok_or("a stop without a valid stop-opacity; expected 0 to 1, or percent")?;
    Ok(SourcePoint { at, code: Vec4::new(parsed.r, parsed.g, parsed.b, parsed.a * opacity) })
}

/// Reads 0 to 1, or percent; clamped.
fn fraction(text: &str) -> Option<f32> {
    let text = text.trim();
    let (number, unit) = match text.strip_suffix('%') {
        Some(percent) => (percent, 100.0),
        None => (text, 1.0),
    };
    let number: f32 = number.trim().parse().ok()?;
    number.is_finite().then(|| (number / unit).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const INKSCAPE: &str = r##"<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">
  <defs>
    <linearGradient id="stops">
      <stop style="stop-color:#ff0000;stop-opacity:1;" offset="0.2" />
      <stop style="stop-color:#0000ff;stop-opacity:0.5;" offset="100%" />
    </linearGradient>
    <linearGradient id="used" xlink:href="#stops" x1="3" x2="8" gradientUnits="userSpaceOnUse" />
    <radialGradient id="other" color-interpolation="linearRGB">
      <stop stop-color="black"/><stop offset="1" stop-color="white"/>
    </radialGradient>
  </defs>
</svg>"##;

    fn refused(text: &str) -> String {
        read(text, None).err().map(|error| format!("{}: {}", error.line, error.reason)).unwrap_or_default()
    }

    #[test]
    fn gradients_are_chosen_by_their_id_or_by_one_that_links_to_them() {
        let Ok(first) = read(INKSCAPE, None) else { panic!("refused") };
        assert_eq!(first.note.as_deref(), Some("4: read gradient stops, not other; --gradient chooses one"));
        assert!(first.gradient.code(0.1).distance(Vec3::X) < 1.0e-4);
        // sRGB 1 at half alpha is 188 of 255.
        assert!(first.gradient.code(1.0).distance(Vec3::new(0.0, 0.0, 0.735_36)) < 1.0e-3);
        for (name, at, expected) in [("used", 0.0, [1.0, 0.0, 0.0]), ("other", 0.5, [0.735_36; 3])] {
            let Ok(found) = read(INKSCAPE, Some(name)) else { panic!("{name} is refused") };
            let code = found.gradient.code(at);
            assert!(found.note.is_none() && code.distance(Vec3::from(expected)) < 1.0e-3, "{name}: {code}");
        }
        let unknown = read(INKSCAPE, Some("gone")).err().map(|error| error.reason);
        assert_eq!(unknown.as_deref(), Some("no gradient \"gone\"; expected one of stops, other"));
    }

    #[test]
    fn what_is_not_read_is_refused_by_name() {
        let of_stop = |stop: &str| refused(&format!("<svg>\n<linearGradient>\n<stop {stop}/></linearGradient></svg>"));
        assert!(of_stop("class=\"a\"").starts_with("3: the color of a stop is in a style sheet"));
        assert!(of_stop("stop-color=\"rde\"").starts_with("3: stop-color rde is no color"));
        assert!(of_stop("offset=\"x\"").starts_with("3: a stop without a valid offset"));
        assert!(refused("<svg/>").starts_with("1: no gradient; expected a linearGradient"));
        assert!(refused("<svg>").ends_with("; expected an SVG file"));
        assert_eq!(refused("<svg a=1/>"), "1: expected a quote not '1'; expected an SVG file");
    }

    #[test]
    fn style_sheets_that_may_set_a_stop_are_refused() {
        let of_sheet = |sheet: &str, stops: &str| {
            refused(&format!("<svg>\n{sheet}<linearGradient id=\"a\">{stops}</linearGradient></svg>"))
        };
        let attributes = r#"<stop id="b" class="c" stop-color="red"/>"#;
        let inline = r#"<stop class="c" style="stop-color:red"/>"#;
        for rule in [
            "stop { stop-color: blue }",
            "#b{stop-color:blue}",
            "linearGradient > .c { fill: none; stop-color :blue }",
            "@media screen { * { stop-color: blue } }",
        ] {
            let sheet = format!("<style>{rule}</style>");
            let said = of_sheet(&sheet, attributes);
            assert!(
                said.starts_with("2: stop-color may be set by this style sheet, which is not read"),
                "{rule}: {said}"
            );
            assert_eq!(of_sheet(&sheet, inline), "", "{rule}");
        }
        let faded = "<style>stop { stop-opacity: 0.5 }</style>";
        assert!(of_sheet(faded, inline).starts_with("2: stop-opacity may be set"), "{}", of_sheet(faded, inline));
        let linear = "<style><![CDATA[ #a { color-interpolation: linearRGB } ]]></style>";
        assert!(of_sheet(linear, inline).starts_with("2: color-interpolation may be set"));
        for other_file in ["<style>@import url(a.css);</style>", "<?xml-stylesheet href='a.css'?>"] {
            assert!(of_sheet(other_file, attributes).starts_with("2: stop-color may be set"), "{other_file}");
        }
        for unrelated in [
            "<style>.s0 { fill: url(#a); color-interpolation-filters: sRGB }</style>",
            "<style>/* stop { stop-color: blue } */ stop { --stop-color: blue }</style>",
        ] {
            assert_eq!(of_sheet(unrelated, attributes), "", "{unrelated}");
        }
    }

    #[test]
    fn the_space_of_colors_is_inherited() {
        let text = "<svg color-interpolation=\"linearRGB\"><linearGradient><stop stop-color=\"black\"/>\
                    <stop offset=\"1\" stop-color=\"white\"/></linearGradient></svg>";
        let Ok(read) = read(text, None) else { panic!("refused") };
        assert!(read.gradient.code(0.5).distance(Vec3::splat(0.735_36)) < 1.0e-3, "{}", read.gradient.code(0.5));
    }
}
