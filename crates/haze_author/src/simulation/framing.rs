//! Part of the box that the frames of a sprite show.

use glam::{Vec2, Vec3};
use haze_core::formula::curve::smoothstep_unit;

use super::domain::Domain;
use super::recorded_frame::Extent;
use super::sim_recipe::{Framing, View};

/// Distance from an open side of the box within which smoke fades, cells of the velocity.
const BOX_FADE: f32 = 4.0;
/// Least half side, box widths: an empty simulation has no extent.
const MIN_HALF_SIDE: f32 = 0.02;

/// Square that a frame shows, and the box around the smoke.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub middle: Vec2,
    /// Half the side, box widths.
    pub half_side: f32,
    /// Width of the border in which smoke fades, half sides.
    fade: f32,
    box_low: Vec3,
    box_high: Vec3,
    box_fade: f32,
    /// Least height of the gas.
    lowest: f32,
}

impl Window {
    /// Returns the window of frames whose smoke has an extent in all of them. `domain`: cells of the velocity.
    pub fn new(view: &View, domain: Domain, has_ground: bool, smoke: Extent) -> Self {
        let size = domain.grid.size.as_vec3();
        let mut box_low = domain.position(Vec3::splat(0.5));
        let box_high = domain.position(size + 0.5);
        let mut shown = match view.framing {
            Framing::Smoke if smoke.low.cmple(smoke.high).all() => smoke,
            Framing::Smoke | Framing::Box => Extent { low: box_low.truncate(), high: box_high.truncate() },
        };
        let margin = view.margin.min(0.45);
        let box_fade = BOX_FADE * domain.cell_width();
        if has_ground {
            // Smoke continues below the ground, where it fades: a sprite with a straight cut could not be turned.
            box_low.y -= box_fade;
            if shown.low.y < domain.cell_width() {
                shown.low.y = box_low.y;
            }
        }
        let half_side = (shown.high - shown.low).max_element() * 0.5 / (1.0 - 2.0 * margin);
        Self {
            middle: (shown.low + shown.high) * 0.5,
            half_side: half_side.max(MIN_HALF_SIDE),
            fade: margin.max(0.02),
            box_low,
            box_high,
            box_fade,
            lowest: if has_ground { domain.cell_width() * 0.5 } else { f32::NEG_INFINITY },
        }
    }

    /// Returns the position in box widths of a point of the frame, -1 to 1.
    fn position(&self, point: Vec3) -> Vec3 {
        point * self.half_side + self.middle.extend(0.0)
    }

    /// Returns the position of the gas that is seen at a point: below the ground that above it.
    pub fn gas_position(&self, point: Vec3) -> Vec3 {
        let position = self.position(point);
        position.with_y(position.y.max(self.lowest))
    }

    /// Returns the fraction of the smoke that is kept at a point of the frame: 0 at its border and at open sides of the
    /// box.
    pub fn fade(&self, point: Vec3) -> f32 {
        let position = self.position(point);
        let to_border = 1.0 - point.truncate().abs().max_element();
        let to_side = (position - self.box_low).min(self.box_high - position).min_element();
        smoothstep_unit((to_border / self.fade).min(to_side / self.box_fade))
    }
}
