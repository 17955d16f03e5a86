//! What stands round the smoke in the demo program.

use glam::Vec3;

use crate::settings::{choice, settings};

settings! {
    /// The demo scene and the light of its sky.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Environment {
        /// Which scene stands round the smoke, and hides and is hidden by it.
        scene: SceneName = SceneName::Yard, choice;
        /// True where the yard has its lamp, with the body that glows: a prop for the light that presets put there. The light
        /// itself is the preset's, and stays.
        lamp: bool = true, flag;
        /// True where the yard has its brazier, with the embers that glow: a prop for smoke, and for the light that presets put
        /// there. The light itself is the preset's, and stays.
        brazier: bool = true, flag;
        /// Linear RGB of the sky overhead: lights the scene, not the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        zenith: Vec3 = Vec3::new(0.045, 0.07, 0.14), colour(0.0..=100.0);
        /// Linear RGB of the sky at the horizon, behind the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        horizon: Vec3 = Vec3::new(0.22, 0.19, 0.2), colour(0.0..=100.0);
        /// Linear RGB of the light that the ground throws back at the scene's undersides.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        ground: Vec3 = Vec3::new(0.03, 0.028, 0.026), colour(0.0..=100.0);
    }
}

choice! {
    /// The demo scenes.
    SceneName {
        /// A yard with walls, crates, pillars and a fence.
        #[default]
        Yard = "yard",
        /// A colonnade with a far door.
        Corridor = "corridor",
        /// A floor that meets a wall, both of an even neutral grey (0.18), and nothing else: for judging light.
        Studio = "studio",
        /// Nothing but the sky.
        Empty = "empty",
    }
}
