//! Checks a ramp's image for visible defects.

use glam::Vec3;
use haze_core::assets::ramp::RampRole;
use haze_core::formula::color::{linear_from_srgb, luminance, srgb_from_linear};
use image::DynamicImage;

use crate::finding::Finding;

/// Minimum jump in luminance that counts as a step or a seam, of 255: a twentieth of white.
const JUMP: f32 = 12.0;
/// Minimum ratio of a jump to the differences beside it.
const RATIO: f32 = 3.0;
/// Brightest 16-bit code that counts as black: 1 of 255, for rounding.
const BLACK: u16 = 257;

/// Name of the finding of visible steps, which is a warning.
pub const BANDING: &str = "banding";

/// Returns the defects of an sRGB image that would be visible. Without a role, only the checks that hold for every role
/// run.
///
/// - `banding`: a gradient of visible steps: 8 bits without dithering.
/// - `step`: a jump of luminance along either axis, except in diffuse and coverage ramps: toon shading needs steps.
/// - `seam`: a first or last texel that does not continue the gradient, such as a frame or a scaling artefact.
/// - `ends`: a specular ramp that is not black at amount 0 or at distance 1.
/// - `round`: a specular ramp whose brightest column is not distance 0, like an image of a round glow.
/// - `turned`: a gradient from top to bottom instead of left to right.
pub fn lint_ramp(image: &DynamicImage, role: Option<RampRole>) -> Vec<Finding> {
    let pixels = image.to_rgb16();
    let (width, height) = pixels.dimensions();
    let mut findings = Vec::new();
    let mut find =
        |name, description: String| findings.push(Finding { name, description, is_warning: name == BANDING });
    if height > width && pixels.rows().all(|mut row| row.next().is_some_and(|first| row.all(|pixel| pixel == first))) {
        find(
            "turned",
            format!("every row of {width}x{height} pixels has one color; expected a gradient from left to right"),
        );
        return findings;
    }
    let texel = |x: u32, y: u32| pixels.get_pixel(x, height - 1 - y).0;
    let along_rows: Vec<Vec<[u16; 3]>> = (0..height).map(|y| (0..width).map(|x| texel(x, y)).collect()).collect();
    let along_columns: Vec<Vec<[u16; 3]>> = (0..width).map(|x| (0..height).map(|y| texel(x, y)).collect()).collect();
    let lines = || along_rows.iter().map(|line| ("across", line)).chain(along_columns.iter().map(|line| ("up", line)));

    if pixels.iter().all(|channel| channel % 257 == 0)
        && let Some((axis, at)) = lines().find_map(|(axis, line)| Some((axis, find_banding(line)?)))
    {
        find(BANDING, format!("visible steps at {at:.2} {axis}; expected 16 bits a channel, or 8 bits with dithering"));
    }
    let jump = lines().find_map(|(axis, line)| Some((axis, find_step(&luminances(line))?)));
    let may_jump = matches!(role, None | Some(RampRole::Diffuse | RampRole::Coverage | RampRole::Shadow));
    if let Some((axis, at)) = jump.filter(|_| !may_jump) {
        find("step", format!("luminance jumps at {at:.2} {axis}; expected a slope of several texels"));
    }
    if let Some((axis, end)) = lines().find_map(|(axis, line)| Some((axis, find_seam(&luminances(line))?))) {
        find(
            "seam",
            format!("the {end} texel {axis} differs from its neighbours; expected the gradient to continue to the end"),
        );
    }
    if role == Some(RampRole::Specular) {
        let brightest = |line: &[[u16; 3]]| line.iter().flatten().copied().max().unwrap_or_default();
        for (line, end, why) in [
            (along_rows.first(), "amount 0, the bottom row", "lights glow where there is no smoke"),
            (along_columns.last(), "distance 1, the last column", "the quads of lights show"),
        ] {
            if let Some(bright) = line.map(|line| brightest(line)).filter(|&bright| bright > BLACK) {
                find("ends", format!("brightness {} of 255 at {end}; expected black: otherwise {why}", bright / 257));
            }
        }
        let lightest = along_columns.first().map_or(0, |line| brightest(line));
        let most = along_rows.iter().map(|line| brightest(line)).max().unwrap_or_default();
        if findings.is_empty() && lightest < most / 2 {
            let lightest = lightest / 257;
            let most = most / 257;
            findings.push(Finding {
                name: "round",
                description: format!(
                    "brightness {lightest} of 255 at distance 0, the first column, but {most} farther out; expected the first \
                     column to be the brightest: the axes are distance and amount, not an image of a glow"
                ),
                is_warning: false,
            });
        }
    }
    findings
}

