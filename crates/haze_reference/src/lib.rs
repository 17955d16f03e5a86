//! CPU renderer: the whole frame in f32, with the same passes as the GPU renderer. It is the oracle of the tests, and
//! draws on machines without a GPU driver.

pub mod accumulated;
pub mod blend_unit;
mod input;
pub mod optical_depths;
pub mod pass;
mod probe;
pub mod sprite;
pub mod visible_system;

use std::sync::Arc;

use glam::Vec4;

use haze::assets::image::Image;
use haze::error::FieldError;
use haze::settings::DebugView;

use accumulated::AccumulatedTarget;
pub use accumulated::AccumulatedTextures;
pub use input::{FrameInput, ParticleSystem};
use pass::density_splat::density_from_steps;
use pass::shadow_march::shadow_march;
pub use probe::{GlowProbe, LightProbe, Probe, ProbeTextures, SystemProbe, probe};
use visible_system::visible_systems;

/// Blends the frame's smoke over `picture`, linear HDR.
///
/// # Errors
/// The first view, light or setting that is invalid; `picture` is untouched then.
pub fn render(frame: &FrameInput<'_>, picture: &mut Image<Vec4>) -> Result<(), FieldError> {
    let mut systems = visible_systems(frame, picture.size)?;
    if let Some(shadow) = systems.first().and_then(|(_, visible)| visible.shadow) {
        let size = shadow.grid.size;
        let mut steps = vec![0; size.element_product() as usize];
        systems.iter().for_each(|(_, visible)| visible.density_splat(size, &mut steps));
        let depths = Arc::new(shadow_march(&density_from_steps(&steps), &shadow));
        systems.iter_mut().for_each(|(_, visible)| visible.optical_depths = Some(depths.clone()));
    }
    for (_, visible) in &systems {
        if visible.settings.is_forward() {
            if frame.debug_view.shows_lit_smoke() {
                visible.forward(picture);
            }
            continue;
        }
        let reduced_depth = visible.depth_downsample();
        let textures = match frame.debug_view {
            DebugView::Overdraw => visible.overdraw(&reduced_depth),
            _ => visible.accumulate(&reduced_depth),
        };
        let baked = visible.diffuse_bake();
        let (reduced_depth, textures) = (&reduced_depth, &textures);
        let mut smoke = AccumulatedTarget { visible, baked: &baked, reduced_depth, textures, lit: None };
        if visible.lights_per_texel(frame.debug_view) {
            smoke.lit = Some(smoke.light_target());
        }
        if frame.debug_view != DebugView::SpecularScatter {
            smoke.transfer(frame.debug_view, picture);
        }
        if frame.debug_view.shows_glow() {
            smoke.specular_scatter(picture);
        }
    }
    Ok(())
}
