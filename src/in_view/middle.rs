//! Where in a view the smoke of a system is: the plane that light is flattened to, and the depths between which lights come
//! to stand behind it.
//!
//! A box would not do: it jumps with every sprite that is born or dies, and one stray sprite moves it. Here every sprite
//! counts by what there is to see of it, so what is faint or small moves nothing, and what fades in or out moves it slowly.

use glam::{DVec3, Vec3};

use super::bounds::BoundsInView;
use super::view::ViewGeometry;
use crate::frame::{Bounds, Particle};

/// Where the smoke is, view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Middle {
    /// Light is flattened to the plane through it that faces the viewer; light by normal is baked for it.
    pub centre: Vec3,
    /// View depths between which most of the smoke lies.
    pub near: f32,
    pub far: f32,
    /// View depth behind which nothing is; sprites that are all but gone draw back from it.
    pub farthest: f32,
}

/// The amount below which a sprite is all but gone.
const FAINT: f32 = 0.05;

impl Middle {
    /// Of the sprites that are in memory, or else of the box, `depth` being the host's choice.
    pub fn new(
        view: &ViewGeometry,
        particles: &[Particle],
        size: f32,
        bounds: &Bounds,
        in_view: &BoundsInView,
        depth: Option<f32>,
    ) -> Self {
        let measured = Self::of_particles(view, particles, size);
        let mut middle = measured.unwrap_or_else(|| Self::of_bounds(view, bounds, in_view));
        if let Some(depth) = depth {
            middle.centre.z = -(depth + view.depth_offset).max(view.depth.near);
        }
        middle
    }

    /// Weighted by amount and area; `size` multiplies radii. `None` when nothing is in front of the viewer.
    fn of_particles(view: &ViewGeometry, particles: &[Particle], size: f32) -> Option<Self> {
        // f64: a million sprites, squared.
        let (mut weights, mut sum, mut squares) = (0.0_f64, DVec3::ZERO, 0.0_f64);
        for particle in particles.iter().filter(|particle| particle.is_visible()) {
            let position = view.view_position(particle.position).as_dvec3();
            let radius = f64::from(particle.radius * size);
            // What passes the near plane loses its weight on the way there.
            let in_front = ((-position.z - f64::from(view.depth.near)) / radius).clamp(0.0, 1.0);
            let weight = f64::from(particle.shown_amount()) * in_front * radius * radius;
            weights += weight;
            sum += position * weight;
            // A sprite stands for a puff as thick as it is wide.
            squares += (position.z * position.z + radius * radius / 3.0) * weight;
        }
        // False for NaN: sprites of no size.
        (weights > 0.0).then(|| {
            let centre = sum / weights;
            // The variance of a slab is a third of its half thickness, squared.
            let half = (3.0 * (squares / weights - centre.z * centre.z)).max(0.0).sqrt();
            let (near, far) = ((-centre.z - half) as f32, (-centre.z + half) as f32);
            let behind = |particle: &Particle| {
                let back = -view.view_position(particle.position).z + particle.radius * size;
                (back + centre.z as f32) * (particle.shown_amount() / FAINT).min(1.0)
            };
            let visible = particles.iter().filter(|particle| particle.is_visible());
            let farthest = visible.map(behind).fold(0.0, f32::max) - centre.z as f32;
            Self { centre: centre.as_vec3(), near, far, farthest }
        })
    }

    /// In the middle of what of the box is in front of the viewer.
    fn of_bounds(view: &ViewGeometry, bounds: &Bounds, in_view: &BoundsInView) -> Self {
        let depth = 0.5 * (in_view.near.max(view.depth.near) + in_view.far);
        let centre = view.view_position(bounds.centre()).with_z(-depth);
        Self { centre, near: in_view.near, far: in_view.far, farthest: in_view.far }
    }
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::proj::directx::perspective;
    use glam::{Mat4, UVec2, vec3};

    use super::*;
    use crate::frame::{View, bounds_of};
    use crate::in_view::bounds::bounds_in_view;

    fn middle(particles: &[Particle], depth: Option<f32>) -> Middle {
        let view = View::new(Mat4::IDENTITY, perspective(0.8, 1.0, 0.1, 80.0), UVec2::splat(64));
        let view = ViewGeometry::new(&view).unwrap();
        let bounds = bounds_of(particles, 1.5);
        Middle::new(&view, particles, 1.0, &bounds, &bounds_in_view(&bounds, &view).unwrap(), depth)
    }

    fn puff(depth: f32, radius: f32, amount: f32) -> Particle {
        Particle { position: vec3(0.0, 0.0, -depth), radius, amount, ..Particle::default() }
    }

    #[test]
    fn sprites_count_by_amount_and_area() {
        let near_and_far = |amount, radius| -middle(&[puff(4.0, 1.0, 1.0), puff(8.0, radius, amount)], None).centre.z;
        assert!((near_and_far(1.0, 1.0) - 6.0).abs() < 1e-4);
        assert!((near_and_far(0.5, 1.0) - (4.0 + 8.0 * 0.5) / 1.5).abs() < 1e-4);
        assert!((near_and_far(1.0, 2.0) - (4.0 + 8.0 * 4.0) / 5.0).abs() < 1e-4);
        // More than all counts as all.
        assert!((near_and_far(1.0, 1.0) - near_and_far(7.0, 1.0)).abs() < 1e-6);
    }

    #[test]
    fn a_single_puff_reaches_a_radius_either_way() {
        let middle = middle(&[puff(5.0, 1.0, 1.0)], None);
        assert!((middle.near - 4.0).abs() < 1e-3 && (middle.far - 6.0).abs() < 1e-3, "{middle:?}");
    }

    #[test]
    fn what_passes_the_near_plane_leaves_slowly() {
        let at = |depth| -middle(&[puff(6.0, 1.0, 1.0), puff(depth, 1.0, 1.0)], None).centre.z;
        let steps = (0..=400).map(|i| at(2.0 - 0.01 * i as f32));
        let largest = steps.clone().zip(steps.skip(1)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // It moves by 0.01 m a step; a sprite that left at once would take the middle 3 m with it.
        assert!(largest < 0.06, "{largest}");
        assert!((at(-2.0) - 6.0).abs() < 1e-4);
    }

    #[test]
    fn a_host_may_choose() {
        let puffs = [puff(5.0, 1.0, 1.0)];
        let chosen = middle(&puffs, Some(9.0));
        assert!((chosen.centre.z + 9.0).abs() < 1e-5, "{chosen:?}");
        // Behind the viewer there is no plane to light.
        assert!((middle(&puffs, Some(-3.0)).centre.z + 0.1).abs() < 1e-5);
    }
}
