//! How the preset is looked at.

use glam::UVec2;
use haze::settings::ShadeTree;

use super::lights::ShownLights;
use super::sprite::look::SpriteLook;

/// What is shown of the preset; no part of it.
#[derive(Clone, Debug)]
pub struct Show {
    pub stage: ShadeTree,
    /// All stages are shown, small.
    pub has_strip: bool,
    /// Pixels of the picture.
    pub size: UVec2,
    /// Width of the picture over its height.
    pub aspect: f32,
    /// The list of keys is open.
    pub help: bool,
    pub tab: Tab,
    /// The system whose settings are shown.
    pub system: usize,
    pub lights: ShownLights,
    pub overlays: Overlays,
    pub sprite: SpriteLook,
}

/// A part of the settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Tab {
    Look,
    Light,
    Smoke,
    Ramps,
    Sprite,
    Advanced,
    Performance,
}

impl Default for Show {
    fn default() -> Self {
        Self {
            size: UVec2::new(1280, 720),
            stage: ShadeTree::Final,
            has_strip: true,
            aspect: 16.0 / 9.0,
            help: false,
            tab: Tab::Look,
            system: 0,
            lights: ShownLights::default(),
            overlays: Overlays::default(),
            sprite: SpriteLook::default(),
        }
    }
}

/// What can be drawn over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlay {
    /// The box of each system.
    Bounds,
    /// The plane that light is flattened to.
    LitPlane,
    Particles,
    /// The texels of the accumulation target.
    Grid,
}

/// What is drawn over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlays([bool; 4]);

impl Overlays {
    pub fn has(self, overlay: Overlay) -> bool {
        self.0[overlay as usize]
    }

    pub fn is_any(self) -> bool {
        self.0.contains(&true)
    }

    pub fn toggle(&mut self, overlay: Overlay) {
        self.0[overlay as usize] ^= true;
    }
}
