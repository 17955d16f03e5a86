//! Asking wgpu whether it takes something, without the host's error handler hearing of it.

use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Makes something and gives it back, or else the last line of what wgpu says against it: the one that names the fault.
///
/// In a browser the answer comes only later. There everything is taken to be right, and the host's error handler hears of what
/// is not.
pub(crate) fn checked<T>(device: &wgpu::Device, create: impl FnOnce() -> T) -> Result<T, String> {
    if cfg!(target_arch = "wasm32") {
        return Ok(create());
    }
    // What the driver's own compiler does not take is an internal error.
    let scopes = [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::Validation].map(|kind| device.push_error_scope(kind));
    let created = create();
    // The scope that was opened last is closed first.
    let errors = scopes.into_iter().rev().filter_map(|scope| answer(scope.pop()).flatten());
    match errors.reduce(|first, _| first) {
        Some(error) => {
            let text = error.to_string();
            let last = text.lines().map(str::trim).rfind(|line| !line.is_empty());
            Err(last.unwrap_or("not valid").to_owned())
        }
        None => Ok(created),
    }
}

/// What is known at once; `None` in a browser.
pub(crate) fn answer<T>(future: impl Future<Output = T>) -> Option<T> {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(answer) => Some(answer),
        Poll::Pending => None,
    }
}