/// Returns the sRGB code of each texel's luminance, 0 to 255.
fn luminances(line: &[[u16; 3]]) -> Vec<f32> {
    let linear = |channel: u16| linear_from_srgb(f32::from(channel) / 65535.0);
    line.iter().map(|texel| srgb_from_linear(luminance(Vec3::from(texel.map(linear)))) * 255.0).collect()
}

fn fraction_along(index: usize, count: usize) -> f32 {
    index as f32 / (count - 1).max(1) as f32
}

/// Returns the position of banding, 0 to 1: four consecutive steps of a channel in one direction, of one or two codes
/// each, after at least six equal texels each. Dithered gradients alternate in direction and do not match.
fn find_banding(line: &[[u16; 3]]) -> Option<f32> {
    (0..3).find_map(|channel| {
        let codes: Vec<i32> = line.iter().map(|texel| i32::from(texel[channel] / 257)).collect();
        let mut length = 1;
        let mut steps = 0;
        let mut last = 0;
        for (index, pair) in codes.windows(2).enumerate() {
            let step = pair[1] - pair[0];
            if step == 0 {
                length += 1;
                continue;
            }
            let goes_on = length >= 6 && step.abs() <= 2 && (steps == 0 || step.signum() == last);
            steps = if goes_on { steps + 1 } else { 0 };
            length = 1;
            last = step.signum();
            if steps == 4 {
                return Some(fraction_along(index, codes.len()));
            }
        }
        None
    })
}

/// Returns the position of a jump in luminance, 0 to 1, ignoring the first and last texel.
fn find_step(line: &[f32]) -> Option<f32> {
    let jumps: Vec<f32> = line.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let stands_out = |near: &&[f32]| near[1] >= JUMP && near[1] >= RATIO * near[0].max(near[2]);
    jumps.windows(3).position(|near| stands_out(&near)).map(|index| fraction_along(index + 1, line.len()))
}

