//! Imports gradients of other programs. `docs/ramps.md` lists what is supported.

use std::path::Path;

use glam::Vec4;
use haze_core::assets::bounded_read;
use haze_core::assets::image::read_color_png;
use haze_core::error::{AssetError, FieldError, display_path, one_line};

use super::blend_space::srgb_from_linear;
use super::fit_stops::{DEFAULT_MAX_ERROR, RampFit, fit_image, validate_max_error};
use super::gradient_text::{GradientParseError, parse_numbers};
use super::ramp_recipe::Blend;
use super::source_gradient::{Interpolation, NotedGradient, SourceGradient, SourcePoint};
use super::{color_tables, css, gimp, godot, grd, svg};

/// Extensions of gradients of other programs.
pub const GRADIENT_ENDINGS: [&str; 9] = ["ggr", "tres", "txt", "svg", "css", "cpt", "gpl", "pal", "grd"];

/// Extensions of files that may have several gradients.
const ENDINGS_OF_SEVERAL: [&str; 3] = ["tres", "svg", "grd"];

/// Size limit of a text file, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Size limit of a file of Photoshop, which holds a library of gradients, bytes.
const MAX_LIBRARY_BYTES: u64 = 16 << 20;

/// A recipe made of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedGradient {
    /// The recipe and its error.
    pub fit: RampFit,
    /// File, line, the gradient that was read, and those that were not; what a gradient of Photoshop has besides. `None` if all is
    /// read.
    pub note: Option<String>,
}

/// Converts a file to a recipe. The format follows from the extension: `.png`, or one of [`GRADIENT_ENDINGS`]. `max_error`
/// is the maximum error of a channel, 1 to 64 steps of 255; without, [`DEFAULT_MAX_ERROR`], and for a PNG as [`fit_image`]
/// chooses. `name` chooses one of several gradients in a file of Godot,
/// SVG or Photoshop. Transparent colors are darkened by their alpha, in linear light.
///
/// # Errors
/// [`AssetError::Io`] and [`AssetError::Image`] for files that cannot be read, [`AssetError::Text`] for a malformed line,
/// [`AssetError::Field`] for a `max_error` out of range, an unknown extension, or a `name` for a file of one gradient.
pub fn import_gradient(
    path: &Path,
    max_error: Option<f32>,
    name: Option<&str>,
) -> Result<ImportedGradient, AssetError> {
    validate_max_error(max_error)?;
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    if let Some(name) = name.filter(|_| !ENDINGS_OF_SEVERAL.contains(&ending.as_str())) {
        let expected = "no name: only a .tres, .svg or .grd has several gradients";
        return Err(FieldError::new("gradient", format!("{name:?}"), expected).into());
    }
    if ending == "png" {
        let refuse = |error: FieldError| AssetError::Image { path: path.into(), reason: error.to_string() };
        let fit = fit_image(&read_color_png(path)?, max_error).map_err(refuse)?;
        return Ok(ImportedGradient { fit, note: None });
    }
    let max_error = max_error.unwrap_or(DEFAULT_MAX_ERROR);
    if !GRADIENT_ENDINGS.contains(&ending.as_str()) {
        let expected = format!("a name that ends in .png or .{}", GRADIENT_ENDINGS.join(", ."));
        return Err(FieldError::new("file", path.display(), expected).into());
    }
    let refuse = |GradientParseError { line, reason }: GradientParseError| AssetError::Text {
        path: path.into(),
        line,
        column: 1,
        reason,
    };
    if ending == "grd" {
        let bytes = bounded_read::read(path, "gradient", MAX_LIBRARY_BYTES)?;
        let refuse = |reason| AssetError::Image { path: path.into(), reason };
        let NotedGradient { gradient, note } = grd::read(&bytes, name).map_err(refuse)?;
        let fit = gradient.fit(max_error);
        fit.recipe.validate()?;
        return Ok(ImportedGradient { fit, note: note.map(|note| format!("{}: {note}", display_path(path))) });
    }
    let bytes = bounded_read::read(path, "gradient", MAX_BYTES)?;
    let text = std::str::from_utf8(&bytes).map_err(|_| {
        refuse(GradientParseError { line: 1, reason: "not UTF-8; expected a gradient as UTF-8 text".into() })
    })?;
    let mut note = None;
    let mut noted = |read: NotedGradient| {
        note = read.note.map(|note| format!("{}:{note}", display_path(path)));
        read.gradient
    };
    let gradient = match ending.as_str() {
        // Its segments have forms of their own.
        "ggr" => {
            let fit = gimp::read(text, max_error).map_err(refuse)?;
            fit.recipe.validate()?;
            return Ok(ImportedGradient { fit, note: None });
        }
        "txt" => blender(text),
        "css" => css::read(text).map(&mut noted),
        "cpt" => color_tables::read_cpt(text),
        "gpl" | "pal" => color_tables::read_palette(text),
        "svg" => svg::read(text, name).map(&mut noted),
        _ => godot::read(text, name).map(&mut noted),
    };
    let fit = gradient.map_err(refuse)?.fit(max_error);
    fit.recipe.validate()?;
    Ok(ImportedGradient { fit, note })
}

