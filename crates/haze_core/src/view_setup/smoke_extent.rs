//! Extent of a system's smoke in the view: the plane that light is flattened to, and the range of depths in which
//! lights gradually move behind the smoke.
//!
//! The bounding box is not suitable: it jumps with every birth and death, and one stray sprite moves it. Here every
//! sprite is weighted by its visible amount and area, so faint or small sprites have little effect, and sprites that
//! fade in or out move the result slowly.

use glam::{DVec4, Vec3, Vec3A, Vec4};

use super::projected_bounds::ProjectedBounds;
use super::view_geometry::ViewGeometry;
use crate::formula::smoke_extent::{NEARLY_TRANSPARENT, extent_weight, half_extent, mean_square_depth, reach_behind};
use crate::frame::{Bounds, Particle};

/// Extent of the smoke, view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmokeExtent {
    /// Light is flattened to the plane through this point that faces the viewer; light by normal is baked for this
    /// point.
    pub center: Vec3,
    /// View depths between which most of the smoke lies, metres.
    pub near: f32,
    /// See `near`.
    pub far: f32,
    /// View depth behind which there is no smoke, metres. A nearly transparent sprite contributes less, so that its
    /// death causes no jump.
    pub farthest: f32,
}

/// Number of sprites that are summed in f32.
const BLOCK: u32 = 64;

/// Sums over the visible particles, from which their extent follows.
#[derive(Debug, Default)]
pub(super) struct ExtentSums {
    /// First visible particle. Sums are relative to it, so that squares of large depths do not cancel out.
    reference: Option<Vec3A>,
    /// Sums of positions times weight, and of weights. f64, because up to a million sprites are summed.
    positions: DVec4,
    squares: f64,
    /// Sums since the last multiple of `BLOCK` sprites: additions in f32 take half the time.
    block_positions: Vec4,
    block_squares: f32,
    block_count: u32,
    /// Largest view depth of the back of a sprite with full weight, metres.
    back: f32,
    /// View depth of the back of each nearly transparent sprite, and its amount.
    faint_backs: Vec<(f32, f32)>,
}

impl ExtentSums {
    /// Starts over; keeps the memory.
    pub fn clear(&mut self) {
        self.faint_backs.clear();
        let faint_backs = std::mem::take(&mut self.faint_backs);
        *self = Self { faint_backs, ..Self::default() };
    }

    /// Adds a visible particle at a view-space position, weighted by amount and area. `near`: view depth of the near
    /// plane, metres. `size` multiplies its radius.
    pub fn include(&mut self, near: f32, position: Vec3A, particle: &Particle, size: f32) {
        let radius = particle.radius * size;
        let amount = particle.shown_amount();
        let back = -position.z + radius;
        if amount < NEARLY_TRANSPARENT {
            self.faint_backs.push((back, amount));
        } else {
            self.back = self.back.max(back);
        }
        let weight = extent_weight(amount, radius, -position.z, near);
        let position = position - *self.reference.get_or_insert(position);
        self.block_positions += position.extend(1.0) * weight;
        self.block_squares += mean_square_depth(position.z, radius) * weight;
        self.block_count += 1;
        if self.block_count == BLOCK {
            (self.positions, self.squares) = self.totals();
            self.block_positions = Vec4::ZERO;
            self.block_squares = 0.0;
            self.block_count = 0;
        }
    }

    fn totals(&self) -> (DVec4, f64) {
        (self.positions + self.block_positions.as_dvec4(), self.squares + f64::from(self.block_squares))
    }

    /// Returns the extent of the included particles; `None` if none of them is in front of the viewer.
    pub fn extent(&self) -> Option<SmokeExtent> {
        let reference = self.reference?;
        let (positions, squares) = self.totals();
        let weights = positions.w;
        // False for NaN, which comes from sprites of size 0.
        (weights > 0.0).then(|| {
            let mean = (positions.truncate() / weights).as_vec3();
            let half = half_extent((squares / weights) as f32, mean.z);
            let center = Vec3::from(reference) + mean;
            let reach = |(back, amount)| reach_behind(amount, back, -center.z);
            let faint = self.faint_backs.iter().copied().map(reach).fold(0.0, f32::max);
            let farthest = -center.z + reach((self.back, 1.0)).max(faint);
            SmokeExtent { center, near: -center.z - half, far: -center.z + half, farthest }
        })
    }
}

