//! Meaning of white in a depth map.

use haze_core::settings::choice;

use super::super::height::{dome_heights, map_pixels};
use super::answer::Answer;
use super::small_frames::SmallFrames;

choice! {
    /// Meaning of white in a depth map.
    DepthWhite {
        /// White is near to the viewer.
        #[default]
        Near = "near",
        /// White is far.
        Far = "far",
    }
}

/// Finds the meaning of white: the middle of a puff is nearer than its rim.
pub(super) fn find_white(depth: &SmallFrames, amount: &SmallFrames) -> Answer<DepthWhite> {
    let [mut n, mut x, mut y, mut xx, mut yy, mut xy] = [1.0e-6_f32; 6];
    for (depth, amount) in depth.frames.iter().zip(&amount.frames).step_by(depth.frames.len().div_ceil(12).max(1)) {
        let heights = dome_heights(&map_pixels(amount.size, |at| amount.load(at.as_ivec2()).w));
        let texels = depth.texels.iter().zip(&heights.texels).zip(&amount.texels);
        for ((depth, height), _) in texels.filter(|(_, amount)| amount.w > 0.2) {
            n += 1.0;
            x += height;
            y += depth.x;
            xx += height * height;
            yy += depth.x * depth.x;
            xy += height * depth.x;
        }
    }
    let covariance = xy / n - x * y / (n * n);
    let spread = ((xx / n - (x / n).powi(2)) * (yy / n - (y / n).powi(2))).max(1.0e-12).sqrt();
    let correlation = covariance / spread;
    let white = if correlation < 0.0 { DepthWhite::Far } else { DepthWhite::Near };
    Answer::found(white, correlation.abs())
}
