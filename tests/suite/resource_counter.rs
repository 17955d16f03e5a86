//! Counts the resources that are created on a device, including those that are dropped at once. wgpu's own counters
//! cover live resources only, but wgpu logs every creation by function name.

use std::cell::Cell;
use std::sync::Once;

thread_local! {
    /// Creations on this thread while counting is active. Per thread, because other tests run in parallel.
    static CREATED: Cell<Option<usize>> = const { Cell::new(None) };
}

struct Counter;

impl log::Log for Counter {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        CREATED.get().is_some()
    }
    fn log(&self, record: &log::Record<'_>) {
        if let Some(count) = CREATED.get()
            && is_creation(&record.args().to_string())
        {
            CREATED.set(Some(count + 1));
        }
    }
    fn flush(&self) {}
}

/// Returns true if a log message reports a creation: "Device::create_buffer -> …", "Texture::create_view(…) -> …".
/// Command encoders do not count, because the host creates one per frame, nor does staging memory: wgpu allocates it for
/// every upload, and logs it for some.
fn is_creation(message: &str) -> bool {
    let call = message.split(['(', ' ']).next().unwrap_or_default();
    let in_every_frame = ["create_command_encoder", "create_staging_buffer"];
    call.contains("::create_") && !in_every_frame.iter().any(|name| call.ends_with(name))
}

/// Returns the number of resources that this thread creates in `run`.
pub fn count(run: impl FnOnce()) -> usize {
    static LOGGER: Once = Once::new();
    LOGGER.call_once(|| log::set_logger(&Counter).unwrap());
    log::set_max_level(log::LevelFilter::Trace);
    CREATED.set(Some(0));
    run();
    CREATED.take().unwrap()
}
