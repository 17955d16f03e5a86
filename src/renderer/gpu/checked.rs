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
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let created = create();
    let answer = pin!(scope.pop()).poll(&mut Context::from_waker(Waker::noop()));
    match answer {
        Poll::Ready(Some(error)) => {
            let text = error.to_string();
            let last = text.lines().map(str::trim).rfind(|line| !line.is_empty());
            Err(last.unwrap_or("not valid").to_owned())
        }
        Poll::Ready(None) | Poll::Pending => Ok(created),
    }
}
