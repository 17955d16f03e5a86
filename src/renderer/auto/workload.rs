//! Estimate of a system's accumulation workload from a sample of its sprites.

use haze_core::glam::UVec2;

use haze_core::frame::Particle;
use haze_core::settings::{BlendOrder, Settings, Technique, Traversal};
use haze_core::view_setup::{AttachmentSet, SpriteProjector, TexelGrid, optical_depth};

/// Maximum number of sprites sampled; the estimate takes about ten microseconds.
const SAMPLE: usize = 256;
/// Overdraw assumed for sprites that the CPU does not know, and the optical depth of each.
const ASSUMED_LAYERS: f64 = 16.0;
const ASSUMED_DEPTH: f64 = 0.05;

/// Accumulation workload of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PathWorkload {
    /// Technique of the sprites.
    pub technique: Technique,
    /// Number of sprites, times `debug.draw_count`.
    pub sprites: f64,
    /// Texels that the sprites cover, counted once per sprite.
    pub fragments: f64,
    /// Size of the target, texels.
    pub size: UVec2,
    /// Pixels of the image per texel, along each side.
    pub scale: u32,
    /// Mean optical depth of a sprite, −ln(1 − amount), over the texels that it covers; 0 if no layer may be skipped.
    pub optical_depth: f64,
    /// Textures that each fragment is blended into.
    pub attachments: u32,
    /// Octaves of grain; 0 for none.
    pub grain_octaves: u32,
    /// Noise lookups per fragment of a volumetric sprite: octaves times march steps.
    pub lookups: f64,
    /// True if only the number of sprites is known.
    pub is_assumed: bool,
}

impl PathWorkload {
    /// Workload of sprites without grain on a target of `size` texels at scale 1, which skips no layer. `fragments`: texels
    /// that the sprites cover, counted once per sprite.
    pub fn new(technique: Technique, size: UVec2, sprites: f64, fragments: f64) -> Self {
        Self {
            technique,
            sprites,
            fragments,
            size,
            scale: 1,
            optical_depth: 0.0,
            attachments: 1,
            grain_octaves: 0,
            lookups: 0.0,
            is_assumed: false,
        }
    }
}

/// Estimates the workload of `sprites` sprites on a target. `known`: particles that stand for all, and the number of
/// sprites that each represents.
pub(crate) fn estimate_workload(
    projector: &SpriteProjector<'_>,
    grid: &TexelGrid,
    sprites: u32,
    known: Option<(&[Particle], u32)>,
    settings: &Settings,
) -> PathWorkload {
    let texels = grid.size.as_dvec2().element_product();
    let loops = f64::from(settings.debug.draw_count);
    let (fragments, depth) = match known {
        None => (ASSUMED_LAYERS * texels, ASSUMED_DEPTH),
        Some((particles, each)) => {
            let step = particles.len().div_ceil(SAMPLE).max(1);
            let sample = particles.iter().step_by(step).filter(|particle: &&Particle| particle.is_visible());
            let (areas, depths) = projector.coverages(grid, sample).fold((0.0, 0.0), |(areas, depths), sprite| {
                // `optical_depth` is the mean over the whole square; only the fraction that is not trimmed is covered.
                let depth = f64::from(optical_depth(sprite.particle, settings)) / sprite.fraction.max(1.0e-6);
                (areas + sprite.texels, depths + sprite.texels * depth)
            });
            (areas * step as f64 * f64::from(each), depths / f64::max(areas, 1.0e-9))
        }
    };
    let stops = settings.accumulate.layers == Traversal::UntilOpaque && settings.order() == BlendOrder::Sorted;
    PathWorkload {
        technique: settings.technique,
        sprites: f64::from(sprites) * loops,
        fragments: fragments * loops,
        size: grid.size,
        scale: grid.scale as u32,
        optical_depth: if stops { depth } else { 0.0 },
        attachments: AttachmentSet::of(settings).iter().count() as u32,
        grain_octaves: settings.grain_octaves(),
        lookups: f64::from(settings.volumetric.march_steps * settings.volumetric.noise_octaves),
        is_assumed: known.is_none(),
    }
}
