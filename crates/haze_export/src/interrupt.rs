//! Signals. Requests to stop during long work, by Ctrl-C, SIGTERM or SIGHUP: the first one stops the work at a point where
//! all files are complete, a second one ends the program. A write beyond the limit of file sizes is an error of the write.

use std::sync::atomic::{AtomicBool, Ordering};

static IS_REQUESTED: AtomicBool = AtomicBool::new(false);

/// Returns true if a stop was requested since [`catch`].
pub fn is_requested() -> bool {
    IS_REQUESTED.load(Ordering::Relaxed)
}

#[cfg(unix)]
#[allow(unsafe_code, reason = "the standard library has no signal handlers")]
unsafe extern "C" {
    fn signal(number: i32, handler: usize) -> usize;
}

/// From now on a write beyond the limit of file sizes (`ulimit -f`) returns an error, instead of a signal that ends the
/// program and leaves a partial file.
#[cfg(unix)]
#[allow(unsafe_code, reason = "the standard library has no signal handlers")]
pub fn ignore_file_size_signal() {
    const SIGXFSZ: i32 = if cfg!(any(target_arch = "mips", target_arch = "mips64")) { 31 } else { 25 };
    const IGNORE: usize = 1;
    // SAFETY: no handler runs.
    unsafe { signal(SIGXFSZ, IGNORE) };
}

/// Other systems have no such signal.
#[cfg(not(unix))]
pub fn ignore_file_size_signal() {}

/// From now on the first request of each kind only sets a flag.
#[cfg(unix)]
#[allow(unsafe_code, reason = "the standard library has no signal handlers")]
pub fn catch() {
    const SIGHUP: i32 = 1;
    const SIGINT: i32 = 2;
    const SIGTERM: i32 = 15;
    const DEFAULT: usize = 0;
    extern "C" fn note(number: i32) {
        IS_REQUESTED.store(true, Ordering::Relaxed);
        // SAFETY: `signal` is async-signal-safe.
        unsafe { signal(number, DEFAULT) };
    }
    let note: extern "C" fn(i32) = note;
    for number in [SIGINT, SIGTERM, SIGHUP] {
        // SAFETY: the handler only writes an atomic and calls `signal`, both async-signal-safe.
        unsafe { signal(number, note as usize) };
    }
}

/// On other systems Ctrl-C ends the program; a file is written completely or not at all.
#[cfg(not(unix))]
pub fn catch() {}
