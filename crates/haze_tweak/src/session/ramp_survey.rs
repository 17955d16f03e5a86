//! Ramp coordinates that an image samples, at a limited number of pixels.

use std::collections::BTreeMap;

use glam::{UVec2, Vec2};
use haze_core::error::Error;
use haze_demo::capture::ProbeInputs;
use haze_reference::{LightProbe, SystemProbe};

/// Largest number of pixels that are sampled.
const MAX_SAMPLED_PIXELS: u32 = 10_000;

/// Number of bins of a histogram; `SIDE` is that along each side of a ramp with two axes.
pub const BINS: usize = 64;
pub const SIDE: usize = 32;

/// Distance within which a sample counts as at a position on a ramp.
pub const NEAR: f32 = 0.02;

/// Place on a ramp of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RampPosition {
    /// Coordinate from the cosine N·L between normal and light.
    Diffuse(f32),
    /// Accumulated amount.
    SoftScatter(f32),
    /// Amount times boost.
    Coverage(f32),
    /// Both coordinates.
    TwoAxes(TwoAxisRamp, Vec2),
}

impl RampPosition {
    /// Returns true if both are on the same ramp, and nearly at the same position.
    pub fn is_near(self, other: Self) -> bool {
        match (self, other) {
            (Self::Diffuse(a), Self::Diffuse(b))
            | (Self::SoftScatter(a), Self::SoftScatter(b))
            | (Self::Coverage(a), Self::Coverage(b)) => is_near(a, b),
            (Self::TwoAxes(ramp, a), Self::TwoAxes(other, b)) => ramp == other && is_near_2d(a, b),
            _ => false,
        }
    }
}

fn is_near(a: f32, b: f32) -> bool {
    (a - b).abs() <= NEAR
}

fn is_near_2d(a: Vec2, b: Vec2) -> bool {
    is_near(a.x, b.x) && is_near(a.y, b.y)
}

/// Ramp that is looked up by two coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TwoAxisRamp {
    /// Smoke in front of the light, and angle between light and viewer.
    Shadow,
    /// Squared distance, and amount.
    Specular,
    /// Heat, and amount of what burns times boost.
    Fire,
}

impl TwoAxisRamp {
    /// Returns the coordinates that the smoke at a pixel looks up, with the index of the light; `None` for fire.
    pub fn lookups(self, probe: &SystemProbe) -> impl Iterator<Item = (Option<usize>, Vec2)> {
        let of_light = move |light: &LightProbe| {
            let coordinate = match self {
                Self::Shadow => light.shadow?.coordinate,
                Self::Specular => light.glow?.coordinate,
                Self::Fire => return None,
            };
            Some((Some(light.light), coordinate))
        };
        let fire = probe.fire.filter(|_| self == Self::Fire).map(|fire| (None, fire.coordinate));
        probe.lights.iter().filter_map(of_light).chain(fire)
    }
}

/// Smoke at the sampled pixels.
pub struct RampSurvey {
    /// Size of the image in pixels.
    pub size: UVec2,
    /// Distance between sampled pixels, in pixels.
    pub step: u32,
    samples: Vec<(UVec2, SystemProbe)>,
}

/// Frequency of each part of a ramp, weighted by coverage and scaled to a maximum of 1.
pub struct Histogram {
    /// Index of the light; `None` for fire.
    pub light: Option<usize>,
    pub bins: Vec<f32>,
}

impl RampSurvey {
    /// # Errors
    /// If the texels belong to another shot.
    pub fn of(witness: &ProbeInputs) -> Result<Self, Error> {
        let size = witness.shot().size;
        let step = (size.element_product() as f32 / MAX_SAMPLED_PIXELS as f32).sqrt().ceil().max(1.0) as u32;
        let column = |y| (step / 2..size.x).step_by(step as usize).map(move |x| UVec2::new(x, y));
        let pixels: Vec<_> = (step / 2..size.y).step_by(step as usize).flat_map(column).collect();
        let probes = witness.probe(&pixels)?;
        let of_pixel = |(pixel, probe): (UVec2, haze_reference::Probe)| {
            probe.systems.into_iter().map(move |system| (pixel, system))
        };
        let samples = pixels.into_iter().zip(probes).flat_map(of_pixel).collect();
        Ok(Self { size, step, samples })
    }

    fn probes_of_system(&self, system: usize) -> impl Iterator<Item = &(UVec2, SystemProbe)> {
        self.samples.iter().filter(move |(_, probe)| probe.system == system)
    }

    /// Returns histograms of the diffuse ramp, one for each light.
    pub fn by_light(&self, system: usize) -> Vec<Histogram> {
        self.count_by_light(system, |probe| probe.lights.iter().map(|light| (Some(light.light), light.coordinate)))
    }

