//! How a sprite is looked at.

use haze::sprite::Sprite;

use crate::tweak::angles::Angles;

/// What of a sprite is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    Lit,
    Normals,
    Amount,
    Depth,
    Motion,
}

/// All there is to show, its names, and what it is.
pub const SHOWN: [(Shown, &str, &str); 5] = [
    (Shown::Lit, "Lit", "Through the diffuse ramp of the system"),
    (Shown::Normals, "Normals", "As they are on the sheet: x in red, y up in green, z to the viewer in blue"),
    (Shown::Amount, "Amount", "White hides all"),
    (Shown::Depth, "Depth", "How far it stands out: white towards the viewer, grey in the middle"),
    (Shown::Motion, "Motion", "Where it goes until the next frame: to the right in red, down in green, grey stays"),
];

/// The flipbook and its light; no part of the preset.
#[derive(Clone, Debug, PartialEq)]
pub struct SpriteLook {
    pub shown: Shown,
    /// Fractional: between two frames is a share of both.
    pub frame: f32,
    pub is_playing: bool,
    /// Frames a second.
    pub rate: f32,
    /// Where light comes from.
    pub light: Angles,
    /// The light goes round.
    pub is_turning: bool,
}

impl Default for SpriteLook {
    fn default() -> Self {
        let light = Angles { azimuth: -40.0, elevation: 35.0 };
        Self { shown: Shown::Lit, frame: 0.0, is_playing: true, rate: 12.0, light, is_turning: false }
    }
}

/// Seconds of a turn of the light.
const TURN: f32 = 5.0;
/// Longest time that one frame of the window may take from the clock.
const LONGEST: f32 = 0.1;

impl SpriteLook {
    /// Something moves by itself.
    pub fn is_moving(&self) -> bool {
        self.is_playing || self.is_turning
    }

    /// Goes on by the seconds that have passed.
    pub fn advance(&mut self, sprite: &Sprite, seconds: f32) {
        let seconds = seconds.clamp(0.0, LONGEST);
        // Else it stays, also while a coarse sprite has fewer.
        if self.is_playing {
            self.frame = (self.frame + seconds * self.rate).rem_euclid(sprite.frame_count() as f32);
        }
        if self.is_turning {
            self.turn_to(self.light.azimuth + 360.0 * seconds / TURN);
        }
    }

    /// Sends the light round to an azimuth, degrees.
    pub fn turn_to(&mut self, azimuth: f32) {
        self.light.azimuth = (azimuth + 180.0).rem_euclid(360.0) - 180.0;
    }
}
