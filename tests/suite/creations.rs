//! Counts what is created on a device, dropped or not. wgpu has counters of what is alive only, but logs every creation by name.

use std::cell::Cell;
use std::sync::Once;

thread_local! {
    /// Creations on this thread, while they are counted: other tests run beside this one.
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

/// "Device::create_buffer -> …", "Texture::create_view(…) -> …". Encoders are the host's, one a frame.
fn is_creation(message: &str) -> bool {
    let call = message.split(['(', ' ']).next().unwrap_or_default();
    call.contains("::create_") && !call.ends_with("create_command_encoder")
}

/// Creations by this thread in `run`.
pub fn count(run: impl FnOnce()) -> usize {
    static LOGGER: Once = Once::new();
    LOGGER.call_once(|| log::set_logger(&Counter).unwrap());
    log::set_max_level(log::LevelFilter::Trace);
    CREATED.set(Some(0));
    run();
    CREATED.take().unwrap()
}
