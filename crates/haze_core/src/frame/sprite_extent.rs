//! Distance to which sprites extend from their particles' centers.

use glam::Vec3;

use crate::formula::stretch::stretch_ratio;
use crate::settings::{Settings, Technique};

/// Distance to which a system's sprites extend from their particles' centers, at any rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpriteExtent {
    /// Multiplies the radius of every particle.
    size: f32,
    /// Distance of a corner, in radii of the sprite.
    corner: f32,
    /// Seconds, and largest ratio, by which sprites are stretched; 0 and 1 if they are not.
    stretch: (f32, f32),
    /// Speed that counts instead of the particles' own.
    speed: Option<f32>,
}

impl SpriteExtent {
    /// Extent of sprites with these settings.
    pub fn from_settings(settings: &Settings) -> Self {
        let corner = match settings.technique {
            Technique::SphericalBillboard => settings.spherical_billboard.radius,
            Technique::VolumetricHard | Technique::VolumetricSoft => 1.0,
            _ => std::f32::consts::SQRT_2,
        };
        let sprite = &settings.sprite;
        let stretch = if settings.is_stretched() { (sprite.stretch, sprite.stretch_limit) } else { (0.0, 1.0) };
        let speed = (sprite.stretch_axis != Vec3::ZERO).then(|| sprite.stretch_axis.length());
        Self { size: sprite.size, corner, stretch, speed }
    }

    /// Distance to which the sprite of a particle extends at most, metres. `radius`: of the particle, metres. `speed`: its
    /// own, metres per second; counts only for stretched sprites.
    pub fn radius(&self, radius: f32, speed: f32) -> f32 {
        let (seconds, limit) = self.stretch;
        let speed = self.speed.unwrap_or(speed);
        let radius = radius * self.size;
        let ratio = if seconds > 0.0 { stretch_ratio(speed * seconds, radius, limit) } else { 1.0 };
        radius * self.corner * ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::stretch::sprite_stretch;

    #[test]
    fn extent_contains_stretched_sprites() {
        let mut settings = Settings::default();
        settings.sprite.size = 2.0;
        settings.sprite.stretch = 0.1;
        settings.sprite.stretch_limit = 6.0;
        let extent = SpriteExtent::from_settings(&settings);
        let velocity = Vec3::new(3.0, -4.0, 2.0);
        for depth in [0.2_f32, 2.0, 30.0] {
            let stretch = sprite_stretch(Vec3::new(1.0, 2.0, -depth), velocity, 0.1, 0.2 * 2.0, 6.0, 0.0);
            let corner = 0.4 * std::f32::consts::SQRT_2 / (1.0 - stretch.length_squared());
            assert!(corner <= extent.radius(0.2, velocity.length()) + 1e-6, "{corner} at {depth}");
        }
        settings.technique = Technique::VolumetricSoft;
        assert!((SpriteExtent::from_settings(&settings).radius(0.5, 1.0e9) - 1.0).abs() < 1.0e-6);
    }
}