    /// Returns histograms of a ramp along an axis, 0 across or 1 up, one for each light.
    pub fn along(&self, axis: usize, ramp: TwoAxisRamp, system: usize) -> Vec<Histogram> {
        self.count_by_light(system, |probe| ramp.lookups(probe).map(|(light, at)| (light, at[axis])))
    }

    /// Returns histograms of a coordinate for each light, with a common maximum. `lookups`: those of a pixel.
    fn count_by_light<'a, I>(&'a self, system: usize, lookups: impl Fn(&'a SystemProbe) -> I) -> Vec<Histogram>
    where
        I: Iterator<Item = (Option<usize>, f32)>,
    {
        let mut counts = BTreeMap::new();
        for (_, probe) in self.probes_of_system(system) {
            for (light, coordinate) in lookups(probe) {
                counts.entry(light).or_insert_with(|| vec![0.0; BINS])[bin(coordinate, BINS)] += probe.coverage;
            }
        }
        let most = largest(counts.values().flatten());
        let mut histograms: Vec<_> = counts.into_iter().map(|(light, bins)| Histogram { light, bins }).collect();
        histograms.iter_mut().for_each(|histogram| scale(&mut histogram.bins, most));
        histograms
    }

    /// Returns the histogram of the soft scatter ramp, over the amount.
    pub fn by_amount(&self, system: usize) -> Vec<f32> {
        self.count(system, |probe| (probe.amount, probe.coverage))
    }

    /// Returns the histogram of the coverage ramp. Every pixel has the same weight, even where the ramp hides nothing.
    pub fn by_coverage(&self, system: usize) -> Vec<f32> {
        self.count(system, |probe| (probe.coverage_coordinate, 1.0))
    }

    /// Returns a weighted histogram of a coordinate.
    fn count(&self, system: usize, of: impl Fn(&SystemProbe) -> (f32, f32)) -> Vec<f32> {
        let mut bins = vec![0.0; BINS];
        for (coordinate, weight) in self.probes_of_system(system).map(|(_, probe)| of(probe)) {
            bins[bin(coordinate, BINS)] += weight;
        }
        let most = largest(&bins);
        scale(&mut bins, most);
        bins
    }

    /// Returns the histogram of a ramp over both axes, summed over all lights: `SIDE` rows, upwards.
    pub fn over_both_axes(&self, ramp: TwoAxisRamp, system: usize) -> Vec<f32> {
        let mut bins = vec![0.0; SIDE * SIDE];
        for (_, probe) in self.probes_of_system(system) {
            for (_, at) in ramp.lookups(probe) {
                bins[bin(at.y, SIDE) * SIDE + bin(at.x, SIDE)] += probe.coverage;
            }
        }
        let most = largest(&bins);
        scale(&mut bins, most);
        bins
    }

    /// Returns the sampled pixels whose smoke samples a position on a ramp.
    pub fn at(&self, system: usize, ramp_position: RampPosition) -> Vec<UVec2> {
        let looks_up = |probe: &SystemProbe| match ramp_position {
            RampPosition::Diffuse(x) => probe.lights.iter().any(|light| is_near(light.coordinate, x)),
            RampPosition::SoftScatter(x) => is_near(probe.amount, x),
            RampPosition::Coverage(x) => is_near(probe.coverage_coordinate, x),
            RampPosition::TwoAxes(ramp, position) => ramp.lookups(probe).any(|(_, at)| is_near_2d(at, position)),
        };
        self.probes_of_system(system).filter(|(_, probe)| looks_up(probe)).map(|(pixel, _)| *pixel).collect()
    }
}

fn bin(coordinate: f32, bins: usize) -> usize {
    ((coordinate * bins as f32) as usize).min(bins - 1)
}

fn largest<'a>(bins: impl IntoIterator<Item = &'a f32>) -> f32 {
    bins.into_iter().fold(0.0, |a, b| a.max(*b))
}

