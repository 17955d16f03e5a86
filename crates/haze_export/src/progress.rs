//! Progress line of long work on stderr: only on a terminal, and erased when the work is done.

use std::io::{IsTerminal as _, Write};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Does the work, and shows `what` and the elapsed time. Work of less than a second shows nothing.
pub fn with_progress<T>(what: String, work: impl FnOnce() -> T) -> T {
    with_changing_progress(|| what.clone(), work)
}

/// The same, with a description that changes during the work.
pub fn with_changing_progress<T>(what: impl Fn() -> String + Send, work: impl FnOnce() -> T) -> T {
    let stderr = std::io::stderr();
    if stderr.is_terminal() { with_progress_on(stderr, what, Duration::from_secs(1), work) } else { work() }
}

fn with_progress_on<T>(
    mut out: impl Write + Send,
    what: impl Fn() -> String + Send,
    every: Duration,
    work: impl FnOnce() -> T,
) -> T {
    let (done, end) = channel::<()>();
    let tell = move || {
        let started = Instant::now();
        let mut erase = "";
        while end.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
            // A closed terminal does not stop the work.
            let _ = write!(out, "\r{}, {} s ", what(), started.elapsed().as_secs()).and_then(|()| out.flush());
            erase = "\r\x1b[K";
        }
        let _ = write!(out, "{erase}").and_then(|()| out.flush());
    };
    std::thread::scope(move |scope| {
        // Without a thread the work continues, but shows nothing.
        let _ = std::thread::Builder::new().spawn_scoped(scope, tell);
        let result = work();
        drop(done);
        result
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(every: Duration, work: Duration) -> String {
        let mut terminal = Vec::new();
        with_progress_on(&mut terminal, || "baking puff".into(), every, || std::thread::sleep(work));
        String::from_utf8(terminal).unwrap()
    }

    #[test]
    fn long_work_shows_a_progress_line_and_erases_it() {
        let text = shown(Duration::from_millis(1), Duration::from_millis(200));
        assert!(text.starts_with("\rbaking puff, 0 s ") && text.ends_with("\r\x1b[K"), "{text:?}");
        assert_eq!(shown(Duration::from_secs(60), Duration::ZERO), "");
    }

    #[test]
    fn a_closed_terminal_does_not_stop_the_work() {
        // A writer that is full.
        let full: &mut [u8] = &mut [];
        let work = || std::thread::sleep(Duration::from_millis(50));
        with_progress_on(full, || "baking".into(), Duration::from_millis(1), work);
    }
}
