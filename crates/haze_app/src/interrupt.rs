//! Ctrl-C while much is being made: it stops where the files are whole. A second one ends the program.

use std::sync::atomic::{AtomicBool, Ordering};

static IS_ASKED: AtomicBool = AtomicBool::new(false);

/// Whether it has been pressed since [`catch`].
pub fn is_asked() -> bool {
    IS_ASKED.load(Ordering::Relaxed)
}

/// From now on it ends the program no more, but is noted.
#[cfg(unix)]
#[allow(unsafe_code, reason = "there is no other way to hear of a signal")]
pub fn catch() {
    const SIGINT: i32 = 2;
    const DEFAULT: usize = 0;
    unsafe extern "C" {
        fn signal(number: i32, handler: usize) -> usize;
    }
    extern "C" fn note(number: i32) {
        IS_ASKED.store(true, Ordering::Relaxed);
        // SAFETY: a handler may call it.
        unsafe { signal(number, DEFAULT) };
    }
    let note: extern "C" fn(i32) = note;
    // SAFETY: the handler only writes an atomic, and calls what a handler may.
    unsafe { signal(SIGINT, note as usize) };
}

/// Elsewhere it ends the program; a file is written whole or not at all.
#[cfg(not(unix))]
pub fn catch() {}
