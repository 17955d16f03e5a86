//! Parallel iteration on all processors.

use std::sync::{LazyLock, Mutex, PoisonError};

/// Returns the number of processors available to this process. Cached: on Linux the query reads several files.
pub fn thread_count() -> usize {
    static THREADS: LazyLock<usize> = LazyLock::new(|| std::thread::available_parallelism().map_or(1, usize::from));
    *THREADS
}

/// Calls `f` once for every item, in parallel. Items start in order.
pub fn parallel_for_each<T>(items: impl Iterator<Item = T> + Send, f: impl Fn(T) + Sync) {
    let items = Mutex::new(items);
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = || {
        while let Some(item) = next() {
            f(item);
        }
    };
    std::thread::scope(|scope| {
        // The calling thread works too, so all items are processed even if no thread can be spawned.
        for _ in 1..thread_count() {
            if std::thread::Builder::new().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
}