/// Reads lines of `position r g b [alpha]` in linear light, with optional brackets and commas, and lines of
/// `interpolation NAME`.
fn blender(text: &str) -> Result<SourceGradient, GradientParseError> {
    let mut interpolation = Interpolation::Linear;
    let mut points = Vec::new();
    for (line, text) in text.lines().enumerate() {
        let refuse = |reason: String| GradientParseError { line: line + 1, reason };
        let text = text.split('#').next().unwrap_or_default();
        let words: Vec<_> = text
            .split(|c: char| c.is_whitespace() || "=:,()[]<>'\"".contains(c))
            .filter(|word| !word.is_empty())
            .collect();
        match words[..] {
            [] | ["color_mode", "RGB"] => {}
            ["interpolation", name] => {
                interpolation = match name {
                    "CONSTANT" => Interpolation::Constant,
                    "LINEAR" => Interpolation::Linear,
                    "EASE" => Interpolation::Ease,
                    "CARDINAL" => Interpolation::Cardinal(0.71),
                    "B_SPLINE" => Interpolation::BSpline,
                    _ => {
                        let expected = "CONSTANT, LINEAR, EASE, CARDINAL or B_SPLINE";
                        return Err(refuse(format!(
                            "interpolation {} is not valid; expected {expected}",
                            one_line(name)
                        )));
                    }
                }
            }
            ["color_mode", ..] => {
                let expected = "RGB: set it in Blender, or import an image of the ramp";
                return Err(refuse(format!("the color mode is not RGB; expected {expected}")));
            }
            _ => {
                let (at, light) = match parse_numbers(&words.join(",")).as_deref() {
                    Some(&[at, r, g, b]) => (at, Vec4::new(r, g, b, 1.0)),
                    Some(&[at, r, g, b, a]) => (at, Vec4::new(r, g, b, a)),
                    _ => {
                        let expected = "a position and a color: 0.5 (0.8, 0.4, 0.1, 1.0)";
                        return Err(refuse(format!("not a stop; expected {expected}")));
                    }
                };
                let code = light.truncate().map(srgb_from_linear).extend(light.w);
                points.push(SourcePoint { at: at.clamp(0.0, 1.0), code });
            }
        }
    }
    if points.is_empty() {
        let reason = "no stops; expected lines of a position and a color: 0.5 (0.8, 0.4, 0.1, 1.0)";
        return Err(GradientParseError { line: 1, reason: reason.into() });
    }
    let mut gradient = SourceGradient::new(Blend::Linear, interpolation, points);
    if matches!(interpolation, Interpolation::Cardinal(_) | Interpolation::BSpline) {
        // Blender's splines begin at 0 and end at 1.
        gradient.extend_to_ends();
    }
    Ok(gradient)
}

#[cfg(test)]
mod tests {
    use super::super::ramp_recipe::{Curve, RampRecipe};
    use super::*;