fn scale(bins: &mut [f32], most: f32) {
    if most > 0.0 {
        bins.iter_mut().for_each(|bin| *bin /= most);
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec3, Vec4};
    use haze_reference::{FireProbe, GlowProbe, ShadowProbe};

    use super::*;

    /// Light with a shadow and a glow at these coordinates.
    fn light(light: usize, shadow: Vec2, glow: Option<Vec2>) -> LightProbe {
        LightProbe {
            light,
            cosine: 0.0,
            coordinate: 0.5,
            attenuation: 1.0,
            backlight: 0.0,
            diffuse: Vec3::ZERO,
            shadow: Some(ShadowProbe { coordinate: shadow, transmittance: Vec3::ONE }),
            glow: glow.map(|coordinate| GlowProbe { coordinate, specular: Vec3::ZERO }),
        }
    }

    fn smoke(coverage: f32, fire: Option<Vec2>, lights: Vec<LightProbe>) -> SystemProbe {
        SystemProbe {
            system: 0,
            amount: coverage,
            coverage_coordinate: coverage,
            coverage,
            normal: Vec3::Z,
            six_way: None,
            lights,
            ambient: None,
            diffuse: Vec3::ZERO,
            soft_scatter_weight: None,
            soft_scatter: Vec3::ZERO,
            fire: fire.map(|coordinate| FireProbe { coordinate, fraction: 1.0, light: Vec3::ZERO }),
            blended: Vec4::ZERO,
        }
    }

    /// Two pixels of smoke of unequal coverage, under lights 1 and 4, and a pixel of another system.
    fn survey() -> RampSurvey {
        let left = Vec2::new(0.1, 0.3);
        let right = Vec2::new(0.9, 0.6);
        let lights = vec![light(4, left, None), light(1, right, Some(Vec2::new(0.2, 0.7)))];
        let samples = vec![
            (UVec2::new(1, 0), smoke(0.25, None, vec![light(4, left, None)])),
            (UVec2::new(2, 0), smoke(0.5, Some(Vec2::new(0.4, 0.8)), lights)),
            (UVec2::new(3, 0), SystemProbe { system: 1, ..smoke(1.0, Some(left), vec![light(0, right, Some(right))]) }),
        ];
        RampSurvey { size: UVec2::new(4, 1), step: 1, samples }
    }

    /// Bins that are not empty, with their values.
    fn filled(bins: &[f32]) -> Vec<(usize, f32)> {
        bins.iter().copied().enumerate().filter(|(_, count)| *count > 0.0).collect()
    }

    #[test]
    fn a_histogram_of_two_axes_counts_each_lookup_by_its_coverage() {
        let of = |ramp| filled(&survey().over_both_axes(ramp, 0));
        let at = |x: f32, y: f32| (y * SIDE as f32) as usize * SIDE + (x * SIDE as f32) as usize;
        assert_eq!(of(TwoAxisRamp::Shadow), [(at(0.1, 0.3), 1.0), (at(0.9, 0.6), 0.5 / 0.75)]);
        assert_eq!(of(TwoAxisRamp::Specular), [(at(0.2, 0.7), 1.0)]);
        assert_eq!(of(TwoAxisRamp::Fire), [(at(0.4, 0.8), 1.0)]);
    }

    #[test]
    fn a_histogram_along_an_axis_has_bins_for_each_light() {
        let of = |axis, ramp| {
            let histograms = survey().along(axis, ramp, 0);
            histograms.into_iter().map(|of| (of.light, filled(&of.bins))).collect::<Vec<_>>()
        };
        let at = |coordinate: f32| (coordinate * BINS as f32) as usize;
        let rare = 0.5 / 0.75;
        assert_eq!(of(0, TwoAxisRamp::Shadow), [(Some(1), vec![(at(0.9), rare)]), (Some(4), vec![(at(0.1), 1.0)])]);
        assert_eq!(of(1, TwoAxisRamp::Shadow), [(Some(1), vec![(at(0.6), rare)]), (Some(4), vec![(at(0.3), 1.0)])]);
        assert_eq!(of(1, TwoAxisRamp::Specular), [(Some(1), vec![(at(0.7), 1.0)])]);
        assert_eq!(of(0, TwoAxisRamp::Fire), [(None, vec![(at(0.4), 1.0)])]);
    }

    #[test]
    fn smoke_is_found_by_its_place_on_a_ramp_with_two_axes() {
        let found = |ramp, x, y| {
            let pixels = survey().at(0, RampPosition::TwoAxes(ramp, Vec2::new(x, y)));
            pixels.into_iter().map(|pixel| pixel.x).collect::<Vec<_>>()
        };
        assert_eq!(found(TwoAxisRamp::Shadow, 0.11, 0.29), [1, 2]);
        assert_eq!(found(TwoAxisRamp::Shadow, 0.9, 0.6), [2]);
        assert_eq!(found(TwoAxisRamp::Fire, 0.4, 0.8), [2]);
        // One coordinate of another lookup, or of another ramp.
        for (ramp, x, y) in
            [(TwoAxisRamp::Shadow, 0.1, 0.6), (TwoAxisRamp::Shadow, 0.3, 0.1), (TwoAxisRamp::Specular, 0.9, 0.6)]
        {
            assert_eq!(found(ramp, x, y), [0; 0], "{ramp:?} {x} {y}");
        }
    }
}
