//! Optical depth of the smoke in front of a view depth, averaged over the smoke's screen area, for the order
//! `weighted`.

use glam::{DVec2, Vec3Swizzles, Vec4};

use super::particle_space::ParticleSpace;
use super::smoke_extent::SmokeExtent;
use super::view_geometry::ViewGeometry;
use crate::formula::order::{OPTICAL_DEPTH_KNOTS, knot_coordinate};
use crate::frame::Particle;
use crate::settings::{Settings, Technique};

/// Mean optical depth of a sprite over its square, relative to its center: sprites thin out towards their borders.
const MEAN_TO_CENTER_RATIO: f32 = 0.375;

/// Number of particles from which a fraction stands for all: sums over so many vary by less than a hundredth.
const ENOUGH: usize = 16_384;

/// Assumed optical depth from the near to the far side of a system whose sprites are on the GPU.
const ASSUMED_OPTICAL_DEPTH: f32 = 4.0;

/// Computes the optical depth in front of each knot of `optical_depth_in_front`. `particles_per_sample`: number of
/// sprites that each particle represents.
pub(super) fn optical_depths(
    view: &ViewGeometry,
    space: &ParticleSpace,
    particles: &[Particle],
    particles_per_sample: u32,
    settings: &Settings,
    extent: &SmokeExtent,
) -> [Vec4; 4] {
    let mut knots = [0.0_f32; OPTICAL_DEPTH_KNOTS];
    // Distributes optical depth times area of every sprite to the two nearest knots, and sums the first two moments of
    // the view-space positions.
    let mut total = 0.0_f64;
    let mut sum = DVec2::ZERO;
    let mut squares = DVec2::ZERO;
    let step = particles.len().div_ceil(ENOUGH).max(1);
    let particles_per_sample = particles_per_sample as f32 * step as f32;
    for particle in particles.iter().step_by(step).filter(|particle| particle.is_visible()) {
        let position = space.view_from_particles.transform_point3a(particle.position.into());
        let (optical_depth, radius) = center_optical_depth_and_radius(particle, settings);
        let in_front = ((-position.z - view.depth.near) / radius).clamp(0.0, 1.0);
        let area = 4.0 * radius * radius;
        let fraction = MEAN_TO_CENTER_RATIO * optical_depth * area * in_front;
        let knot = knot_coordinate(-position.z, extent.near, extent.far) * (OPTICAL_DEPTH_KNOTS - 1) as f32;
        let low = (knot as usize).min(OPTICAL_DEPTH_KNOTS - 2);
        knots[low] += fraction * (1.0 - (knot - low as f32));
        knots[low + 1] += fraction * (knot - low as f32);

        let across = position.xy().as_dvec2();
        let fraction = f64::from(fraction);
        total += fraction;
        sum += across * fraction;
        squares += (across * across + f64::from(radius * radius) / 3.0) * fraction;
    }
    // NaN comes from sprites of size 0.
    if total.is_nan() || total <= 0.0 {
        let of_knot = |knot: usize| {
            (knot as f32 / (OPTICAL_DEPTH_KNOTS - 1) as f32 * 2.0 - 0.5).clamp(0.0, 1.0) * ASSUMED_OPTICAL_DEPTH
        };
        return pack(std::array::from_fn(of_knot));
    }
    // Approximates the smoke's outline by a rectangle: the variance along a side is its squared length divided by 12.
    let variance = (squares / total - (sum / total).powf(2.0)).max(DVec2::splat(1.0e-12));
    let area = 12.0 * (variance.x * variance.y).sqrt() as f32 / particles_per_sample;
    let mut in_front = 0.0;
    pack(knots.map(|knot| {
        // Half of a knot's own optical depth lies in front of the knot.
        let at_knot = in_front + 0.5 * knot / area;
        in_front += knot / area;
        at_knot
    }))
}

/// Returns the mean optical depth of a sprite over its square.
pub fn optical_depth(particle: &Particle, settings: &Settings) -> f32 {
    MEAN_TO_CENTER_RATIO * center_optical_depth_and_radius(particle, settings).0
}