impl SmokeExtent {
    /// Extent of measured particles, or that of the bounding box if there are none. `depth`: view depth of the center
    /// that the host chose, metres.
    pub(super) fn new(
        view: &ViewGeometry,
        measured: Option<Self>,
        bounds: &Bounds,
        projected: &ProjectedBounds,
        depth: Option<f32>,
    ) -> Self {
        let mut extent = measured.unwrap_or_else(|| Self::of_bounds(view, bounds, projected));
        if let Some(depth) = depth {
            extent.center.z = -(depth + view.depth_offset).max(view.depth.near);
        }
        extent
    }

    /// Returns the center of the part of the box that is in front of the viewer.
    fn of_bounds(view: &ViewGeometry, bounds: &Bounds, projected: &ProjectedBounds) -> Self {
        let depth = 0.5 * (projected.near.max(view.depth.near) + projected.far);
        let center = view.view_position(bounds.center()).with_z(-depth);
        Self { center, near: projected.near, far: projected.far, farthest: projected.far }
    }
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::proj::directx::perspective;
    use glam::{Mat4, UVec2, vec3};

    use super::*;
    use crate::frame::{SpriteExtent, View, particle_bounds};
    use crate::settings::Settings;
    use crate::view_setup::projected_bounds::project_bounds;

    fn extent(particles: &[Particle], depth: Option<f32>) -> SmokeExtent {
        let view = View::new(Mat4::IDENTITY, perspective(0.8, 1.0, 0.1, 80.0), UVec2::splat(64));
        let view = ViewGeometry::new(&view).unwrap();
        let bounds = particle_bounds(particles, SpriteExtent::from_settings(&Settings::default()));
        let mut sums = ExtentSums::default();
        sums.clear();
        particles
            .iter()
            .filter(|particle| particle.is_visible())
            .for_each(|puff| sums.include(view.depth.near, puff.position.into(), puff, 1.0));
        SmokeExtent::new(&view, sums.extent(), &bounds, &project_bounds(&bounds, &view).unwrap(), depth)
    }

    fn puff(depth: f32, radius: f32, amount: f32) -> Particle {
        Particle { position: vec3(0.0, 0.0, -depth), radius, amount, ..Particle::default() }
    }

    #[test]
    fn sprites_are_weighted_by_amount_and_area() {
        let near_and_far = |amount, radius| -extent(&[puff(4.0, 1.0, 1.0), puff(8.0, radius, amount)], None).center.z;
        assert!((near_and_far(1.0, 1.0) - 6.0).abs() < 1e-4);
        assert!((near_and_far(0.5, 1.0) - (4.0 + 8.0 * 0.5) / 1.5).abs() < 1e-4);
        assert!((near_and_far(1.0, 2.0) - (4.0 + 8.0 * 4.0) / 5.0).abs() < 1e-4);
        // Amounts above 1 count as 1.
        assert!((near_and_far(1.0, 1.0) - near_and_far(7.0, 1.0)).abs() < 1e-6);
    }

    #[test]
    fn single_puff_extends_one_radius_to_the_front_and_to_the_back() {
        let extent = extent(&[puff(5.0, 1.0, 1.0)], None);
        assert!((extent.near - 4.0).abs() < 1e-3 && (extent.far - 6.0).abs() < 1e-3, "{extent:?}");
    }

    #[test]
    fn sprite_that_passes_the_near_plane_moves_the_center_slowly() {
        let at = |depth| -extent(&[puff(6.0, 1.0, 1.0), puff(depth, 1.0, 1.0)], None).center.z;
        let steps = (0..=400).map(|i| at(2.0 - 0.01 * i as f32));
        let largest = steps.clone().zip(steps.skip(1)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        // The sprite moves by 0.01 m per step. If it lost its weight at once, the center would jump by 3 m.
        assert!(largest < 0.06, "{largest}");
        assert!((at(-2.0) - 6.0).abs() < 1e-4);
    }

    #[test]
    fn host_can_set_the_depth_of_the_center() {
        let puffs = [puff(5.0, 1.0, 1.0)];
        let chosen = extent(&puffs, Some(9.0));
        assert!((chosen.center.z + 9.0).abs() < 1e-5, "{chosen:?}");
        // A depth behind the viewer is clamped to the near plane.
        assert!((extent(&puffs, Some(-3.0)).center.z + 0.1).abs() < 1e-5);
    }
}
