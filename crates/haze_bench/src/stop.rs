//! Requests to stop a run.

use haze_core::error::Error;
use haze_export::interrupt;

/// Ends the run if that was requested.
///
/// # Errors
/// [`AssetError::Io`](haze_core::error::AssetError::Io) with the name of the signal.
pub fn check_stop() -> Result<(), Error> {
    interrupt::check("haze bench", "the report is partial")
}
