//! Panics of image decoders of other crates.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

thread_local! {
    static IS_DECODING: Cell<bool> = const { Cell::new(false) };
}

/// True while this thread runs an image decoder whose panics become errors. A panic hook can use it to print nothing for
/// such a panic.
pub fn is_decoding() -> bool {
    IS_DECODING.get()
}

/// Runs a decoder; `None` if it panicked. Has no effect if the program is built with `panic = "abort"`.
///
/// Only for calls into a decoder: a panic in haze's own code is a mistake that must not look like a damaged file.
pub fn catch_decoder_panic<T>(decode: impl FnOnce() -> T) -> Option<T> {
    let before = IS_DECODING.replace(true);
    // Everything that the decoder has touched is dropped.
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    IS_DECODING.set(before);
    decoded.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_while_decoding_is_caught_and_marked() {
        assert!(catch_decoder_panic(is_decoding).unwrap() && !is_decoding());
        assert!(catch_decoder_panic(|| -> u8 { panic!("for a test") }).is_none());
        assert!(!is_decoding());
    }
}