/// Returns the end whose texel differs from its neighbours.
fn find_seam(line: &[f32]) -> Option<&'static str> {
    let &[a, b, c, ref rest @ ..] = line else { return None };
    let stands_out = |a: f32, b: f32, c: f32| (a - b).abs() >= JUMP && (a - b).abs() >= RATIO * (b - c).abs();
    let &[.., x, y, z] = rest else { return None };
    match () {
        () if stands_out(a, b, c) => Some("first"),
        () if stands_out(z, y, x) => Some("last"),
        () => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::ramp_recipe::{Curve, HexColor, RampRecipe, RampRow, RampStop};
    use super::super::template::TEMPLATES;
    use super::*;
    use haze_core::assets::image::decode_png;
    use haze_preset::builtin;
    use image::{ImageBuffer, Rgb};
    use std::collections::BTreeSet;
    use std::path::Path;

    fn names(image: &DynamicImage, role: Option<RampRole>) -> Vec<&'static str> {
        lint_ramp(image, role).into_iter().map(|finding| finding.name).collect()
    }

    #[test]
    fn built_in_ramps_and_templates_have_no_findings() {
        for ramp in builtin::RAMPS {
            let image = decode_png(Path::new(ramp.name), ramp.bytes).unwrap();
            let role = RampRole::from_name(ramp.name);
            assert!(role.is_some());
            assert_eq!(lint_ramp(&image, role), [], "{}", ramp.name);
        }
        let mut seen = BTreeSet::new();
        for template in TEMPLATES {
            assert!(seen.insert(template.name));
            for bits in [8, 16] {
                let image = RampRecipe { bits, ..template.recipe() }.bake().unwrap();
                assert_eq!(lint_ramp(&image, Some(template.role)), [], "{} {bits}", template.name);
            }
        }
    }

    fn gray(width: u32, height: u32, value: impl Fn(u32, u32) -> u32) -> DynamicImage {
        DynamicImage::ImageRgb8(ImageBuffer::from_fn(width, height, |x, y| Rgb([value(x, y) as u8; 3])))
    }

    #[test]
    fn every_finding_is_found() {
        // 40 codes over 256 texels, without and with dithering.
        assert_eq!(names(&gray(256, 1, |x, _| 20 + x * 40 / 256), None), ["banding"]);
        assert_eq!(names(&gray(16, 256, |x, y| 20 + x * 8 + y * 40 / 256), None), ["banding"]);
        let stop = |at, gray| RampStop::new(at, HexColor([gray; 3]));
        let rows = vec![RampRow { stops: vec![stop(0.0, 20), stop(1.0, 60)], ..RampRow::default() }];
        assert!(names(&RampRecipe { bits: 8, rows, ..RampRecipe::default() }.bake().unwrap(), None).is_empty());

        let toon = gray(256, 1, |x, _| if x < 100 { 30 } else { 200 });
        assert_eq!(names(&toon, Some(RampRole::Scatter)), ["step"]);
        assert!(names(&toon, Some(RampRole::Diffuse)).is_empty() && names(&toon, None).is_empty());
        let hard = Curve::Constant;
        let rows = [(0.0, 0), (0.5, 90)].map(|(at, gray)| RampRow {
            at,
            curve: hard,
            stops: vec![stop(0.0, gray), stop(1.0, 0)],
        });
        let rings = RampRecipe { width: 64, height: 64, rows: rows.into(), ..RampRecipe::default() };
        assert_eq!(names(&rings.bake().unwrap(), Some(RampRole::Specular)), ["step"]);

        let framed = gray(64, 1, |x, _| if x == 63 { 0 } else { 60 + x * 3 });
        assert_eq!(names(&framed, None), ["seam"]);
        assert_eq!(names(&framed.fliph(), None), ["seam"]);
        let turned = gray(1, 64, |_, y| y * 4);
        assert_eq!(names(&turned, Some(RampRole::Diffuse)), ["turned"]);

        let recipe = TEMPLATES.iter().find(|template| template.role == RampRole::Specular).unwrap().recipe();
        let glow = recipe.bake().unwrap();
        assert_eq!(names(&glow.flipv(), Some(RampRole::Specular)), ["ends"]);
        assert_eq!(names(&glow.fliph(), Some(RampRole::Specular)), ["ends"]);
        assert!(names(&glow.fliph(), Some(RampRole::Diffuse)).is_empty());
        let place = "sqrt(abs(2 * u - 1) ^ 2 + abs(2 * v - 1) ^ 2)".into();
        let round = RampRecipe { place, times: Vec::new(), ..recipe }.bake().unwrap();
        assert_eq!(names(&round, Some(RampRole::Specular)), ["round"]);
        assert!(names(&round, None).is_empty());
        let description = &lint_ramp(&glow.flipv(), Some(RampRole::Specular))[0].description;
        assert!(
            description.contains("at amount 0, the bottom row; expected black: otherwise lights glow"),
            "{description}"
        );
    }

    #[test]
    fn images_of_few_texels_do_not_panic() {
        for (width, height) in [(1, 1), (2, 1), (1, 2), (3, 3), (4, 1), (5, 5), (6, 6)] {
            names(&gray(width, height, |x, y| (x * 97 + y * 61) % 256), Some(RampRole::Specular));
        }
    }

    #[test]
    fn the_role_follows_from_the_file_name() {
        assert_eq!(RampRole::from_name("specular_moon.png"), Some(RampRole::Specular));
        assert_eq!(RampRole::from_name("age.ramp.json"), Some(RampRole::Age));
        assert_eq!(RampRole::from_name("moon.png"), None);
    }
}
