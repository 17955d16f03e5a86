//! Time.

pub use std::thread::sleep;
pub use std::time::{Duration, Instant};
