//! View options of the sprite preview.

use haze_core::assets::sprite::Sprite;

use haze_author::light_angles::Angles;

/// Channel of a sprite that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpriteChannel {
    Lit,
    Normals,
    Amount,
    Depth,
    Motion,
}

/// All channels with their names and tooltips.
pub const SPRITE_CHANNELS: [(SpriteChannel, &str, &str); 5] = [
    (SpriteChannel::Lit, "Lit", "Lit by the diffuse ramp of the system"),
    (SpriteChannel::Normals, "Normals", "Normals as stored: x in red, y up in green, z to the viewer in blue"),
    (SpriteChannel::Amount, "Amount", "Opacity: white is opaque"),
    (SpriteChannel::Depth, "Depth", "Relief: white is towards the viewer, gray is the middle"),
    (SpriteChannel::Motion, "Motion", "Motion to the next frame: right in red, down in green, gray is still"),
];

/// Flipbook and its light. Not part of the preset.
#[derive(Clone, Debug, PartialEq)]
pub struct SpriteView {
    pub channel: SpriteChannel,
    /// Frame; a fraction blends two frames.
    pub frame: f32,
    pub is_playing: bool,
    /// Frames per second.
    pub rate: f32,
    /// Direction that the light comes from.
    pub light: Angles,
    /// The light rotates.
    pub is_turning: bool,
}

impl Default for SpriteView {
    fn default() -> Self {
        let light = Angles { azimuth: -40.0, elevation: 35.0 };
        Self { channel: SpriteChannel::Lit, frame: 0.0, is_playing: true, rate: 12.0, light, is_turning: false }
    }
}

/// Duration of one turn of the light, seconds.
const TURN_SECONDS: f32 = 5.0;
/// Longest time that one frame of the window may advance, seconds.
const MAX_STEP: f32 = 0.1;

impl SpriteView {
    /// Returns true if the flipbook plays or the light rotates.
    pub fn is_moving(&self) -> bool {
        self.is_playing || self.is_turning
    }

    /// Advances by the elapsed seconds.
    pub fn advance(&mut self, sprite: &Sprite, seconds: f32) {
        let seconds = seconds.clamp(0.0, MAX_STEP);
        // A paused frame number stays, even while a coarse sprite has fewer frames.
        if self.is_playing {
            self.frame = (self.frame + seconds * self.rate).rem_euclid(sprite.frame_count() as f32);
        }
        if self.is_turning {
            self.turn_to(self.light.azimuth + 360.0 * seconds / TURN_SECONDS);
        }
    }

    /// Sets the azimuth of the light, wrapped to -180 to 180 degrees.
    pub fn turn_to(&mut self, azimuth: f32) {
        self.light.azimuth = (azimuth + 180.0).rem_euclid(360.0) - 180.0;
    }
}
