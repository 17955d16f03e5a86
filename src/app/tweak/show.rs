//! How the preset is looked at.

use haze::settings::ShadeTree;

use super::lights::ShownLights;

/// What is shown of the preset; no part of it.
#[derive(Clone, Debug)]
pub struct Show {
    pub stage: ShadeTree,
    /// All stages are shown, small.
    pub has_strip: bool,
    /// Width of the picture over its height.
    pub aspect: f32,
    /// The list of keys is open.
    pub help: bool,
    pub tab: Tab,
    /// The system whose settings are shown.
    pub system: usize,
    pub lights: ShownLights,
}

/// A part of the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tab {
    Look,
    Light,
    Smoke,
    Advanced,
}

impl Default for Show {
    fn default() -> Self {
        Self {
            stage: ShadeTree::Final,
            has_strip: true,
            aspect: 16.0 / 9.0,
            help: false,
            tab: Tab::Look,
            system: 0,
            lights: ShownLights::default(),
        }
    }
}
