//! What there is to accumulate of a system, from a few of its sprites.

use glam::UVec2;

use crate::frame::Particle;
use crate::in_view::{Grid, Placing, optical_depth};
use crate::settings::{Layers, Order, Settings, Technique};

/// Sprites that are looked at, of all: some ten microseconds.
const SAMPLE: usize = 256;
/// Layers of sprites that the CPU does not know, and the optical depth of each.
const ASSUMED_LAYERS: f64 = 16.0;
const ASSUMED_DEPTH: f64 = 0.05;

/// What there is to accumulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathLoad {
    /// How its sprites meet the scene.
    pub technique: Technique,
    /// Sprites.
    pub sprites: f64,
    /// Texels that they cover, one above the other.
    pub fragments: f64,
    /// Sides of the target, texels.
    pub size: UVec2,
    /// Optical depth of a sprite, −ln(1 − amount), in the mean over what it covers; 0 where no layer may be left out.
    pub optical_depth: f64,
    /// Octaves of all steps of a volumetric sprite.
    pub lookups: f64,
    /// Nothing is known of the sprites but their number.
    pub is_assumed: bool,
}

/// Of so many sprites on a target. `known`: particles that stand for all, and how many each of them is.
pub(crate) fn load(
    placing: &Placing<'_>,
    grid: &Grid,
    sprites: u32,
    known: Option<(&[Particle], u32)>,
    settings: &Settings,
) -> PathLoad {
    let texels = grid.size.as_dvec2().element_product();
    let loops = f64::from(settings.sprite.debug_loop);
    let (fragments, depth) = match known {
        None => (ASSUMED_LAYERS * texels, ASSUMED_DEPTH),
        Some((particles, each)) => {
            let step = particles.len().div_ceil(SAMPLE).max(1);
            let sample = particles.iter().step_by(step).filter(|particle: &&Particle| particle.is_visible());
            let (areas, depths) = placing.covered(grid, sample).fold((0.0, 0.0), |(areas, depths), sprite| {
                // Of what is clear of its square nothing is covered.
                let depth = f64::from(optical_depth(sprite.particle, settings)) / sprite.share.max(1.0e-6);
                (areas + sprite.texels, depths + sprite.texels * depth)
            });
            (areas * step as f64 * f64::from(each), depths / f64::max(areas, 1.0e-9))
        }
    };
    let stops = settings.accumulate.layers == Layers::Visible && settings.order() == Order::Sorted;
    PathLoad {
        technique: settings.technique,
        sprites: f64::from(sprites) * loops,
        fragments: fragments * loops,
        size: grid.size,
        optical_depth: if stops { depth } else { 0.0 },
        lookups: f64::from(settings.volumetric.march_steps * settings.volumetric.noise_octaves),
        is_assumed: known.is_none(),
    }
}
