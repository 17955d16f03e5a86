//! Clock and sleep.

pub use std::thread::sleep;
pub use std::time::{Duration, Instant};
