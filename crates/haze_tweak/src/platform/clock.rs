//! Clock and sleep.

#[cfg(not(target_arch = "wasm32"))]
pub use std::time::{Duration, Instant};
#[cfg(target_arch = "wasm32")]
pub use web_time::{Duration, Instant};

/// Returns the present time.
pub fn now() -> Instant {
    Instant::now()
}

/// Blocks the thread; on a page it must not, and returns at once.
pub fn sleep(time: Duration) {
    if !super::IS_PAGE {
        std::thread::sleep(time);
    }
}
