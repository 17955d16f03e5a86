//! Worker thread for work that is too long for a frame.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::{io, thread};

use super::portable_job::PortableJob;

/// Runs jobs in order on a thread of its own. Dropping it cancels all jobs.
pub struct Worker<T> {
    shared: Arc<Shared<T>>,
}

/// Cancellation flag of a job. Clones share the flag.
#[derive(Clone, Debug, Default)]
pub struct Ticket(Arc<AtomicBool>);

impl Ticket {
    /// Cancels the job: it is not started, or stops at its next check, and its result is dropped.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns true if the job is cancelled. Long jobs should check it.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Job and its result; `None` if it panicked.
type FinishedJob<T> = (Ticket, Option<T>);

type Job<T> = Box<dyn FnOnce(&Ticket) -> T + Send>;

struct Shared<T> {
    state: Mutex<State<T>>,
    has_changed: Condvar,
}

struct State<T> {
    queue: VecDeque<(Ticket, Job<T>)>,
    running: Option<Ticket>,
    done: VecDeque<FinishedJob<T>>,
    is_over: bool,
}

impl<T> State<T> {
    fn cancel_all(&mut self) {
        self.running.iter().chain(self.queue.iter().map(|(ticket, _)| ticket)).for_each(Ticket::cancel);
        self.queue.clear();
    }
}

impl<T> Shared<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Send + 'static> Worker<T> {
    /// Starts the thread. `wake` is called from it after each job.
    pub fn new(name: &str, wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let state = State { queue: VecDeque::new(), running: None, done: VecDeque::new(), is_over: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), has_changed: Condvar::new() });
        let work = Arc::clone(&shared);
        thread::Builder::new().name(name.into()).spawn(move || {
            while let Some((ticket, job)) = work.next() {
                let result = catch_unwind(AssertUnwindSafe(|| job(&ticket))).ok();
                work.finish(ticket, result);
                wake();
            }
        })?;
        Ok(Self { shared })
    }

    /// Appends a job to the queue.
    pub fn submit(&self, job: impl FnOnce(&Ticket) -> T + Send + 'static) -> Ticket {
        let ticket = Ticket::default();
        self.shared.lock().queue.push_back((ticket.clone(), Box::new(job)));
        self.shared.has_changed.notify_all();
        ticket
    }

    /// Appends a job that waits now and then.
    pub fn submit_async<F: Future<Output = T>>(&self, job: impl FnOnce(Ticket) -> F + Send + 'static) -> Ticket {
        self.submit(|ticket| pollster::block_on(job(ticket.clone())))
    }

    /// Appends a job that a page runs in a web worker. `progress` gets the number of finished steps and returns false to
    /// stop; `finish` gets the output.
    pub fn submit_portable<J: PortableJob>(
        &self,
        job: J,
        progress: impl Fn(u32) -> bool + Send + 'static,
        finish: impl FnOnce(J::Output) -> T + Send + 'static,
    ) -> Ticket {
        self.submit(move |ticket| finish(job.run(&|steps| progress(steps) && !ticket.is_cancelled())))
    }

    /// Returns the oldest result that has not been taken yet; the inner `None` means that the job panicked.
    pub fn poll(&self) -> Option<Option<T>> {
        let mut state = self.shared.lock();
        while let Some((ticket, result)) = state.done.pop_front() {
            if !ticket.is_cancelled() {
                return Some(result);
            }
        }
        None
    }

    /// Cancels all jobs and drops results that have not been taken.
    pub fn cancel_all(&self) {
        let mut state = self.shared.lock();
        state.cancel_all();
        state.done.clear();
    }

    /// Returns true while a job runs or waits.
    pub fn is_busy(&self) -> bool {
        let state = self.shared.lock();
        state.running.iter().chain(state.queue.iter().map(|(ticket, _)| ticket)).any(|ticket| !ticket.is_cancelled())
    }
}

