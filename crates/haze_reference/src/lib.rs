//! CPU renderer: the whole frame in f32, with the same passes as the GPU renderer. It is the oracle of the tests, and
//! draws on machines without a GPU driver.

mod accumulated;
pub mod blend_unit;
mod draw;
mod frame;
mod pass;
mod probe;
mod sprite;

use glam::Vec4;

use haze::assets::image::Image;
use haze::error::FieldError;
use haze::settings::DebugView;

use accumulated::Accumulated;
use draw::visible;
pub use frame::{Frame, System};
pub use probe::{GlowProbe, LightProbe, Probe, SystemProbe, Texels, probe};

/// Blends the frame's smoke over `picture`, linear HDR.
///
/// # Errors
/// The first view, light or setting that is invalid; `picture` is untouched then.
pub fn render(frame: &Frame<'_>, picture: &mut Image<Vec4>) -> Result<(), FieldError> {
    let draws = visible(frame, picture.size)?;
    for (_, draw) in &draws {
        if draw.settings.is_forward() {
            if frame.debug_view.shows_lit_smoke() {
                draw.forward(picture);
            }
            continue;
        }
        let reduced_depth = draw.depth_downsample();
        let accumulation = draw.accumulate(&reduced_depth, frame.debug_view == DebugView::Overdraw);
        let extra_attachment = draw.extra_attachment(&reduced_depth);
        let baked = draw.diffuse_bake();
        let (reduced_depth, accumulation, extra_attachment) =
            (&reduced_depth, &accumulation, extra_attachment.as_ref());
        let mut smoke = Accumulated { draw, baked: &baked, reduced_depth, accumulation, extra_attachment, lit: None };
        if draw.lights_per_texel(frame.debug_view) {
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
