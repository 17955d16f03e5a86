//! Reads gradients of GIMP, `*.ggr`. (GIMP, devel-docs/ggr.txt)

use std::f32::consts::PI;

use glam::{Vec3, Vec4};

use super::blend_space::srgb_from_linear;
use super::fit_stops::RampFit;
use super::gradient_text::{GradientParseError, parse_numbers};
use super::ramp_recipe::{Blend, Curve, HexColor, RampStop};
use super::source_gradient::{add_straight_stops, composite_over_black, sampled_fit};

/// Difference of hues that counts as none, turns: above the rounding of `f32`, and below a step of 16 bits.
const HUE_TOLERANCE: f32 = 1.0e-6;

/// One segment of a gradient. Positions are 0 to 1; colors are sRGB codes with alpha, 0 to 1.
struct Segment {
    left: f32,
    middle: f32,
    right: f32,
    from: Vec4,
    to: Vec4,
    /// Blending function: 0 linear, 1 curved, 2 sinusoidal, 3 and 4 spherical (increasing, decreasing), 5 step.
    blending: u32,
    /// Coloring: 0 RGB, 1 and 2 HSV with increasing and decreasing hue.
    colors: u32,
}

/// Reads a gradient. Linear segments and steps are exact; other segments are divided into linear pieces with an error
/// of at most a quarter of `max_error`.
pub(super) fn read(text: &str, max_error: f32) -> Result<RampFit, GradientParseError> {
    let segments = segments(text)?;
    let mut stops = Vec::new();
    for segment in &segments {
        if segment.blending == 5 {
            for (at, color) in [(segment.left, segment.from), (segment.middle, segment.to)] {
                let color = HexColor::from_srgb(composite_over_black(color));
                stops.push(RampStop { at, color, curve: Curve::Constant });
            }
            continue;
        }
        for (from, to) in [(segment.left, segment.middle), (segment.middle, segment.right)] {
            add_straight_stops(&mut stops, from, to, max_error / 4.0, &|at| segment.code(at));
        }
    }
    Ok(sampled_fit(Blend::Srgb, stops, |at| {
        let segment = segments.iter().find(|segment| at <= segment.right).or(segments.last());
        segment.map_or(Vec3::ZERO, |segment| segment.code(at))
    }))
}

fn segments(text: &str) -> Result<Vec<Segment>, GradientParseError> {
    let error = |line: usize, reason: &str| GradientParseError { line, reason: reason.into() };
    let mut lines = text.lines().zip(1..).peekable();
    if lines.next().is_none_or(|(line, _)| line.trim() != "GIMP Gradient") {
        return Err(error(1, "not a gradient of GIMP; expected \"GIMP Gradient\""));
    }
    lines.next_if(|(line, _)| line.starts_with("Name:"));
    let count =
        lines.next().and_then(|(line, at)| Some((line.trim().parse::<usize>().ok().filter(|&count| count > 0)?, at)));
    let Some((count, counted)) = count else {
        return Err(error(3, "no number of segments; expected a whole number, 1 or more"));
    };
    let mut segments = Vec::new();
    for (line, at) in lines.take(count) {
        let [left, middle, right, r0, g0, b0, a0, r1, g1, b1, a1, blending, colors] =
            *parse_numbers(line).as_deref().and_then(<[f32]>::first_chunk).ok_or_else(|| {
                let expected = "left, middle, right, two colors of four, blending, colors";
                error(at, &format!("fewer than 13 numbers; expected {expected}"))
            })?;
        let in_order = 0.0 <= left && left <= middle && middle <= right && right <= 1.0;
        let known = (0.0..6.0).contains(&blending) && (0.0..3.0).contains(&colors);
        if !in_order {
            let reason = format!("{left}, {middle}, {right}; expected left, middle and right in order, 0 to 1");
            return Err(error(at, &reason));
        }
        if !known {
            let reason = format!("blending {blending}, colors {colors}; expected 0 to 5 and 0 to 2, whole numbers");
            return Err(error(at, &reason));
        }
        let from = Vec4::new(r0, g0, b0, a0);
        let to = Vec4::new(r1, g1, b1, a1);
        segments.push(Segment { left, middle, right, from, to, blending: blending as u32, colors: colors as u32 });
    }
    if segments.len() < count {
        return Err(error(counted, &format!("{} segments follow; expected {count}", segments.len())));
    }
    Ok(segments)
}

impl Segment {
    /// Returns the sRGB code at a position in the segment.
    fn code(&self, at: f32) -> Vec3 {
        let fraction = |from: f32, to: f32| if to > from { ((at - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        let half = if at < self.middle {
            fraction(self.left, self.middle) / 2.0
        } else {
            0.5 + fraction(self.middle, self.right) / 2.0
        };
        let part = match self.blending {
            1 => {
                let middle =
                    ((self.middle - self.left) / (self.right - self.left).max(1.0e-9)).clamp(1.0e-6, 1.0 - 1.0e-6);
                fraction(self.left, self.right).powf(0.5_f32.ln() / middle.ln())
            }
            2 => (1.0 - (PI * half).cos()) / 2.0,
            3 => (1.0 - (half - 1.0) * (half - 1.0)).max(0.0).sqrt(),
            4 => 1.0 - (1.0 - half * half).max(0.0).sqrt(),
            5 => f32::from(u8::from(at >= self.middle)),
            _ => half,
        };
        let mixed = self.from.lerp(self.to, part);
        if self.colors == 0 {
            return composite_over_black(mixed);
        }
        let from = Blend::HsvNear.of_code(self.from.truncate());
        let to = Blend::HsvNear.of_code(self.to.truncate());
        // Equal hues are a full turn apart in either direction.
        let is_equal = (to.x - from.x - (to.x - from.x).round()).abs() < HUE_TOLERANCE;
        let increase = if is_equal { 0.0 } else { (to.x - from.x).rem_euclid(1.0) };
        let turn = match self.colors {
            1 if is_equal => 1.0,
            1 => increase,
            _ => increase - 1.0,
        };
        let hsv = Vec3::new(from.x + turn * part, from.y + (to.y - from.y) * part, from.z + (to.z - from.z) * part);
        composite_over_black(Blend::HsvNear.linear(hsv).map(srgb_from_linear).extend(mixed.w))
    }
}
