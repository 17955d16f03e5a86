//! Surroundings of the smoke in the demo program.

use glam::Vec3;

use crate::settings::{choice, settings};

settings! {
    /// Demo scene, and the light of its sky.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Environment {
        /// Scene around the smoke, which hides the smoke and is hidden by it.
        scene: SceneName = SceneName::Yard, choice;
        /// Shows the lamp of the yard with its glowing body: a prop for the light that presets put there. The light
        /// itself belongs to the preset and stays.
        lamp: bool = true, flag;
        /// Shows the brazier of the yard with its glowing embers: a prop for smoke, and for the light that presets put
        /// there. The light itself belongs to the preset and stays.
        brazier: bool = true, flag;
        /// Linear RGB of the sky overhead. It lights the scene, not the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        zenith: Vec3 = Vec3::new(0.045, 0.07, 0.14), color(0.0..=100.0);
        /// Linear RGB of the sky at the horizon, behind the smoke.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        horizon: Vec3 = Vec3::new(0.22, 0.19, 0.2), color(0.0..=100.0);
        /// Linear RGB of the light that the ground reflects to the undersides of the scene.
        #[cfg_attr(feature = "schema", schemars(with = "[f32; 3]"))]
        ground: Vec3 = Vec3::new(0.03, 0.028, 0.026), color(0.0..=100.0);
    }
}

choice! {
    /// Demo scenes.
    #[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
    SceneName {
        /// A yard with walls, crates, pillars and a fence.
        #[default]
        Yard = "yard",
        /// A colonnade with a far door.
        Corridor = "corridor",
        /// A floor and a wall of even neutral grey (0.18), and nothing else: for judging light.
        Studio = "studio",
        /// The sky alone.
        Empty = "empty",
    }
}
