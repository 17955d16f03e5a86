//! View state of tracks: the open list, the selected track, copied keyframes. It is not part of the preset.

use haze_preset::Keyframe;

/// View state of the list of tracks.
#[derive(Clone, Debug, Default)]
pub struct TrackView {
    /// The list is closed, although there are tracks.
    pub is_closed: bool,
    /// Setting of the selected track.
    pub selected: Option<String>,
    pub copied: Vec<Keyframe>,
}

impl TrackView {
    /// Selects the track of a setting, and opens the list.
    pub fn select(&mut self, setting: &str) {
        self.selected = Some(setting.into());
        self.is_closed = false;
    }
}
