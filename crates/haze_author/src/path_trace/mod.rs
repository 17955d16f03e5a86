//! Path tracer for a density volume. Its result is the ground truth that ramps and six-way maps are fitted to and
//! compared with. An authoring tool, not used at run time.
//!
//! The view is orthographic from the front, as for a sprite. All lights share each path: at every vertex the path
//! gathers direct light of all lights. (Woodcock et al., "Techniques used in the GEM code", 1965: delta tracking;
//! Henyey and Greenstein, "Diffuse radiation in the galaxy", 1941)

mod density_volume;
mod medium;
mod path;
mod phase;
mod random;
mod shadows;

pub use density_volume::DensityVolume;
pub(crate) use density_volume::voxel_center;
pub use medium::{MEDIA, Medium, NamedMedium};

use glam::{UVec2, Vec3};

use haze_core::assets::image::Image;
use path::{Pixel, Tracer};

/// Parameters of a path trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathTrace {
    /// Side of the image, pixels.
    pub size: u32,
    /// Paths per pixel. Noise decreases with the square root.
    pub samples: u32,
    /// Different seeds give different noise.
    pub seed: u32,
}

/// Result of [`PathTrace::run`].
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PathTraceResult {
    /// Coverage: the fraction of the background that is hidden, 0 to 1.
    pub coverage: Image<f32>,
    /// Light towards the viewer, one image per light: linear RGB times coverage. 1 is the brightness of white paper
    /// that faces the light.
    pub light: Vec<Image<Vec3>>,
}

impl PathTraceResult {
    /// Returns the mean of a light's image.
    pub fn mean(&self, light: usize) -> Vec3 {
        let texels = &self.light[light].texels;
        texels.iter().sum::<Vec3>() / texels.len() as f32
    }
}

impl PathTrace {
    /// Traces a volume of a medium under parallel light *from* each direction of `lights` (x right, y up, z towards the
    /// viewer). `progress` is called with the number of finished paths per pixel; an error from it cancels the trace.
    /// The result does not depend on the number of processors.
    ///
    /// # Errors
    /// The error of `progress`.
    pub fn run<E>(
        &self,
        volume: &DensityVolume,
        medium: &Medium,
        lights: &[Vec3],
        progress: impl Fn(u32) -> Result<(), E>,
    ) -> Result<PathTraceResult, E> {
        let tracer = Tracer::new(volume, medium, lights);
        let count = lights.len();
        // Each pixel has `count + 1` adjacent texels: one per light, then the coverage in x.
        let mut sums = Image::new(UVec2::new(self.size * (count as u32 + 1), self.size), Vec3::ZERO);
        for sample in 0..self.samples {
            progress(sample)?;
            sums.for_bands(|first, band| {
                let mut scratch = tracer.scratch();
                for (index, sums) in (0..).zip(band.chunks_mut(count + 1)) {
                    let at = UVec2::new(index % self.size, first + index / self.size);
                    let pixel = Pixel { at, size: self.size, seed: self.seed };
                    let (lights, coverage) = sums.split_at_mut(count);
                    coverage[0].x += tracer.add_path(&pixel, sample, self.samples, &mut scratch, lights);
                }
            });
        }
        let fraction = 1.0 / self.samples.max(1) as f32;
        let of = |index: usize, scale: f32| {
            let texels = sums.texels.iter().skip(index).step_by(count + 1).map(|&sum| sum * scale);
            Image { size: UVec2::splat(self.size), texels: texels.collect() }
        };
        let coverage = of(count, fraction);
        let coverage = Image { size: coverage.size, texels: coverage.texels.iter().map(|sum: &Vec3| sum.x).collect() };
        let light = (0..count).map(|light| of(light, std::f32::consts::PI * fraction)).collect();
        Ok(PathTraceResult { light, coverage })
    }
}

#[cfg(test)]
mod tests;
