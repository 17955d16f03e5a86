//! Shots of sprites for the suites: large ones in layers, and crowds of small ones.

use std::path::Path;

use glam::{UVec2, Vec3};
use haze_core::assets::sprite::Sprite;
use haze_core::error::Error;
use haze_demo::shot::Shot;
use haze_preset::Preset;

/// A shot of `count` sprites as large as the image, each of this amount, among crates.
pub fn layers(size: UVec2, count: u32, amount: f32) -> Result<Shot, Error> {
    let path = Path::new("layers.json");
    let mut preset = Preset::parse(path, include_str!("soft_particles.json"))?;
    for system in &mut preset.systems {
        system.emitter.rate = count as f32;
        system.emitter.amount = amount;
        system.emitter.spin = 1.0;
    }
    Shot::new(preset, path, size)
}

/// Number of those sprites that makes so many layers.
pub fn sprite_count(layers: u32) -> u32 {
    // Each covers 0.418 of the smoke's box: transparent parts of its square are not drawn.
    (layers as f32 / 0.418).round() as u32
}

/// Mean alpha of what is drawn of a sprite whose amount is 1: of the bounding rectangles of its frames' non-zero
/// texels.
pub fn mean_alpha(sprite: &Sprite) -> f32 {
    let size = sprite.size();
    let mut sum = 0.0;
    let mut texels = 0.0;
    for frame in 0..sprite.frame_count() {
        let mut low = UVec2::MAX;
        let mut high = UVec2::ZERO;
        let mut of_frame = 0.0;
        for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
            let alpha = sprite.texel(0, frame, x, y).w;
            if alpha > 0.0 {
                low = low.min(UVec2::new(x, y));
                high = high.max(UVec2::new(x, y) + 1);
                of_frame += alpha;
            }
        }
        sum += of_frame;
        texels += high.saturating_sub(low).as_vec2().element_product();
    }
    if texels > 0.0 { sum / texels } else { 0.0 }
}

/// Changes the amount of the sprites so that their mean alpha is `alpha`.
pub fn with_alpha(mut shot: Shot, alpha: f32) -> Shot {
    for (system, material) in shot.preset.systems.iter_mut().zip(&shot.materials) {
        system.emitter.amount = alpha / mean_alpha(&material.sprite);
    }
    shot
}

/// A shot of 4,096 small sprites, 64 layers deep.
pub fn crowd(size: UVec2) -> Result<Shot, Error> {
    small_sprites(size, 4096, 64.0, WITHIN_IMAGE)
}

/// Extent of a crowd of sprites.
#[derive(Clone, Copy)]
pub struct CrowdExtent {
    /// Extent relative to the image.
    pub images: f32,
    /// Mean fraction of the image that a sprite of `layers` covers, without the parts outside the image.
    mean_coverage: f32,
}

/// Ends at the edges of the image, where it is thin.
pub const WITHIN_IMAGE: CrowdExtent = CrowdExtent { images: 1.0, mean_coverage: 0.437 };
/// Extends beyond the image, and is as deep at its edges as elsewhere.
pub const BEYOND_IMAGE: CrowdExtent = CrowdExtent { images: 1.6, mean_coverage: 0.265 };

/// A shot of `count` small sprites all over the image, about `deep` layers deep.
pub fn small_sprites(size: UVec2, count: u32, deep: f32, extent: CrowdExtent) -> Result<Shot, Error> {
    let mut shot = layers(size, count, 0.1)?;
    for system in &mut shot.preset.systems {
        let emitter_extent = Vec3::new(2.0 * extent.images, 1.1 * extent.images, 0.8);
        system.emitter.duration = 1.0;
        system.emitter.extent = emitter_extent;
        system.settings.sprite.size *= (deep / (extent.mean_coverage * count as f32)).sqrt();
    }
    Ok(shot)
}