/// Returns the optical depth through a sprite's center, and its radius in metres.
fn center_optical_depth_and_radius(particle: &Particle, settings: &Settings) -> (f32, f32) {
    let amount = particle.shown_amount() * settings.accumulate.opacity;
    let radius = particle.radius * settings.sprite.size;
    match settings.technique {
        Technique::SphericalBillboard => {
            let radius = radius * settings.spherical_billboard.radius;
            (2.0 * radius * settings.spherical_billboard.density * amount, radius)
        }
        Technique::Density => (2.0 * radius * settings.exponential.density * amount, radius),
        // Half of the noise volume is empty.
        Technique::VolumetricHard | Technique::VolumetricSoft => {
            (radius * settings.volumetric.opacity * amount, radius)
        }
        _ => (-(1.0 - amount.min(0.999)).ln(), radius),
    }
}

fn pack(knots: [f32; OPTICAL_DEPTH_KNOTS]) -> [Vec4; 4] {
    bytemuck::cast(knots)
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::proj::directx::perspective;
    use glam::{Mat4, UVec2, vec3};

    use super::*;
    use crate::formula::order::optical_depth_in_front;
    use crate::frame::View;

    /// Returns the optical depth in front of each of `depths`, for walls of sprites at 8 and 12 m, each sprite drawn
    /// `copies` times.
    fn in_front_of(amounts: [f32; 2], depths: [f32; 4], copies: usize) -> [f32; 4] {
        let view = View::new(Mat4::IDENTITY, perspective(0.8, 1.0, 0.1, 80.0), UVec2::splat(64));
        let view = ViewGeometry::new(&view).unwrap();
        let sprite = |depth: f32, amount, i: u32| Particle {
            position: vec3((i % 16) as f32 * 0.25 - 2.0, (i / 16) as f32 * 0.25 - 2.0, -depth),
            radius: 0.25,
            amount,
            ..Particle::default()
        };
        let wall = |(depth, amount)| (0..256).map(move |i| sprite(depth, amount, i));
        let walls = [8.0, 12.0].into_iter().zip(amounts).flat_map(wall);
        let particles: Vec<_> = walls.flat_map(|sprite| std::iter::repeat_n(sprite, copies)).collect();
        let extent = SmokeExtent { center: vec3(0.0, 0.0, -10.0), near: 7.0, far: 13.0, farthest: 13.0 };
        let knots = optical_depths(
            &view,
            &ParticleSpace::new(&view, &Mat4::IDENTITY),
            &particles,
            1,
            &Settings::default(),
            &extent,
        );
        depths.map(|depth| optical_depth_in_front(&knots, depth, extent.near, extent.far))
    }

    #[test]
    fn optical_depths_of_sprite_walls_add_up() {
        let of_amount = |amount: f32| -(1.0 - amount).ln();
        // Sprites are 0.5 m wide and 0.25 m apart: four overlap everywhere, each with 3/8 of its optical depth on
        // average.
        let of_wall = |amount| 4.0 * 0.375 * of_amount(amount);
        let first = of_wall(0.3);
        let second = of_wall(0.6);
        let [before, between, behind, far_behind] = in_front_of([0.3, 0.6], [6.0, 10.0, 14.5, 40.0], 1);
        assert!(before.abs() < 0.01, "{before}");
        assert!((between / first - 1.0).abs() < 0.1, "{between} {first}");
        assert!((behind / (first + second) - 1.0).abs() < 0.1, "{behind} {first} {second}");
        assert!((behind - far_behind).abs() < 1e-6, "{far_behind}");
    }

    #[test]
    fn a_share_of_many_sprites_stands_for_all() {
        let depths = [6.0, 10.0, 14.5, 40.0];
        let one = in_front_of([0.003, 0.006], depths, 1);
        let many = in_front_of([0.003, 0.006], depths, 200);
        for (one, many) in one.into_iter().zip(many) {
            assert!((many - 200.0 * one).abs() <= 1.0e-3 * many, "{many} {one}");
        }
    }
}
