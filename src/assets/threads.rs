//! Work that is shared among the processors.

use std::sync::{LazyLock, Mutex, PoisonError};

/// Processors that there are for this program. Asked once: on Linux the answer is in several files.
pub fn threads() -> usize {
    static THREADS: LazyLock<usize> = LazyLock::new(|| std::thread::available_parallelism().map_or(1, usize::from));
    *THREADS
}

/// Calls `f` once for every item. Items are begun in order.
pub fn on_all_processors<T>(items: impl Iterator<Item = T> + Send, f: impl Fn(T) + Sync) {
    let items = Mutex::new(items);
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || {
        while let Some(item) = next() {
            f(item);
        }
    };
    std::thread::scope(|scope| {
        // This thread works as well; it does what is left where no other is to be had.
        for _ in 1..threads() {
            if std::thread::Builder::new().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
}
