//! Requests to stop a run.

use haze::Error;
use haze_export::interrupt;

/// Ends the run if that was requested.
///
/// # Errors
/// [`Error::Io`] with the name of the signal.
pub fn check_stop() -> Result<(), Error> {
    interrupt::check("haze bench", "the report is partial")
}
