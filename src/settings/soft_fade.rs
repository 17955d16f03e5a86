//! The fade of sprites before scene and camera.

use crate::fields::{FieldVisitor, Fields};

choice! {
    /// The curve from depth difference to fade; x is the difference times `fade_scale`, clamped to 0..1.
    FadeCurve {
        /// 3x² - 2x³: no crease at either end.
        #[default]
        Smoothstep = "smoothstep",
        /// x.
        Linear = "linear",
        /// NV's symmetric power curve.
        Contrast = "contrast",
        /// NV's `1 - 2^(-2 (2x)^c)`. Does not reach 1: 0.9375 at x = 1 for c = 1.
        Exponential = "exponential",
        /// Whole up to the surface, and linearly gone `1 / fade_scale` metres behind it: sprites show through. Techniques
        /// that fade have no depth test then; the others know no curve. (BLOG, comment)
        Always = "always",
    }
}

/// The soft depth fade: how a sprite dissolves where it meets the scene or the camera.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "app", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct SoftFade {
    /// The curve.
    pub curve: FadeCurve,
    /// Reciprocal of the distance over which a sprite fades. Larger is harder.
    pub fade_scale: f32,
    /// Steepness of the `contrast` and `exponential` curves. 1 is linear for `contrast`.
    pub contrast_power: f32,
    /// Sprites closer to the surface than this are dropped. 0 keeps everything in front of the surface.
    pub epsilon: f32,
    /// View depth at which a sprite is gone.
    pub near_fade_start: f32,
    /// View depth from which a sprite is whole; not less than `near_fade_start`. Both 0: no near fade.
    pub near_fade_end: f32,
}

impl Default for SoftFade {
    fn default() -> Self {
        Self {
            curve: FadeCurve::default(),
            fade_scale: 2.0,
            contrast_power: 2.0,
            epsilon: 0.0,
            near_fade_start: 0.0,
            near_fade_end: 0.5,
        }
    }
}

impl SoftFade {
    /// Distance beyond which the scene behind a sprite changes nothing, metres.
    pub fn reach(&self) -> f32 {
        (1.0 / self.fade_scale).max(self.epsilon)
    }
}

impl Fields for SoftFade {
    fn visit(&mut self, visitor: &mut dyn FieldVisitor) {
        visitor.number("fade_scale", &mut self.fade_scale, 0.001..=1000.0, "1/m");
        visitor.number("contrast_power", &mut self.contrast_power, 0.1..=16.0, "");
        visitor.number("epsilon", &mut self.epsilon, 0.0..=10.0, "m");
        visitor.number("near_fade_start", &mut self.near_fade_start, 0.0..=1000.0, "m");
        visitor.number("near_fade_end", &mut self.near_fade_end, self.near_fade_start..=1000.0, "m");
    }
}
