//! Validation by wgpu's error scopes, without calling the host's error handler.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Returns what `create` creates, or the last line of wgpu's error message: the line that names the cause.
///
/// In a browser, errors arrive asynchronously. There this always returns `Ok`, and the host's error handler receives
/// the errors.
pub(crate) fn with_error_scopes<T>(device: &wgpu::Device, create: impl FnOnce() -> T) -> Result<T, String> {
    if cfg!(target_arch = "wasm32") {
        return Ok(create());
    }
    // Errors of the driver's own compiler are internal errors.
    let scopes = [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::Validation].map(|kind| device.push_error_scope(kind));
    let created = create();
    // Error scopes are closed in reverse order.
    let errors = scopes.into_iter().rev().filter_map(|scope| poll_once(scope.pop()).flatten());
    match errors.reduce(|first, _| first) {
        Some(error) => {
            let text = error.to_string();
            let last = text.lines().map(str::trim).rfind(|line| !line.is_empty());
            Err(last.unwrap_or("not valid").to_owned())
        }
        None => Ok(created),
    }
}

/// Returns the future's output if it is ready at once; in a browser it is not: `None`.
pub(crate) fn poll_once<T>(future: impl Future<Output = T>) -> Option<T> {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(answer) => Some(answer),
        Poll::Pending => None,
    }
}
