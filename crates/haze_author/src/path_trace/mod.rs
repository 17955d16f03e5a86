//! Light in smoke as it is: a small path tracer through a volume of densities, the measure that ramps are held against and
//! fitted to. An authoring tool, never a part of a frame.
//!
//! A volume is seen from the front, without perspective, as a sprite is. Every path is shared by all lights: at each of its
//! vertices all of them shine on it. (Woodcock et al., "Techniques used in the GEM code", 1965: delta tracking; Henyey and
//! Greenstein, "Diffuse radiation in the galaxy", 1941)

mod medium;
mod path;
mod phase;
mod random;
mod shadows;
mod volume;

pub use medium::{MEDIA, Medium, NamedMedium};
pub use volume::Volume;
pub(crate) use volume::position;

use glam::{UVec2, Vec3};

use haze::picture::Picture;
use path::{Pixel, Tracer};

/// How a volume is path-traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTrace {
    /// Pixels along a side of the picture.
    pub size: u32,
    /// Paths for each pixel. Noise falls with their square root.
    pub samples: u32,
    /// Different seeds give different noise.
    pub seed: u32,
}

/// What [`PathTrace::run`] finds.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// The share of what is behind that is hidden.
    pub coverage: Picture<f32>,
    /// Light that comes out to the viewer, for each light: linear, times coverage. 1 is what white paper shows that faces the light.
    pub light: Vec<Picture<Vec3>>,
}

impl Traced {
    /// Mean of the picture under a light.
    pub fn mean(&self, light: usize) -> Vec3 {
        let texels = &self.light[light].texels;
        texels.iter().sum::<Vec3>() / texels.len() as f32
    }
}

impl PathTrace {
    /// Traces a volume of a medium, with parallel light *from* each of `lights` (x right, y up, z to the viewer). `progress` is told
    /// how many paths of each pixel are done; its error ends the work. The same on any number of processors.
    pub fn run<E>(
        &self,
        volume: &Volume,
        medium: &Medium,
        lights: &[Vec3],
        progress: impl Fn(u32) -> Result<(), E>,
    ) -> Result<Traced, E> {
        let tracer = Tracer::new(volume, medium, lights);
        let count = lights.len();
        // Of each pixel, beside each other: the lights, then the coverage.
        let mut sums = Picture::new(UVec2::new(self.size * (count as u32 + 1), self.size), Vec3::ZERO);
        for sample in 0..self.samples {
            progress(sample)?;
            sums.for_bands(|first, band| {
                let mut scratch = tracer.scratch();
                for (index, sums) in (0..).zip(band.chunks_mut(count + 1)) {
                    let at = UVec2::new(index % self.size, first + index / self.size);
                    let pixel = Pixel { at, size: self.size, seed: self.seed };
                    let (lights, coverage) = sums.split_at_mut(count);
                    coverage[0].x += tracer.add_path(&pixel, (sample, self.samples), &mut scratch, lights);
                }
            });
        }
        let share = 1.0 / self.samples.max(1) as f32;
        let of = |index: usize, scale: f32| {
            let texels = sums.texels.iter().skip(index).step_by(count + 1).map(|&sum| sum * scale);
            Picture { size: UVec2::splat(self.size), texels: texels.collect() }
        };
        let coverage = of(count, share);
        let coverage =
            Picture { size: coverage.size, texels: coverage.texels.iter().map(|sum: &Vec3| sum.x).collect() };
        let light = (0..count).map(|light| of(light, std::f32::consts::PI * share)).collect();
        Ok(Traced { light, coverage })
    }
}

#[cfg(test)]
mod tests;
