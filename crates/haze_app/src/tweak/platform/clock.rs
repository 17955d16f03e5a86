//! Clock and sleep.

pub use std::time::{Duration, Instant};

/// Returns the present time.
pub fn now() -> Instant {
    Instant::now()
}

/// Blocks the thread.
pub fn sleep(time: Duration) {
    std::thread::sleep(time);
}
