//! Gradients of other programs, which mix colors and alpha separately, and their approximation by opaque stops.

use glam::{Vec3, Vec4};

use super::blend_space::srgb_from_linear;
use super::fit_stops::RampFit;
use super::ramp_recipe::{Blend, Curve, HexColor, RampRecipe, RampRow, RampStop};

/// A gradient of points. Constant before the first point and after the last.
pub struct SourceGradient {
    blend: Blend,
    interpolation: Interpolation,
    /// Colors are multiplied by their alpha before they are mixed, and divided by the mixed alpha.
    is_premultiplied: bool,
    /// Sorted by position.
    points: Vec<SourcePoint>,
}

/// A gradient, and a note on others in its file, with its line, and on what is not read.
pub struct NotedGradient {
    pub gradient: SourceGradient,
    pub note: Option<String>,
}

#[derive(Clone, Copy, Debug)]
pub struct SourcePoint {
    /// Position, 0 to 1.
    pub at: f32,
    /// sRGB code and alpha. Not clamped: colors above 1 are mixed first.
    pub code: Vec4,
}

/// Interpolation of colors and alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interpolation {
    Constant,
    Linear,
    Ease,
    /// Cardinal spline through the points; its tangents are the differences of both neighbors times this number.
    Cardinal(f32),
    /// Uniform cubic B-spline near the points.
    BSpline,
}

impl SourceGradient {
    pub fn new(blend: Blend, interpolation: Interpolation, mut points: Vec<SourcePoint>) -> Self {
        points.sort_by(|a, b| a.at.total_cmp(&b.at));
        Self { blend, interpolation, is_premultiplied: false, points }
    }

    /// Returns the same points with linear interpolation of colors that are multiplied by their alpha.
    pub fn premultiplied(blend: Blend, points: Vec<SourcePoint>) -> Self {
        Self { is_premultiplied: true, ..Self::new(blend, Interpolation::Linear, points) }
    }

    /// Repeats the first point at 0 and the last at 1.
    pub fn extend_to_ends(&mut self) {
        let first = self.points.first().copied();
        self.points.splice(..0, first.map(|first| SourcePoint { at: 0.0, ..first }));
        let last = self.points.last().copied();
        self.points.extend(last.map(|last| SourcePoint { at: 1.0, ..last }));
    }

    /// Converts to stops over black. Stops are exact if they can be; otherwise straight pieces have an error of at most a
    /// quarter of `max_error`, steps of 255.
    pub fn fit(&self, max_error: f32) -> RampFit {
        let (blend, stops) = match self.exact_curve() {
            Some(curve) => (self.blend, self.exact_stops(curve)),
            None => (Blend::Srgb, self.straight_stops(max_error / 4.0)),
        };
        sampled_fit(blend, stops, |at| self.code(at))
    }

    /// Returns the curve by which opaque stops give the same gradient, if there is one. Alpha that is mixed multiplies a
    /// color that is mixed: no curve does.
    fn exact_curve(&self) -> Option<Curve> {
        let is_opaque = |point: &SourcePoint| {
            let color = point.code.truncate();
            point.code.w >= 1.0 && color == color.clamp(Vec3::ZERO, Vec3::ONE)
        };
        match self.interpolation {
            Interpolation::Constant => Some(Curve::Constant),
            Interpolation::Linear if self.points.iter().all(is_opaque) => Some(Curve::Linear),
            Interpolation::Ease if self.points.iter().all(is_opaque) => Some(Curve::Ease),
            _ => None,
        }
    }

    fn exact_stops(&self, curve: Curve) -> Vec<RampStop> {
        let stop = |point: &SourcePoint| {
            let color = HexColor::from_srgb(composite_over_black(point.code));
            RampStop { at: point.at, color, curve }
        };
        self.points.iter().map(stop).collect()
    }

