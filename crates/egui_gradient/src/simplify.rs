//! Gradients with fewer stops, and the errors of these.

use glam::Vec3;
use haze_author::ramp::fit_stops::fit_row;
use haze_author::ramp::{Blend, RampStop};
use haze_core::formula::color::srgb_from_linear;

use super::stop_operations::gradient;

/// Number of colors at which gradients are compared.
const SAMPLES: usize = 256;

/// Gradient with few stops, and its largest difference from the original in any channel, steps of 255 of sRGB code.
#[derive(Clone, Debug, PartialEq)]
pub struct Simplified {
    pub stops: Vec<RampStop>,
    pub error: f32,
}

/// Returns simpler gradients, from the fewest stops to the most, each nearer to the original than the one before.
pub fn simplified(stops: &[RampStop], blend: Blend) -> Vec<Simplified> {
    let Some(row) = codes(stops, blend) else { return Vec::new() };
    let mut found: Vec<Simplified> = Vec::new();
    // Bounds from 1 to 128, in steps of a quarter.
    for bound in (0..=28).map(|step| 2.0_f32.powf(step as f32 * 0.25)) {
        let fitted = fit_row(&row, blend, bound);
        let Some(simple) = codes(&fitted, blend) else { continue };
        let error = row.iter().zip(simple).map(|(a, b)| (a - b).abs().max_element()).fold(0.0, f32::max);
        if (2..stops.len()).contains(&fitted.len()) {
            found.push(Simplified { stops: fitted, error });
        }
    }
    found.sort_by(|a, b| a.stops.len().cmp(&b.stops.len()).then(a.error.total_cmp(&b.error)));
    found.dedup_by_key(|simple| simple.stops.len());
    let mut least = f32::INFINITY;
    found.retain(|simple| {
        let is_nearer = simple.error < least;
        least = least.min(simple.error);
        is_nearer
    });
    found
}

/// sRGB codes along a gradient, 0 to 255.
fn codes(stops: &[RampStop], blend: Blend) -> Option<Vec<Vec3>> {
    let gradient = gradient(stops, blend).ok()?;
    let code = |index: usize| {
        let light = gradient.sample(index as f32 / (SAMPLES - 1) as f32, 0.0);
        light.map(|light| 255.0 * srgb_from_linear(light.clamp(0.0, 1.0)))
    };
    Some((0..SAMPLES).map(code).collect())
}

#[cfg(test)]
mod tests {
    use haze_author::ramp::{Curve, HexColor};

    use super::*;

    #[test]
    fn fewer_stops_cost_more_and_needless_stops_cost_nothing() {
        let stop = |(at, gray)| RampStop { curve: Curve::Linear, ..RampStop::new(at, HexColor([gray; 3])) };
        // The stops at 0.25 and 0.75 lie on the lines between their neighbours.
        let stops = [(0.0, 0), (0.25, 50), (0.5, 100), (0.75, 60), (1.0, 20)].map(stop);
        let found = simplified(&stops, Blend::Srgb);
        let figures: Vec<_> = found.iter().map(|simple| (simple.stops.len(), simple.error)).collect();
        let three = found.iter().find(|simple| simple.stops.len() == 3).unwrap();
        assert!(three.error < 1.5, "{figures:?}");
        let two = found.iter().find(|simple| simple.stops.len() == 2).unwrap();
        assert!((30.0..100.0).contains(&two.error), "{figures:?}");
        assert!(figures.is_sorted_by(|a, b| a.0 < b.0 && a.1 > b.1), "{figures:?}");
        assert!(simplified(&stops[..2], Blend::Srgb).is_empty());
    }
}
