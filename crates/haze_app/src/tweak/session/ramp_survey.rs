//! Ramp coordinates that an image samples, at a limited number of pixels.

use glam::{UVec2, Vec2};
use haze::Error;
use haze_demo::capture::ProbeInputs;
use haze_reference::SystemProbe;

/// Largest number of pixels that are sampled.
const MAX_SAMPLED_PIXELS: u32 = 10_000;

/// Number of bins of a histogram; `SIDE` is that along each side of the specular ramp's.
pub const BINS: usize = 64;
pub const SIDE: usize = 32;

/// Distance within which a sample counts as at a place on a ramp.
pub const NEAR: f32 = 0.02;

/// Place on a ramp of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RampPlace {
    /// Coordinate from the cosine N·L between normal and light.
    Diffuse(f32),
    /// Accumulated amount.
    SoftScatter(f32),
    /// Squared distance, and amount.
    Specular(Vec2),
    /// Amount times boost.
    Coverage(f32),
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
    pub light: usize,
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
        let mut histograms: Vec<Histogram> = Vec::new();
        for (_, probe) in self.probes_of_system(system) {
            for light in &probe.lights {
                let at = histograms.iter().position(|histogram| histogram.light == light.light).unwrap_or_else(|| {
                    histograms.push(Histogram { light: light.light, bins: vec![0.0; BINS] });
                    histograms.len() - 1
                });
                histograms[at].bins[bin(light.coordinate, BINS)] += probe.coverage;
            }
        }
        histograms.sort_by_key(|histogram| histogram.light);
        let most = histograms.iter().flat_map(|histogram| &histogram.bins).fold(0.0, |a: f32, b| a.max(*b));
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
        let most = bins.iter().fold(0.0, |a: f32, b| a.max(*b));
        scale(&mut bins, most);
        bins
    }

    /// Returns the histogram of the specular ramp, by rows of rising amount.
    pub fn by_glow(&self, system: usize) -> Vec<f32> {
        let mut bins = vec![0.0; SIDE * SIDE];
        for (_, probe) in self.probes_of_system(system) {
            for glow in probe.lights.iter().filter_map(|light| light.glow) {
                bins[bin(glow.coordinate.y, SIDE) * SIDE + bin(glow.coordinate.x, SIDE)] += probe.coverage;
            }
        }
        let most = bins.iter().fold(0.0, |a: f32, b| a.max(*b));
        scale(&mut bins, most);
        bins
    }

    /// Returns the sampled pixels whose smoke samples a place on a ramp.
    pub fn at(&self, system: usize, ramp_place: RampPlace) -> Vec<UVec2> {
        let is_near = |a: f32, b: f32| (a - b).abs() <= NEAR;
        let looks_up = |probe: &SystemProbe| match ramp_place {
            RampPlace::Diffuse(x) => probe.lights.iter().any(|light| is_near(light.coordinate, x)),
            RampPlace::SoftScatter(x) => is_near(probe.amount, x),
            RampPlace::Coverage(x) => is_near(probe.coverage_coordinate, x),
            RampPlace::Specular(at) => probe
                .lights
                .iter()
                .filter_map(|light| light.glow)
                .any(|glow| is_near(glow.coordinate.x, at.x) && is_near(glow.coordinate.y, at.y)),
        };
        self.probes_of_system(system).filter(|(_, probe)| looks_up(probe)).map(|(pixel, _)| *pixel).collect()
    }
}

/// Returns histograms of the specular ramp along each axis, summed over the other: by squared distance, and by amount.
pub fn along(glow: &[f32]) -> [Vec<f32>; 2] {
    let mut sums = [vec![0.0; SIDE], vec![0.0; SIDE]];
    for (index, count) in glow.iter().enumerate() {
        sums[0][index % SIDE] += count;
        sums[1][index / SIDE % SIDE] += count;
    }
    for bins in &mut sums {
        let most = bins.iter().fold(0.0, |a: f32, b| a.max(*b));
        scale(bins, most);
    }
    sums
}

fn bin(coordinate: f32, bins: usize) -> usize {
    ((coordinate * bins as f32) as usize).min(bins - 1)
}

fn scale(bins: &mut [f32], most: f32) {
    if most > 0.0 {
        bins.iter_mut().for_each(|bin| *bin /= most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_along_one_axis_sums_over_the_other() {
        let mut glow = vec![0.0; SIDE * SIDE];
        // Column 3 (squared distance) at the amounts 1 and 5, and column 8 at 5.
        for (x, y, count) in [(3, 1, 0.5), (3, 5, 0.25), (8, 5, 1.0)] {
            glow[y * SIDE + x] = count;
        }
        let at = |bins: &[f32], places: [usize; 2]| places.map(|place| bins[place]);
        let [across, up] = along(&glow);
        assert_eq!((at(&across, [3, 8]), at(&up, [1, 5])), ([0.75, 1.0], [0.4, 1.0]));
        assert_eq!((across.iter().filter(|bin| **bin > 0.0).count(), up.len()), (2, SIDE));
        assert_eq!(along(&[]), [vec![0.0; SIDE], vec![0.0; SIDE]]);
    }
}