impl<T> Shared<T> {
    /// Waits for a job; `None` when the worker was dropped.
    fn next(&self) -> Option<(Ticket, Job<T>)> {
        let mut state = self.lock();
        while !state.is_over {
            match state.queue.pop_front() {
                Some((ticket, _)) if ticket.is_cancelled() => {}
                Some((ticket, job)) => {
                    state.running = Some(ticket.clone());
                    return Some((ticket, job));
                }
                None => state = self.has_changed.wait(state).unwrap_or_else(PoisonError::into_inner),
            }
        }
        None
    }

    fn finish(&self, ticket: Ticket, result: Option<T>) {
        let mut state = self.lock();
        state.running = None;
        if !ticket.is_cancelled() {
            state.done.push_back((ticket, result));
        }
    }
}

impl<T> Drop for Worker<T> {
    /// Does not wait for the thread: a job that does not check its ticket would delay the end of the program.
    fn drop(&mut self) {
        let mut state = self.shared.lock();
        state.is_over = true;
        state.cancel_all();
        self.shared.has_changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    const LONG: Duration = Duration::from_secs(20);

    fn worker<T: Send + 'static>() -> (Worker<T>, mpsc::Receiver<()>) {
        let (wake, woken) = mpsc::channel();
        let wake = move || {
            let _ = wake.send(());
        };
        (Worker::new("test", wake).unwrap(), woken)
    }

    #[test]
    fn jobs_run_in_order_and_a_panic_ends_only_its_own_job() {
        let (worker, woken) = worker();
        for number in 0..4 {
            worker.submit(move |_| if number == 1 { panic!("a job that panics, on purpose") } else { number });
        }
        (0..4).for_each(|_| woken.recv_timeout(LONG).unwrap());
        let done: Vec<_> = std::iter::from_fn(|| worker.poll()).collect();
        assert_eq!(done, [Some(0), None, Some(2), Some(3)]);
        assert!(!worker.is_busy());
    }

    #[test]
    fn a_cancelled_job_stops_without_a_result() {
        let (worker, woken) = worker();
        let (begin, begun) = mpsc::channel();
        let running = worker.submit(move |ticket| {
            begin.send(()).unwrap();
            while !ticket.is_cancelled() {
                thread::yield_now();
            }
            "stopped"
        });
        let queued = worker.submit(|_| "never begun");
        worker.submit(|_| "done");
        begun.recv_timeout(LONG).unwrap();
        queued.cancel();
        running.cancel();
        (0..2).for_each(|_| woken.recv_timeout(LONG).unwrap());
        assert_eq!((worker.poll(), worker.poll()), (Some(Some("done")), None));
    }

    #[test]
    fn nothing_comes_of_jobs_before_all_were_cancelled() {
        let (worker, woken) = worker();
        let (begin, begun) = mpsc::channel();
        worker.submit(|_| "not taken");
        woken.recv_timeout(LONG).unwrap();
        worker.submit(move |ticket| {
            begin.send(()).unwrap();
            while !ticket.is_cancelled() {
                thread::yield_now();
            }
            "running"
        });
        worker.submit(|_| "waiting");
        begun.recv_timeout(LONG).unwrap();
        worker.cancel_all();
        worker.submit(|_| "after");
        (0..2).for_each(|_| woken.recv_timeout(LONG).unwrap());
        assert_eq!((worker.poll(), worker.poll()), (Some(Some("after")), None));
    }

    #[test]
    fn dropping_the_worker_ends_its_thread() {
        let (over, is_over) = mpsc::channel::<()>();
        let worker = Worker::new("test", || {}).unwrap();
        worker.submit(move |ticket| {
            let _until_done = over;
            while !ticket.is_cancelled() {
                thread::yield_now();
            }
        });
        drop(worker);
        assert_eq!(is_over.recv_timeout(LONG), Err(mpsc::RecvTimeoutError::Disconnected));
    }
}
