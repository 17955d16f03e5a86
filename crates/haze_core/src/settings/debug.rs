//! Settings to debug smoke, and to measure it.

use super::settings_macro::settings;

settings! {
    /// Settings to debug smoke, and to measure it.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct DebugSettings {
        /// Shows a checkerboard instead of the sprite. (NV)
        checkerboard: bool = false, flag;
        /// Draws all sprites this many times, to measure the cost of fragments. (NV)
        draw_count: u32 = 1, integer(1..=10_000, "");
        /// Holds every sprite at the frame it was born with, and the noise of volumetric sprites at time 0. Frames come
        /// from the emitter: a host with its own simulation has to stop them itself.
        freeze_animation: bool = false, flag;
    }
}
