//! Images of a number that particles have, such as their depth: the mean over the smoke at each pixel.
//!
//! The number takes the place of the particles' tints, and even light that of all lights. The renderer then weights it as it
//! weights the colors of particles. Sixteen bits of it are in red and green; blue is the smoke's opacity, by which both are
//! divided.

use glam::{Vec2, Vec3, Vec4};
use haze_core::assets::image::Image;
use haze_core::frame::{Particle, View};

/// Number that a particle has in a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParticleScalar {
    /// Linear view depth, metres.
    ViewDepth,
    /// Way to the right on the screen in so many seconds, pixels.
    MotionRight(f32),
    /// Way up on the screen in so many seconds, pixels.
    MotionUp(f32),
}

impl ParticleScalar {
    /// Time between the two images of a motion, seconds.
    pub(super) fn seconds(self) -> f32 {
        match self {
            Self::ViewDepth => 0.0,
            Self::MotionRight(seconds) | Self::MotionUp(seconds) => seconds,
        }
    }

    /// `displacement`: of the particle in that time, metres.
    pub(super) fn of(self, particle: &Particle, displacement: Vec3, view: &View) -> f32 {
        let depth = |position: Vec3| -view.view_from_world.transform_point3(position).z;
        let pixel = |position: Vec3| {
            let clip = view.clip_from_view * view.view_from_world * position.extend(1.0);
            Vec2::new(clip.x, clip.y) / clip.w.max(1.0e-3) * 0.5 * view.size.as_vec2()
        };
        let way = || pixel(particle.position + displacement) - pixel(particle.position);
        match self {
            Self::ViewDepth => depth(particle.position),
            Self::MotionRight(_) => way().x,
            Self::MotionUp(_) => way().y,
        }
    }
}

/// A scalar, and the range of its values in a shot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownScalar {
    pub(super) scalar: ParticleScalar,
    pub(super) low: f32,
    pub(super) high: f32,
}

impl ShownScalar {
    /// Replaces the tints of particles.
    pub(super) fn apply(&self, particles: &mut [Particle], displacements: &[Vec3], view: &View) {
        for (particle, displacement) in particles.iter_mut().zip(displacements) {
            let fraction = (self.scalar.of(particle, *displacement, view) - self.low) / (self.high - self.low);
            // NaN becomes 0.
            let code = (fraction.clamp(0.0, 1.0) * 65535.0).round() as u16;
            let [high, low] = code.to_be_bytes();
            particle.tint = [high, low, 255];
        }
    }

    fn decode(&self, texel: Vec4) -> f32 {
        let code = (texel.x * 256.0 + texel.y) * 255.0 / texel.z;
        self.low + (self.high - self.low) * (code / 65535.0).clamp(0.0, 1.0)
    }

    /// Reads the mean of the scalar at each pixel from an image of a shot that shows it; `None` where no smoke is.
    pub fn values(&self, image: &Image<Vec4>) -> Image<Option<f32>> {
        // Opacities below that are invisible, and half floats hold too few of their bits.
        let value = |texel: &Vec4| (texel.z > 1.0e-3).then(|| self.decode(*texel));
        Image { size: image.size, texels: image.texels.iter().map(value).collect() }
    }
}
