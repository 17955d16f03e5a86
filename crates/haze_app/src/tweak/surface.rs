//! What to do when there is nothing to draw into: the window was resized, is covered, or has no size.

use std::sync::{Arc, Mutex, PoisonError};

use eframe::egui_wgpu::{SurfaceErrorAction, WgpuConfiguration};
use eframe::wgpu::CurrentSurfaceTexture;

use super::platform::clock::{Duration, Instant, sleep};

/// Least time from one answer to the next.
const PACE: Duration = Duration::from_millis(16);

type Answer = dyn Fn(&CurrentSurfaceTexture) -> SurfaceErrorAction + Send + Sync;

/// As egui answers, which tries again at once; but one that stays so is not tried faster than a screen would show it.
pub fn paced() -> Arc<Answer> {
    let usual = WgpuConfiguration::default().on_surface_status;
    let last = Mutex::new(None);
    Arc::new(move |status| {
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        let passed = last.map(|last: Instant| last.elapsed());
        sleep(passed.map_or(Duration::ZERO, |passed| PACE.saturating_sub(passed)));
        *last = Some(Instant::now());
        match status {
            // A frame that was late is wanted still: this asks for another.
            CurrentSurfaceTexture::Timeout => SurfaceErrorAction::Reconfigure,
            status => usual(status),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_that_stays_lost_is_not_asked_for_all_the_time() {
        let (answer, start) = (paced(), Instant::now());
        for _ in 0..5 {
            assert!(matches!(answer(&CurrentSurfaceTexture::Lost), SurfaceErrorAction::RecreateSurface));
            assert!(matches!(answer(&CurrentSurfaceTexture::Outdated), SurfaceErrorAction::Reconfigure));
            assert!(matches!(answer(&CurrentSurfaceTexture::Occluded), SurfaceErrorAction::SkipFrame));
        }
        assert!(matches!(answer(&CurrentSurfaceTexture::Timeout), SurfaceErrorAction::Reconfigure));
        assert!(start.elapsed() >= 14 * PACE);
    }
}
