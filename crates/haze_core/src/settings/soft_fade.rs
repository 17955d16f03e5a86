//! Fade of sprites near the scene and near the camera.

use super::choice::choice;
use super::settings_macro::settings;

choice! {
    /// Curve from depth difference to fade. x is the difference times `fade_scale`, clamped to 0..1.
    FadeCurve {
        /// 3x² - 2x³: no crease at either end.
        #[default]
        Smoothstep = "smoothstep",
        /// x: linear.
        Linear = "linear",
        /// NV's symmetric power curve.
        Contrast = "contrast",
        /// NV's `1 - 2^(-2 (2x)^c)`. Ends below 1: 0.9375 at x = 1 for c = 1.
        Exponential = "exponential",
        /// Full up to the surface, then linearly down to nothing `1 / fade_scale` metres behind it: sprites show
        /// through. Techniques that fade have no depth test then; the others ignore the curve. (BLOG, comment)
        Always = "always",
    }
}

settings! {
    /// Soft depth fade: sprites dissolve where they meet the scene or the camera.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct SoftFade {
        /// Curve by which a sprite appears, from nothing at the scene's surface to full.
        curve: FadeCurve = FadeCurve::default(), choice;
        /// Reciprocal of the distance over which a sprite fades. Higher: harder edges.
        fade_scale: f32 = 2.0, number(0.001..=1000.0, "1/m");
        /// Steepness of the `contrast` and `exponential` curves. Higher: a sharper step. 1 is linear for `contrast`.
        contrast_power: f32 = 2.0, number(0.1..=16.0, "");
        /// Distance in front of the surface within which sprites are dropped. 0 keeps everything in front of the
        /// surface.
        epsilon: f32 = 0.0, number(0.0..=10.0, "m");
        /// View depth at which a sprite has faded to nothing. Higher: smoke opens further in front of the camera.
        near_fade_start: f32 = 0.0, number(0.0..=1000.0, "m");
        /// View depth from which a sprite is full; not less than `near_fade_start`. Flat sprites also fade within a quarter of the
        /// near plane's distance behind that plane, whatever is set here.
        near_fade_end: f32 = 0.5, number(|this| this.near_fade_start..=1000.0, "m");
    }
}

impl SoftFade {
    /// Distance beyond which the scene behind a sprite has no effect on it, metres.
    pub fn max_distance(&self) -> f32 {
        (1.0 / self.fade_scale).max(self.epsilon)
    }

    /// Returns the view depths at which a sprite has faded to nothing, and from which it is full. The near plane would cut off what
    /// is left of a flat sprite there; it takes the others away bit by bit.
    pub(crate) fn near_fade_depths(&self, is_flat: bool, near: f32) -> [f32; 2] {
        if !is_flat {
            return [self.near_fade_start, self.near_fade_end];
        }
        let start = self.near_fade_start.max(near);
        [start, self.near_fade_end.max(start).max(1.25 * near)]
    }
}
