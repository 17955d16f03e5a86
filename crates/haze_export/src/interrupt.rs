//! Signals. Requests to stop during long work, by Ctrl-C, SIGTERM or SIGHUP: the first one stops the work at a point where
//! all files are complete, a second one ends the program. A write beyond the limit of file sizes is an error of the write.

use std::io;
use std::sync::atomic::{AtomicI32, Ordering};

use haze_core::error::{AssetError, Error};

/// Number of the signal that came; 0 for none.
static SIGNAL: AtomicI32 = AtomicI32::new(0);

const SIGHUP: i32 = 1;
#[cfg(unix)]
const SIGINT: i32 = 2;
const SIGTERM: i32 = 15;

/// Returns true if a stop was requested since [`catch`].
pub fn is_requested() -> bool {
    SIGNAL.load(Ordering::Relaxed) != 0
}

/// Stops work if that was requested. `work` and `outcome` are named in the error.
///
/// # Errors
/// [`AssetError::Io`] with the name of the signal.
pub fn check(work: &str, outcome: &str) -> Result<(), Error> {
    let signal = match SIGNAL.load(Ordering::Relaxed) {
        0 => return Ok(()),
        SIGHUP => "SIGHUP",
        SIGTERM => "SIGTERM",
        _ => "Ctrl-C",
    };
    let reason = format!("stopped by {signal}; {outcome}");
    Err(Error::from(AssetError::Io { path: work.into(), error: io::Error::new(io::ErrorKind::Interrupted, reason) }))
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
    const DEFAULT: usize = 0;
    extern "C" fn note(number: i32) {
        SIGNAL.store(number, Ordering::Relaxed);
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