    fn straight_stops(&self, max_error: f32) -> Vec<RampStop> {
        let mut stops = Vec::new();
        for next in 1..self.points.len() {
            let from = self.points[next - 1].at;
            let to = self.points[next].at;
            if from < to {
                add_straight_stops(&mut stops, from, to, max_error, &|at| self.code_before(next, at));
            }
        }
        if stops.is_empty() {
            stops = self.exact_stops(Curve::Linear);
        }
        stops
    }

    /// Returns the sRGB code over black at a position.
    pub fn code(&self, at: f32) -> Vec3 {
        let next = self.points.partition_point(|point| point.at <= at);
        if next > 0 && next < self.points.len() {
            return self.code_before(next, at);
        }
        let end = if next == 0 { self.points.first() } else { self.points.last() };
        end.map_or(Vec3::ZERO, |end| composite_over_black(end.code))
    }

    /// Returns the sRGB code over black between a point that is not the first and the one before it.
    fn code_before(&self, next: usize, at: f32) -> Vec3 {
        let last = self.points.len() - 1;
        let near = [next.saturating_sub(2), next - 1, next, (next + 1).min(last)].map(|index| self.points[index]);
        let [_, p1, p2, _] = near;
        let t = ((at - p1.at) / (p2.at - p1.at).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        let t2 = t * t;
        let t3 = t * t * t;
        let weights = match self.interpolation {
            Interpolation::Constant => Vec4::new(0.0, 1.0, 0.0, 0.0),
            Interpolation::Linear => Vec4::new(0.0, 1.0 - t, t, 0.0),
            Interpolation::Ease => {
                let eased = 3.0 * t2 - 2.0 * t3;
                Vec4::new(0.0, 1.0 - eased, eased, 0.0)
            }
            Interpolation::Cardinal(c) => Vec4::new(
                c * (2.0 * t2 - t3 - t),
                (2.0 - c) * t3 + (c - 3.0) * t2 + 1.0,
                (c - 2.0) * t3 + (3.0 - 2.0 * c) * t2 + c * t,
                c * (t3 - t2),
            ),
            Interpolation::BSpline => {
                let from_end = 1.0 - t;
                Vec4::new(from_end * from_end * from_end, 3.0 * t3 - 6.0 * t2 + 4.0, 3.0 * (t + t2 - t3) + 1.0, t3)
                    / 6.0
            }
        };
        let mut mixed = Vec4::ZERO;
        for (point, weight) in near.iter().zip(weights.to_array()) {
            let factor = if self.is_premultiplied { point.code.w } else { 1.0 };
            mixed += (self.blend.of_code(point.code.truncate()) * factor).extend(point.code.w) * weight;
        }
        let alpha = if self.is_premultiplied { mixed.w.max(f32::MIN_POSITIVE) } else { 1.0 };
        let light = self.blend.linear(mixed.truncate() / alpha).min(Vec3::ONE);
        (light * mixed.w.clamp(0.0, 1.0)).map(srgb_from_linear)
    }
}

/// Composites an sRGB code over black, in linear light.
pub fn composite_over_black(code: Vec4) -> Vec3 {
    let code = code.clamp(Vec4::ZERO, Vec4::ONE);
    if code.w >= 1.0 {
        return code.truncate();
    }
    (Blend::Srgb.linear(code.truncate()) * code.w).map(srgb_from_linear)
}

/// Adds stops from one position to another, so many that the sRGB codes between them are within `max_error` steps of
/// 255 of straight lines. A stop that repeats the last one is left out.
pub fn add_straight_stops(stops: &mut Vec<RampStop>, from: f32, to: f32, max_error: f32, code: &impl Fn(f32) -> Vec3) {
    let start = RampStop { at: from, color: HexColor::from_srgb(code(from)), curve: Curve::Linear };
    match stops.last_mut().filter(|last| (last.at, last.color) == (start.at, start.color)) {
        Some(last) => last.curve = start.curve,
        None => stops.push(start),
    }
    let is_straight = [0.25, 0.5, 0.75].into_iter().all(|part| {
        let straight = code(from).lerp(code(to), part);
        let off = code(from + (to - from) * part) - straight;
        off.abs().max_element() * 255.0 <= max_error
    });
    // The minimum length of 1e-4 is smaller than a texel of the widest ramp.
    if !is_straight && to - from > 1.0e-4 {
        let middle = f32::midpoint(from, to);
        add_straight_stops(stops, from, middle, max_error, code);
        add_straight_stops(stops, middle, to, max_error, code);
    } else {
        stops.push(RampStop { at: to, color: HexColor::from_srgb(code(to)), curve: Curve::Linear });
    }
}

/// Builds the recipe of a ramp of one row. Its error is sampled against the sRGB code of the source at a position.
pub fn sampled_fit(blend: Blend, stops: Vec<RampStop>, code: impl Fn(f32) -> Vec3) -> RampFit {
    /// Twice the widest ramp.
    const SAMPLES: u16 = 8192;
    /// Error of a stop's 8-bit color, which may lie between two samples.
    const ROUNDING: f32 = 0.5;
    let rows = vec![RampRow { stops, ..RampRow::default() }];
    let recipe = RampRecipe { blend, rows, ..RampRecipe::default() };
    let mut error: f32 = ROUNDING;
    if let Ok(gradient) = recipe.gradient() {
        // Between the positions of texels, at which edges usually are.
        for at in (0..SAMPLES).map(|index| (f32::from(index) + 0.5) / f32::from(SAMPLES)) {
            let made = gradient.sample(at, 0.0).min(Vec3::ONE).map(srgb_from_linear);
            error = error.max((made - code(at)).abs().max_element() * 255.0);
        }
    }
    RampFit { recipe, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(blend: Blend, interpolation: Interpolation, points: &[(f32, [f32; 4])]) -> SourceGradient {
        let point = |&(at, code): &(f32, [f32; 4])| SourcePoint { at, code: Vec4::from(code) };
        SourceGradient::new(blend, interpolation, points.iter().map(point).collect())
    }

    fn shown(fit: &RampFit, at: f32) -> f32 {
        srgb_from_linear(fit.recipe.gradient().unwrap().sample(at, 0.0).x) * 255.0
    }

    /// White that fades to transparent.
    const FADE: [(f32, [f32; 4]); 2] = [(0.0, [1.0; 4]), (1.0, [1.0, 1.0, 1.0, 0.0])];

    #[test]
    fn alpha_is_mixed_before_it_darkens() {
        for blend in [Blend::Srgb, Blend::Linear, Blend::Oklab] {
            let fit = gradient(blend, Interpolation::Linear, &FADE).fit(1.5);
            // Half of white is light of 0.5: sRGB 187.5, not 127.5.
            assert!((shown(&fit, 0.5) - 187.5).abs() < 1.0, "{blend:?}: {}", shown(&fit, 0.5));
            assert!(fit.error <= 1.5, "{blend:?}: {}", fit.error);
            let off = (0..500).map(|index| (index as f32 + 0.5) / 500.0).map(|at| {
                let code = srgb_from_linear(1.0 - at) * 255.0;
                (shown(&fit, at) - code).abs()
            });
            let off = off.fold(0.0, f32::max);
            assert!((off - fit.error).abs() < 0.3, "{blend:?}: {off} is not {}", fit.error);
        }
        // A color that fades too: half of its light, and half of that.
        let color = [(0.0, [1.0; 4]), (1.0, [0.0; 4])];
        let fit = gradient(Blend::Linear, Interpolation::Linear, &color).fit(1.5);
        assert!((shown(&fit, 0.5) - srgb_from_linear(0.25) * 255.0).abs() < 1.0, "{}", shown(&fit, 0.5));
    }

    #[test]
    fn opaque_gradients_keep_their_stops_and_others_get_few() {
        let opaque = [(0.0, [0.0, 0.0, 0.0, 1.0]), (0.3, [1.0, 0.5, 0.0, 1.0]), (1.0, [1.0; 4])];
        for (interpolation, curve) in [(Interpolation::Linear, Curve::Linear), (Interpolation::Ease, Curve::Ease)] {
            let fit = gradient(Blend::Oklab, interpolation, &opaque).fit(1.5);
            assert_eq!(fit.recipe.blend, Blend::Oklab);
            assert!(fit.recipe.rows[0].stops.iter().all(|stop| stop.curve == curve));
            assert_eq!(fit.recipe.rows[0].stops.len(), 3);
            assert!(fit.error < 0.8, "{}", fit.error);
        }
        let fit = gradient(Blend::Srgb, Interpolation::Constant, &FADE).fit(1.5);
        assert_eq!((fit.recipe.rows[0].stops.len(), fit.error), (2, 0.5));
        let count = gradient(Blend::Srgb, Interpolation::Linear, &FADE).fit(1.5).recipe.rows[0].stops.len();
        assert!((4..40).contains(&count), "{count}");
        // Colors above 1 are mixed before they are clamped: white up to the middle.
        let bright = [(0.0, [2.0, 2.0, 2.0, 1.0]), (1.0, [0.0, 0.0, 0.0, 1.0])];
        let fit = gradient(Blend::Srgb, Interpolation::Linear, &bright).fit(1.5);
        assert!(shown(&fit, 0.45) > 254.0 && (shown(&fit, 0.75) - 127.5).abs() < 1.0 && fit.error <= 1.5);
        // An edge, and a single point.
        let edge = [(0.0, [0.0; 4]), (0.5, [0.0; 4]), (0.5, [1.0; 4]), (1.0, [1.0, 1.0, 1.0, 0.5])];
        let fit = gradient(Blend::Srgb, Interpolation::Linear, &edge).fit(1.5);
        assert!(shown(&fit, 0.499) < 1.0 && shown(&fit, 0.501) > 254.0 && fit.error <= 1.5, "{}", fit.error);
        let fit = gradient(Blend::Srgb, Interpolation::BSpline, &edge[3..]).fit(1.5);
        assert!((shown(&fit, 0.2) - 187.5).abs() < 1.0 && fit.error <= 0.5);
    }

    #[test]
    fn splines_are_those_of_blender_and_godot() {
        let gray = |light: f32| {
            let code = srgb_from_linear(light);
            [code, code, code, 1.0]
        };
        let points = [(0.2, gray(0.0)), (0.4, gray(0.8)), (0.8, gray(0.2))];
        let shown_light = |interpolation, at: f32| {
            let mut source = gradient(Blend::Linear, interpolation, &points);
            source.extend_to_ends();
            let fit = source.fit(1.0);
            assert!(fit.error <= 1.0, "{}", fit.error);
            fit.recipe.gradient().unwrap().sample(at, 0.0).x
        };
        // At a point, a B-spline has a sixth of each neighbor; halfway, 1/48 and 23/48 of two on each side.
        let near = |light: f32, expected: f32| assert!((light - expected).abs() < 0.006, "{light} is not {expected}");
        near(shown_light(Interpolation::BSpline, 0.4), (0.0 + 4.0 * 0.8 + 0.2) / 6.0);
        near(shown_light(Interpolation::BSpline, 0.6), (0.0 + 23.0 * 0.8 + 23.0 * 0.2 + 0.2) / 48.0);
        near(shown_light(Interpolation::BSpline, 0.2), 0.8 / 6.0);
        near(shown_light(Interpolation::BSpline, 0.1), 0.8 / 48.0);
        near(shown_light(Interpolation::BSpline, 0.9), (0.8 + 47.0 * 0.2) / 48.0);
        // Halfway, a cardinal spline has -c/8 of the outer points, and the rest of the inner ones.
        near(shown_light(Interpolation::Cardinal(0.71), 0.4), 0.8);
        let inner = 0.5 + 0.71 / 8.0;
        near(shown_light(Interpolation::Cardinal(0.71), 0.6), inner * (0.8 + 0.2) - 0.71 / 8.0 * (0.0 + 0.2));
        near(shown_light(Interpolation::Cardinal(0.5), 0.3), 0.5625 * 0.8 - 0.0625 * 0.2);
    }
}
