//! Reaction to a surface that cannot be drawn to, because the window was resized, is hidden, or has no size.

use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui_wgpu::{SurfaceErrorAction, WgpuConfiguration};
use eframe::wgpu::CurrentSurfaceTexture;

use crate::platform::clock::{self, Duration, Instant};

/// Least time between two answers.
const MIN_FRAME_INTERVAL: Duration = Duration::from_millis(16);

type Answer = dyn Fn(&CurrentSurfaceTexture) -> SurfaceErrorAction + Send + Sync;

/// Returns the handler of egui, which retries at once, slowed down to the rate of a screen while the surface stays
/// unavailable.
pub fn paced_surface_handler() -> Arc<Answer> {
    let usual = WgpuConfiguration::default().on_surface_status;
    let last = Mutex::new(None);
    Arc::new(move |status| {
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        let passed = last.map(|last: Instant| last.elapsed());
        clock::sleep(passed.map_or(Duration::ZERO, |passed| MIN_FRAME_INTERVAL.saturating_sub(passed)));
        *last = Some(clock::now());
        match status {
            // The frame is still needed, so this requests another.
            CurrentSurfaceTexture::Timeout => SurfaceErrorAction::Reconfigure,
            status => usual(status),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn retries_for_a_lost_surface_are_limited_in_rate() {
        let answer = paced_surface_handler();
        let start = Instant::now();
        for _ in 0..5 {
            assert!(matches!(answer(&CurrentSurfaceTexture::Lost), SurfaceErrorAction::RecreateSurface));
            assert!(matches!(answer(&CurrentSurfaceTexture::Outdated), SurfaceErrorAction::Reconfigure));
            assert!(matches!(answer(&CurrentSurfaceTexture::Occluded), SurfaceErrorAction::SkipFrame));
        }
        assert!(matches!(answer(&CurrentSurfaceTexture::Timeout), SurfaceErrorAction::Reconfigure));
        assert!(start.elapsed() >= 14 * MIN_FRAME_INTERVAL);
    }
}