    fn import_text(name: &str, text: &str) -> Result<RampRecipe, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let shown = |error: AssetError| error.to_string().replace(&format!("{}/", folder.path().display()), "");
        import_gradient(&path, None, None).map(|imported| imported.fit.recipe).map_err(shown)
    }

    fn stops(recipe: &RampRecipe) -> Vec<(f32, String, Curve)> {
        recipe.rows[0].stops.iter().map(|stop| (stop.at, stop.color.into(), stop.curve)).collect()
    }

    const GODOT: &str = "[gd_resource type=\"Gradient\" format=3]\n\n[resource]\ninterpolation_mode = 1\n\
        offsets = PackedFloat32Array(0, 0.25, 1)\n\
        colors = PackedColorArray(0, 0, 0, 1, 1, 0.5, 0, 1, 2, 1, 1, 1)\ninterpolation_color_space = 2\n";

    #[test]
    fn godot_gradients_are_read() {
        let recipe = import_text("a.tres", GODOT).unwrap();
        assert_eq!(recipe.blend, Blend::Oklab);
        let stop = |at: f32, color: &str| (at, color.to_owned(), Curve::Constant);
        assert_eq!(stops(&recipe), [stop(0.0, "#000000"), stop(0.25, "#ff8000"), stop(1.0, "#ffffff")]);
        // Godot does not write fields that have their default value.
        let plain = import_text("a.tres", "[gd_resource type=\"Gradient\"]\n[resource]\n").unwrap();
        assert_eq!((plain.blend, stops(&plain).len()), (Blend::Srgb, 2));
        for (from, to, expected) in [
            ("0.25, 1)", "0.25)", "a.tres:6:1: 12 numbers; expected four for each of 2 offsets"),
            ("0.25, 1)", "NaN, 1)", "a.tres:5:1: offsets is no list of numbers; expected a packed list of numbers"),
            ("mode = 1", "mode = 7", "a.tres:4:1: interpolation_mode: 7 is not valid; expected 0 to 2"),
            ("Gradient", "Curve", "a.tres:1:1: no gradient; expected a Gradient saved by Godot as text"),
        ] {
            assert_eq!(import_text("a.tres", &GODOT.replace(from, to)).unwrap_err(), expected);
        }
    }

    #[test]
    fn files_of_photoshop_are_read_as_bytes() {
        let refused = import_text("a.grd", "8BGR\0\u{3}").unwrap_err();
        assert!(refused.starts_with("a.grd: version 3 of the format; expected version 5: open it in"), "{refused}");
        assert!(import_text("a.grd", "GIMP Gradient").unwrap_err().starts_with("a.grd: not a gradient of Photoshop"));
    }

    const TWO_GRADIENTS: &str = "[gd_resource type=\"ParticleProcessMaterial\" load_steps=4 format=3]\n\n\
        [sub_resource type=\"Gradient\" id=\"Gradient_a\"]\ncolors = PackedColorArray(1, 0.5, 0, 1, 0.1, 0.1, 0.1, 1)\n\n\
        [sub_resource type=\"GradientTexture1D\" id=\"GradientTexture1D_a\"]\ngradient = SubResource(\"Gradient_a\")\n\n\
        [sub_resource type=\"Gradient\" id=\"Gradient_b\"]\ninterpolation_mode = 1\noffsets = PackedFloat32Array(0, 0.5, 1)\n\
        colors = PackedColorArray(0, 0, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1)\n\n\
        [resource]\ncolor_ramp = SubResource(\"GradientTexture1D_a\")\ninterpolation_mode = 9\n";

    #[test]
    fn gradients_of_one_godot_file_are_read_by_section() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.tres");
        std::fs::write(&path, TWO_GRADIENTS).unwrap();
        let import = |name| import_gradient(&path, None, name);
        let first = import(None).unwrap();
        let stop = |at: f32, color: &str, curve| (at, color.to_owned(), curve);
        let linear = [stop(0.0, "#ff8000", Curve::Linear), stop(1.0, "#1a1a1a", Curve::Linear)];
        assert_eq!(stops(&first.fit.recipe), linear);
        let note = first.note.unwrap();
        assert!(
            note.ends_with("two.tres:3: read gradient Gradient_a, not Gradient_b; --gradient chooses one"),
            "{note}"
        );
        let second = import(Some("Gradient_b")).unwrap();
        assert_eq!((stops(&second.fit.recipe).len(), second.note), (3, None));
        assert_eq!(second.fit.recipe.rows[0].stops[1].curve, Curve::Constant);
        let refused = import(Some("Gradient_c")).unwrap_err().to_string();
        assert!(refused.ends_with("no gradient \"Gradient_c\"; expected one of Gradient_a, Gradient_b"), "{refused}");
        let refused = import_gradient(Path::new("a.ggr"), None, Some("b")).unwrap_err().to_string();
        assert!(refused.contains("expected no name: only a .tres, .svg or .grd has several gradients"), "{refused}");
    }

    #[test]
    fn equal_hues_of_gimp_are_a_full_turn_apart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ggr");
        for colors in [1, 2] {
            let text = format!("GIMP Gradient\nName: A\n1\n0 0.5 1 1 0.749 0.749 1 1 0.749 0.749 1 0 {colors}\n");
            std::fs::write(&path, text).unwrap();
            let fit = import_gradient(&path, None, None).unwrap().fit;
            let light = fit.recipe.gradient().unwrap().sample(0.5, 0.0);
            let code = light.map(srgb_from_linear);
            assert!(code.distance(glam::Vec3::new(0.749, 1.0, 1.0)) < 0.01 && fit.error <= 1.5, "{colors}: {code}");
        }
    }

    #[test]
    fn an_image_without_a_gradient_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("noise.png");
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let noise = image::RgbImage::from_fn(256, 256, |_, _| image::Rgb([random(), random(), random()]));
        noise.save(&path).unwrap();
        let error = import_gradient(&path, Some(1.0), None).unwrap_err().to_string();
        assert!(
            error.contains("noise.png: stops: the image needs 6") && error.contains("expected at most 50000"),
            "{error}"
        );
    }

    #[test]
    fn blender_stops_are_read_as_linear_light() {
        let text = "# a ramp\ncolor_mode = 'RGB'\ninterpolation: EASE\n0.5 (0.2140, 0.0, 1.0, 1.0)\n0, 0.5, 0.5, 0.5, 1\n\n1.5 [0 0 0]";
        let recipe = import_text("a.txt", text).unwrap();
        assert_eq!(recipe.blend, Blend::Linear);
        let stop = |at: f32, color: &str| (at, color.to_owned(), Curve::Ease);
        assert_eq!(stops(&recipe), [stop(0.0, "#bcbcbc"), stop(0.5, "#7f00ff"), stop(1.0, "#000000")]);
        for (text, expected) in [
            ("0.5 1 1", "a.txt:1:1: not a stop; expected a position and a color: 0.5 (0.8, 0.4, 0.1, 1.0)"),
            (
                "\ninterpolation X",
                "a.txt:2:1: interpolation X is not valid; expected CONSTANT, LINEAR, EASE, CARDINAL or B_SPLINE",
            ),
            ("# nothing", "a.txt:1:1: no stops; expected lines of a position and a color: 0.5 (0.8, 0.4, 0.1, 1.0)"),
        ] {
            assert_eq!(import_text("a.txt", text).unwrap_err(), expected);
        }
        assert!(
            import_text("a.txt", "color_mode HSV").unwrap_err().contains("the color mode is not RGB; expected RGB")
        );
        assert!(
            import_text("a.gradient", "").unwrap_err().contains("expected a name that ends in .png or .ggr, .tres")
        );
    }

    #[test]
    fn gimp_gradients_are_read() {
        let ggr = |segments: &[&str]| format!("GIMP Gradient\nName: A\n{}\n{}\n", segments.len(), segments.join("\n"));
        let linear = "0.0 0.2 0.5 0 0 0 1 1 1 1 1 0 0 0 0";
        let step = "0.5 0.75 1.0 1 0 0 1 0 0 1 1 5 0 0 0";
        let recipe = import_text("a.ggr", &ggr(&[linear, step])).unwrap();
        assert_eq!(recipe.blend, Blend::Srgb);
        let stop = |at: f32, color: &str, curve| (at, color.to_owned(), curve);
        let expected = [
            stop(0.0, "#000000", Curve::Linear),
            stop(0.2, "#808080", Curve::Linear),
            stop(0.5, "#ffffff", Curve::Linear),
            stop(0.5, "#ff0000", Curve::Constant),
            stop(0.75, "#0000ff", Curve::Constant),
        ];
        assert_eq!(stops(&recipe), expected);
        // Curved, spherical, HSV and transparent segments are approximated by short linear pieces.
        for (blend, color) in [(1, 0), (2, 0), (3, 0), (4, 0), (0, 1), (0, 2), (2, 2)] {
            let text = ggr(&[&format!("0 0.3 1 0.9 0.2 0.1 1 0.1 0.3 0.8 0.5 {blend} {color} 0 0")]);
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.ggr");
            std::fs::write(&path, text).unwrap();
            let fitted = import_gradient(&path, None, None).unwrap().fit;
            let count = fitted.recipe.rows[0].stops.len();
            assert!(fitted.error <= 1.5 && count > 4 && count < 80, "{blend} {color}: {count}, {}", fitted.error);
        }
        for (text, expected) in [
            ("GIMP Palette\n", "a.ggr:1:1: not a gradient of GIMP; expected \"GIMP Gradient\""),
            (
                "GIMP Gradient\nName: A\n1\n0 0 1\n",
                "a.ggr:4:1: fewer than 13 numbers; expected left, middle, right, two colors of four, blending, colors",
            ),
            ("GIMP Gradient\nName: A\n2\n", "a.ggr:3:1: 0 segments follow; expected 2"),
            ("GIMP Gradient\nName: A\n", "a.ggr:3:1: no number of segments; expected a whole number, 1 or more"),
        ] {
            assert_eq!(import_text("a.ggr", text).unwrap_err(), expected);
        }
        let turned = "0.5 0.2 0.0 0 0 0 1 1 1 1 1 0 0";
        assert!(
            import_text("a.ggr", &ggr(&[turned]))
                .unwrap_err()
                .contains("4:1: 0.5, 0.2, 0; expected left, middle and right in order")
        );
    }
}
