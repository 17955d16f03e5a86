//! Loop, or a flipbook that plays once.

use haze_core::settings::choice;

use super::answer::Answer;
use super::small_frames::SmallFrames;

choice! {
    /// Order in which frames are played.
    Playback {
        /// The first frame follows the last.
        #[default]
        Loop = "loop",
        /// The smoke ends with the last frame.
        Once = "once",
    }
}

/// Seam of a loop, as a multiple of the difference between neighbors, above which it is visible; as `haze sprite check`.
const MAX_SEAM: f32 = 1.6;

/// Finds the playback: the first frame of a loop differs from the last as neighbors do.
pub(super) fn find_playback(smoke: &SmallFrames) -> Answer<Playback> {
    let count = smoke.frames.len() as u32;
    if count < 3 {
        return Answer::found(Playback::Loop, 0.0);
    }
    let apart = |a, b| smoke.difference(a, b).sqrt();
    let mean = (1..count).map(|frame| apart(frame - 1, frame)).sum::<f32>() / (count - 1) as f32;
    let ratio = apart(count - 1, 0) / mean.max(1.0e-6);
    let playback = if ratio > MAX_SEAM { Playback::Once } else { Playback::Loop };
    Answer::found(playback, (ratio / MAX_SEAM).max(1.0e-3).log2().abs() * 1.5)
}
