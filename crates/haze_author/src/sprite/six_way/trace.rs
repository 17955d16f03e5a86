//! Path-traces a puff under light from all sides and fits six images to the result.

use glam::Vec3;
use haze_core::assets::image::Image;
use haze_core::formula::color::luminance;
use haze_core::formula::six_way::{SixWay, six_way_axis_weights};

use crate::deterministic_math::cos_sin;
use crate::path_trace::{DensityVolume, Medium, PathTrace, PathTraceResult};

/// Six-way light of a puff of a medium.
#[derive(Clone, Debug)]
pub struct TracedSixWay {
    /// Luminance at full coverage, relative to white paper that faces the light.
    pub light: Image<SixWay>,
    /// Coverage: the fraction of the background that is hidden.
    pub coverage: Image<f32>,
    /// Mix and color of the six images.
    pub mix: SixWayMix,
}

/// Fitted parameters that represent light from any direction by six images.
#[derive(Clone, Debug)]
pub struct SixWayMix {
    /// Color of the light, normalised to luminance 1: `diffuse.six_way_color` up to a factor.
    pub color: Vec3,
    /// `diffuse.six_way_anisotropy`.
    pub anisotropy: f32,
    /// Weight of each traced light for each side: right, top, front, left, bottom, back.
    sides: [Vec<f64>; 6],
}

impl TracedSixWay {
    /// Path-traces a volume of a medium under light from all sides. Fits the six images for which
    /// [`six_way_response`](haze_core::formula::six_way::six_way_response) is closest to the result. `mix` is the mix of
    /// another frame of the same sprite, if both must share it. `progress` as in [`PathTrace::run`].
    pub fn trace<E>(
        volume: &DensityVolume,
        medium: &Medium,
        path_trace: &PathTrace,
        mix: Option<&SixWayMix>,
        progress: impl Fn(u32) -> Result<(), E>,
    ) -> Result<Self, E> {
        let lights = lights();
        let traced = path_trace.run(volume, medium, &lights, progress)?;
        let mix = mix.cloned().unwrap_or_else(|| SixWayMix::new(&lights, &traced));
        let mut light = Image::new(traced.coverage.size, SixWay::default());
        light.for_each(|at, texel| {
            let index = (at.y * traced.coverage.size.x + at.x) as usize;
            let coverage = traced.coverage.texels[index].max(1.0e-3);
            let seen = |light: usize| f64::from(luminance(traced.light[light].texels[index]) / coverage);
            let side = |fractions: &Vec<f64>| {
                fractions.iter().enumerate().map(|(light, fraction)| fraction * seen(light)).sum::<f64>()
            };
            let [px, py, pz, nx, ny, nz] = mix.sides.each_ref().map(|fractions| side(fractions).max(0.0) as f32);
            *texel = SixWay { positive: Vec3::new(px, py, pz), negative: Vec3::new(nx, ny, nz) };
        });
        Ok(Self { light, coverage: traced.coverage, mix })
    }
}

impl SixWayMix {
    fn new(lights: &[Vec3], traced: &PathTraceResult) -> Self {
        let means: Vec<_> = (0..lights.len()).map(|light| traced.mean(light)).collect();
        let brightness: Vec<f64> = means.iter().map(|&mean| luminance(mean).max(1.0e-9).into()).collect();
        let plain = SixWayFit::new(lights, &brightness, 0.0);
        let fits = ANISOTROPIES.iter().map(|&anisotropy| SixWayFit::new(lights, &brightness, anisotropy));
        let SixWayFit { anisotropy, sides, .. } =
            fits.fold(plain, |best, fit| if fit.error < best.error { fit } else { best });
        // Every light has the same weight, regardless of brightness.
        let color: Vec3 = means.iter().zip(&brightness).map(|(&mean, &brightness)| mean / brightness as f32).sum();
        Self { color: color / luminance(color).max(f32::MIN_POSITIVE), anisotropy, sides }
    }
}

/// Returns directions to the faces, edges and corners of a cube, and to a ring around the back, where the response of
/// forward-scattering smoke changes most.
fn lights() -> Vec<Vec3> {
    let step = |index: i32| index as f32 - 1.0;
    let cube = (0..27).map(|index| Vec3::new(step(index % 3), step(index / 3 % 3), step(index / 9)));
    let ring = (0..8).map(|index| {
        let way = cos_sin(index as f32 * std::f32::consts::TAU / 8.0);
        Vec3::new(way.x * RING, way.y * RING, -1.0)
    });
    let ways = cube.filter(|way| *way != Vec3::ZERO).chain(ring);
    ways.map(|way| way / way.length_squared().sqrt()).collect()
}

/// Tangent of the angle between the ring and the back: 22.5 degrees.
const RING: f32 = 0.414_213_57;
/// Candidate values of `diffuse.six_way_anisotropy`.
const ANISOTROPIES: [f32; 19] =
    [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95];

/// Fit of the six images to those of all lights, for one anisotropy.
struct SixWayFit {
    anisotropy: f32,
    /// Weight of each light for each side: right, top, front, left, bottom, back.
    sides: [Vec<f64>; 6],
    /// Sum of squared relative errors of the lights' brightness.
    error: f64,
}

impl SixWayFit {
    /// Fits by least squares. Each light is weighted by its inverse brightness, so relative errors of dark and bright
    /// sides count alike.
    fn new(lights: &[Vec3], brightness: &[f64], anisotropy: f32) -> Self {
        let terms = |way: &Vec3| {
            let mut terms = [0.0; 6];
            for (axis, fraction) in six_way_axis_weights(*way, anisotropy).to_array().into_iter().enumerate() {
                terms[axis + 3 * usize::from(way[axis] <= 0.0)] = f64::from(fraction);
            }
            terms
        };
        let mut rows = [[0.0; 6]; 6];
        let mut right: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; lights.len()]);
        for (light, (way, brightness)) in lights.iter().zip(brightness).enumerate() {
            let terms = terms(way);
            let weight = 1.0 / (brightness * brightness);
            for i in 0..6 {
                (0..6).for_each(|j| rows[i][j] += terms[i] * terms[j] * weight);
                right[i][light] = terms[i] * weight;
            }
        }
        let sides = solve(rows, right);
        let of_sides = sides.each_ref().map(|side| side.iter().zip(brightness).map(|(a, b)| a * b).sum::<f64>());
        let error = |(way, brightness): (&Vec3, &f64)| {
            let shown: f64 = terms(way).iter().zip(of_sides).map(|(fraction, side)| fraction * side.max(0.0)).sum();
            (shown / brightness - 1.0).powi(2)
        };
        let error = lights.iter().zip(brightness).map(error).sum();
        Self { anisotropy, sides, error }
    }
}

/// Solves by Gauss-Jordan elimination. The matrix is positive definite because each side has a light exactly from its
/// direction.
fn solve(mut rows: [[f64; 6]; 6], mut right: [Vec<f64>; 6]) -> [Vec<f64>; 6] {
    for i in 0..6 {
        let scale = 1.0 / rows[i][i];
        rows[i].iter_mut().chain(&mut right[i]).for_each(|value| *value *= scale);
        let row = rows[i];
        let known = right[i].clone();
        for j in (0..6).filter(|&j| j != i) {
            let factor = rows[j][i];
            rows[j].iter_mut().zip(row).for_each(|(value, of_row)| *value -= factor * of_row);
            right[j].iter_mut().zip(&known).for_each(|(value, of_row)| *value -= factor * of_row);
        }
    }
    right
}
