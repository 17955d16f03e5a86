//! Shadow of smoke on smoke.

use super::settings_macro::settings;

settings! {
    /// Shadow of smoke on smoke. All systems of a frame shade each other, under the lights that are brightest on them.
    /// A coarse grid around the smoke holds its density; the light that comes through it is looked up in the shadow ramp.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Shadow {
        /// Mix of the shadow ramp and full light. 0: no shadow, and no cost. 1: the ramp as painted. With lighting by
        /// normals, only for `diffuse.mode` `ramp`.
        strength: f32 = 0.0, number(0.0..=1.0, "");
        /// Multiplies the density that the system's sprites have as casters. Higher: darker shadows of thinner smoke.
        density: f32 = 1.0, number(0.0..=16.0, "");
        /// Cells along the longest side of the grid; the largest number among the systems of a frame counts. Higher: finer
        /// shadows, at a cost that grows with its third power.
        resolution: u32 = 24, integer(4..=96, "cells");
        /// Number of lights that smoke shades, the brightest first; the largest number among the systems of a frame counts.
        /// The fourth and further lights shade smoke only with `by_depth`: their shadow is looked up at the mean depth of
        /// the smoke at each pixel, that of the first three at each sprite.
        lights: u32 = 3, integer(1..=15, "");
        /// Lights the smoke at its mean depth at each pixel, instead of one plane for all pixels: a lamp inside the smoke
        /// lights what is near it. At a `strength` above 0, the scene shades the smoke too, and beams stand in dust: its shadow
        /// comes from a host's shadow maps, `FrameInput::shadow_maps`. One more texture is accumulated, at any `strength`: a
        /// host's own passes may read the depth of the smoke there.
        by_depth: bool = false, flag;
        /// Mix of full light and the shadow that the smoke casts on the scene, tinted by the shadow ramp. The first system of
        /// a frame that casts any decides it. The demo scene shows it; a host's renderer does if its shaders call
        /// `haze_transmittance`.
        scene: f32 = 1.0, number(0.0..=1.0, "");
    }
}
