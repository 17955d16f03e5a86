//! View options of the preset.

use glam::UVec2;
use haze_core::settings::DebugView;

use super::light_view::LightView;
use super::sprite_view::SpriteView;
use super::system_view::SystemView;
use super::track_view::TrackView;

/// View options. They are not part of the preset.
#[derive(Clone, Debug)]
pub struct ViewOptions {
    pub debug_view: DebugView,
    /// The strip of debug views is visible.
    pub has_strip: bool,
    /// Size of the image in pixels.
    pub size: UVec2,
    /// Width of the image over its height.
    pub aspect: f32,
    /// The list of keys is open.
    pub help: bool,
    pub tab: Tab,
    /// Index of the system whose settings are shown.
    pub system: usize,
    pub systems: SystemView,
    pub lights: LightView,
    pub overlays: Overlays,
    pub sprite: SpriteView,
    /// The fire ramp is shown as the camera shows it, not as painted.
    pub fire_as_exposed: bool,
    pub tracks: TrackView,
}

/// Tab of the settings panel.
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

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            size: UVec2::new(1280, 720),
            debug_view: DebugView::Final,
            has_strip: true,
            aspect: 16.0 / 9.0,
            help: false,
            tab: Tab::Look,
            system: 0,
            systems: SystemView::default(),
            lights: LightView::default(),
            overlays: Overlays::default(),
            sprite: SpriteView::default(),
            fire_as_exposed: false,
            tracks: TrackView::default(),
        }
    }
}

/// Overlay on the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlay {
    /// Bounding box of each system.
    Bounds,
    /// Plane that is lit instead of the volume (flattened shading).
    LitPlane,
    Particles,
    /// Texels of the accumulation target.
    Grid,
}

/// Set of visible overlays.
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
