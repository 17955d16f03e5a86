//! CPU renderer: the whole frame in f32, with the same passes as the GPU renderer. It is the oracle of the tests, and
//! draws on machines without a GPU driver.

pub mod accumulated;
pub mod blend_unit;
mod frame_shadow;
mod input;
mod lit_target;
pub mod optical_depths;
pub mod pass;
mod probe;
mod scene_shadow;
pub mod shade;
pub mod sprite;
pub mod visible_system;

use std::sync::Arc;

use glam::{UVec2, Vec4};

use haze_core::assets::image::Image;
use haze_core::error::FieldError;
use haze_core::formula::depth::SKY_VIEW_DEPTH;
use haze_core::settings::DebugView;
use haze_core::view_setup::ViewGeometry;

pub use accumulated::AccumulatedTextures;
use accumulated::{AccumulatedTarget, LitTarget};
pub use input::{FrameInput, ParticleSystem, ShadowMap};
use pass::screen_shadow::ScreenShadow;
pub use probe::{FireProbe, GlowProbe, LightProbe, Probe, ProbeTextures, ShadowProbe, SystemProbe, probe};
pub use scene_shadow::SceneShadow;
use visible_system::{VisibleSystem, place_systems};

/// Frame whose shadow is computed, before its smoke is drawn.
pub struct PreparedFrame<'a> {
    systems: Vec<(usize, VisibleSystem<'a>)>,
    debug_view: DebugView,
    scene_shadow: Option<SceneShadow>,
    screen_shadow: Option<ScreenShadow<'a>>,
}

impl<'a> PreparedFrame<'a> {
    /// Places all systems, and computes the shadow of their smoke. `image`: size of the image, pixels.
    ///
    /// # Errors
    /// The first view, light or setting that is invalid.
    pub fn new(frame: &FrameInput<'a>, image: UVec2) -> Result<Self, FieldError> {
        let placed = place_systems(frame, image)?;
        let volume = placed.shadow.map(|shadow| (shadow, Arc::new(placed.shadow_volume(frame, &shadow))));
        let mut systems = placed.visible;
        let mut scene_shadow = None;
        let mut screen_shadow = None;
        if let Some((shadow, depths)) = volume {
            systems.iter_mut().for_each(|(_, visible)| visible.optical_depths = Some(depths.clone()));
            scene_shadow = SceneShadow::new(frame, &shadow, &depths);
            screen_shadow = ScreenShadow::new(frame, &ViewGeometry::new(&frame.view)?, &shadow);
        }
        Ok(Self { systems, debug_view: frame.debug_view, scene_shadow, screen_shadow })
    }

    /// Shadow of the smoke on the scene, if it casts any.
    pub fn scene_shadow(&self) -> Option<&SceneShadow> {
        self.scene_shadow.as_ref()
    }

    /// Range of view depths, metres, that deferred smoke lies in; from [`SKY_VIEW_DEPTH`] to 0 without any.
    pub fn smoke_depths(&self) -> [f32; 2] {
        let deferred = self.systems.iter().filter(|(_, visible)| !visible.settings.is_forward());
        deferred.fold([SKY_VIEW_DEPTH, 0.0], |[nearest, farthest], (_, visible)| {
            [nearest.min(visible.system.smoke_near), farthest.max(visible.system.smoke_far)]
        })
    }

    /// Darkens a lit image of the scene by the shadow of the smoke, as
    /// `Renderer::render_scene_shadow` does.
    pub fn shade_scene(&self, image: &mut Image<Vec4>) {
        if let (Some(screen), Some(shadow)) = (&self.screen_shadow, &self.scene_shadow) {
            screen.shade(shadow, image);
        }
    }

    /// Blends the smoke over `image`, linear HDR.
    pub fn render(&self, image: &mut Image<Vec4>) {
        for (_, visible) in &self.systems {
            if visible.settings.is_forward() {
                if self.debug_view.shows_lit_smoke() {
                    visible.forward(image);
                }
                continue;
            }
            let reduced_depth = visible.depth_downsample();
            let textures = match self.debug_view {
                DebugView::Overdraw => visible.overdraw(&reduced_depth),
                _ => visible.accumulate(&reduced_depth),
            };
            let baked = visible.diffuse_bake();
            let reduced_depth = &reduced_depth;
            let textures = &textures;
            let is_lit = visible.lights_per_texel(self.debug_view);
            let mut smoke = AccumulatedTarget { visible, baked: &baked, reduced_depth, textures, is_lit, lit: None };
            if is_lit {
                let light = smoke.light_target();
                let slopes = smoke.depth_slopes(&light);
                smoke.lit = Some(LitTarget { light, slopes });
            }
            if self.debug_view != DebugView::SpecularScatter {
                smoke.transfer(self.debug_view, image);
            }
            if self.debug_view.shows_glow() {
                smoke.specular_scatter(image);
            }
        }
    }
}

/// Blends the frame's smoke over `image`, linear HDR.
///
/// # Errors
/// The first view, light or setting that is invalid; `image` is untouched then.
pub fn render(frame: &FrameInput<'_>, image: &mut Image<Vec4>) -> Result<(), FieldError> {
    PreparedFrame::new(frame, image.size)?.render(image);
    Ok(())
}
