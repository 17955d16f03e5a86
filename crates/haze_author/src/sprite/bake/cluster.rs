//! Metaballs of a sprite before erosion. A ball may be stretched to a line.

use glam::{UVec3, Vec3};
use haze_core::assets::noise::{pcg3d, unit};

use super::sprite_recipe::SpriteRecipe;
use crate::deterministic_math::cos_sin;

#[derive(Clone, Copy)]
pub(super) struct Metaball {
    pub center: Vec3,
    pub inverse_radius: f32,
    /// Half of the line segment that the ball is stretched along; zero for a ball.
    pub axis: Vec3,
}

impl Metaball {
    /// Returns the offset of `p` from the nearest point of the ball's line.
    pub fn offset(&self, p: Vec3) -> Vec3 {
        let from = p - self.center;
        let along = from.dot(self.axis) / self.axis.length_squared().max(f32::MIN_POSITIVE);
        from - self.axis * along.clamp(-1.0, 1.0)
    }
}

/// Returns the balls at a time, as a fraction of the loop.
pub(super) fn balls(recipe: &SpriteRecipe, time: f32) -> Vec<Metaball> {
    let phase = cos_sin(time * std::f32::consts::TAU);
    let ball = |index| {
        let random = |salt: u32| {
            let hash = pcg3d(UVec3::new(index, salt, recipe.seed));
            Vec3::new(unit(hash.x), unit(hash.y), unit(hash.z))
        };
        let position = random(1);
        let shape = random(2);
        let z = position.x * 2.0 - 1.0;
        let xy = cos_sin(position.y * std::f32::consts::TAU) * (1.0 - z * z).sqrt();
        let distance = recipe.spread * position.z.sqrt();
        // Outer balls are smaller: a large body with small puffs on it.
        let size = shape.x * (1.0 - 0.6 * position.z);
        let radius = recipe.ball_radius_min + (recipe.ball_radius_max - recipe.ball_radius_min) * size;
        let swing = cos_sin(shape.y * std::f32::consts::TAU).rotate(phase) * recipe.drift;
        let any = (random(3) - 0.5).normalize_or(Vec3::Y);
        let upright = Vec3::Y * if any.y < 0.0 { -1.0 } else { 1.0 };
        let axis = any.lerp(upright, recipe.upright).normalize_or(Vec3::Y) * recipe.length;
        Metaball { center: xy.extend(z) * distance + swing.extend(0.0), inverse_radius: 1.0 / radius, axis }
    };
    (0..recipe.balls).map(ball).collect()
}
