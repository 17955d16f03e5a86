//! Light paths, traced from the viewer.

use glam::{UVec2, UVec3, Vec2, Vec3};

use super::density_volume::{DensityVolume, exit_distance};
use super::medium::Medium;
use super::phase::{phase_function, sample_scattered_direction};
use super::random::Random;
use super::shadows::ShadowVolume;
use crate::deterministic_math::{exp, fast_exp_neg, ln};

/// Maximum number of vertices. The light that remains on a path of this length is negligible.
const MAX_VERTICES: u32 = 1024;
/// Russian roulette starts at this vertex: paths with little light end randomly, and the weight of the others is
/// increased.
const ROULETTE_START: u32 = 4;

pub(super) struct Tracer<'a> {
    volume: &'a DensityVolume,
    medium: &'a Medium,
    lights: &'a [Vec3],
    shadows: ShadowVolume,
    /// Maximum extinction in the volume, for delta tracking.
    majorant: f32,
}

/// Buffers that are reused from path to path.
pub(super) struct Scratch {
    /// Optical depth from the front of a column to the end of each step.
    column: Vec<f32>,
    /// Integrated density from a vertex towards each light.
    towards: Vec<f32>,
}

/// The pixel at which paths begin.
pub(super) struct Pixel {
    pub at: UVec2,
    /// Side of the image, pixels.
    pub size: u32,
    pub seed: u32,
}

impl<'a> Tracer<'a> {
    pub fn new(volume: &'a DensityVolume, medium: &'a Medium, lights: &'a [Vec3]) -> Self {
        let shadows = ShadowVolume::new(volume, lights);
        Self { volume, medium, lights, shadows, majorant: volume.max_density() * medium.density }
    }

    pub fn scratch(&self) -> Scratch {
        let steps = 2 * self.volume.size.max_element() as usize;
        Scratch { column: vec![0.0; steps], towards: vec![0.0; self.lights.len()] }
    }

    /// Traces one path from a random position in a pixel and adds its light to `sums`, one entry per light. The first
    /// vertex is sampled inside the smoke, and the light is weighted by the coverage there, which is returned. Its depth is
    /// in the stratum `index` of `count`.
    pub fn add_path(&self, pixel: &Pixel, index: u32, count: u32, scratch: &mut Scratch, sums: &mut [Vec3]) -> f32 {
        let Scratch { column, towards } = scratch;
        let key = UVec3::new(pixel.at.x, pixel.at.y, pixel.seed.wrapping_mul(0x9e37_79b9).wrapping_add(index));
        let mut random = Random::new(key);
        let position = pixel.at.as_vec2() + Vec2::new(random.unit(), random.unit());
        let front = (position * (2.0 / pixel.size as f32) - 1.0) * Vec2::new(1.0, -1.0);
        let total_depth = self.integrate_column(front, column);
        if total_depth <= 0.0 {
            return 0.0;
        }
        let coverage = 1.0 - exp(-total_depth);
        let quantile = (index as f32 + random.unit()) / count as f32;
        let mut p = front.extend(z_at_optical_depth(column, -ln((1.0 - quantile * coverage).max(f32::MIN_POSITIVE))));
        let mut direction = Vec3::NEG_Z;
        let mut light = self.medium.albedo * coverage;
        for vertex in 1..MAX_VERTICES {
            self.shadows.at(p, towards);
            for ((sum, &to_light), depth) in sums.iter_mut().zip(self.lights).zip(&*towards) {
                let phase = phase_function(direction.dot(to_light), self.medium.anisotropy);
                *sum += light * (phase * fast_exp_neg(depth * self.medium.density));
            }
            if vertex >= ROULETTE_START {
                let stays = (light.max_element() / coverage).min(1.0);
                if random.unit() >= stays {
                    break;
                }
                light /= stays;
            }
            direction = sample_scattered_direction(direction, self.medium.anisotropy, &mut random);
            let Some(next) = self.sample_next_vertex(p, direction, &mut random) else { break };
            p = next;
            light *= self.medium.albedo;
        }
        coverage
    }

    /// Fills `column` with the optical depth from the front to the end of each of its equal steps. Returns the total.
    fn integrate_column(&self, front: Vec2, column: &mut [f32]) -> f32 {
        let step = 2.0 / column.len() as f32;
        let mut sum = 0.0;
        for (index, depth) in column.iter_mut().enumerate() {
            let position = front.extend(1.0 - (index as f32 + 0.5) * step);
            sum += self.volume.density(position) * self.medium.density * step;
            *depth = sum;
        }
        sum
    }

    /// Samples the next scattering position by delta tracking; `None` if the ray leaves the volume. (Woodcock et al.,
    /// 1965)
    fn sample_next_vertex(&self, p: Vec3, direction: Vec3, random: &mut Random) -> Option<Vec3> {
        let most = exit_distance(p, direction);
        let mut distance = 0.0;
        loop {
            distance -= ln(1.0 - random.unit()) / self.majorant;
            if distance >= most {
                return None;
            }
            let position = p + direction * distance;
            if random.unit() * self.majorant < self.volume.density(position) * self.medium.density {
                return Some(position);
            }
        }
    }
}

/// Returns the z in a column at which the optical depth from the front equals `depth`.
fn z_at_optical_depth(column: &[f32], depth: f32) -> f32 {
    let step = column.partition_point(|&end| end < depth).min(column.len() - 1);
    let before = if step == 0 { 0.0 } else { column[step - 1] };
    let within = (depth - before) / (column[step] - before).max(f32::MIN_POSITIVE);
    1.0 - (step as f32 + within.clamp(0.0, 1.0)) * (2.0 / column.len() as f32)
}
