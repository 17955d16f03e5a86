//! Settings that change over time: tracks with keyframes and flicker.

mod animated_fields;
mod interpolation;
mod keyframe;
mod setting_names;
mod track;
mod validate_tracks;

pub(super) use animated_fields::AnimatedFields;
pub use keyframe::{Ease, KeyValue, Keyframe, MAX_TIME};
pub use track::{Flicker, MAX_KEYFRAMES, Track};
pub(super) use validate_tracks::validate_tracks;
