//! Work that is too long for a frame. A page has no threads: a short job runs between two frames, an asynchronous one in
//! many parts, and a portable one in a web worker.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::io;
use std::rc::Rc;

use wasm_bindgen_futures::spawn_local;

use super::web_job;
use crate::platform::portable_job::PortableJob;

/// Runs jobs in order. Dropping it cancels all jobs.
pub struct Worker<T> {
    queue: RefCell<VecDeque<(Ticket, Job<T>)>>,
    running: RefCell<Option<Running<T>>>,
    wake: Rc<dyn Fn()>,
    /// A frame was shown since the next job was first seen, so that it could tell about the work.
    is_announced: Cell<bool>,
}

enum Job<T> {
    /// Runs between two frames.
    Short(Box<dyn FnOnce(&Ticket) -> T>),
    /// Starts and returns at once; the result comes to the callback. The value returned keeps the job alive.
    Long(Box<dyn FnOnce(Ticket, Done<T>) -> Box<dyn Any>>),
}

/// Callback for a result; `None` is that of a job that has failed.
type Done<T> = Box<dyn FnOnce(Option<T>)>;

/// A long job.
struct Running<T> {
    ticket: Ticket,
    /// The outer `None`: not finished.
    result: Rc<RefCell<Option<Option<T>>>>,
    _alive: Box<dyn Any>,
}

/// Cancellation flag of a job. Clones share the flag.
#[derive(Clone, Debug, Default)]
pub struct Ticket(Rc<Cell<bool>>);

impl Ticket {
    /// Cancels the job: it is not started, or stops at its next check, and its result is dropped.
    pub fn cancel(&self) {
        self.0.set(true);
    }

    /// Returns true if the job is cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.get()
    }
}

impl<T: 'static> Worker<T> {
    /// `wake` is called while jobs wait, and when a long one is finished.
    ///
    /// # Errors
    /// None; a thread of the system has some.
    pub fn new(_: &str, wake: impl Fn() + 'static) -> io::Result<Self> {
        Ok(Self {
            queue: RefCell::default(),
            running: RefCell::default(),
            wake: Rc::new(wake),
            is_announced: Cell::default(),
        })
    }

    /// Appends a short job to the queue.
    pub fn submit(&self, job: impl FnOnce(&Ticket) -> T + 'static) -> Ticket {
        self.push(Job::Short(Box::new(job)))
    }

    /// Appends a job that waits now and then.
    pub fn submit_async<F: Future<Output = T>>(&self, job: impl FnOnce(Ticket) -> F + 'static) -> Ticket {
        self.push(Job::Long(Box::new(|ticket, done| {
            spawn_local(async move { done(Some(job(ticket).await)) });
            Box::new(())
        })))
    }

    /// Appends a job for a web worker. `progress` gets the number of finished steps and returns false to stop; `finish`
    /// gets the output.
    pub fn submit_portable<J: PortableJob>(
        &self,
        job: J,
        progress: impl Fn(u32) -> bool + 'static,
        finish: impl FnOnce(J::Output) -> T + 'static,
    ) -> Ticket {
        self.push(Job::Long(Box::new(move |ticket: Ticket, done| {
            let go_on = move |steps| progress(steps) && !ticket.is_cancelled();
            Box::new(web_job::start(&job, go_on, |output| done(output.map(finish))))
        })))
    }

    fn push(&self, job: Job<T>) -> Ticket {
        let ticket = Ticket::default();
        self.queue.borrow_mut().push_back((ticket.clone(), job));
        (self.wake)();
        ticket
    }

    /// Returns the result of the running job, or runs the next one, one frame after it was first seen. The inner `None` is
    /// that of a job that has failed.
    pub fn poll(&self) -> Option<Option<T>> {
        self.queue.borrow_mut().retain(|(ticket, _)| !ticket.is_cancelled());
        let mut running = self.running.borrow_mut();
        running.take_if(|running| running.ticket.is_cancelled());
        if let Some(long) = &*running {
            let result = long.result.take()?;
            *running = None;
            return Some(result);
        }
        if self.queue.borrow().is_empty() {
            return None;
        }
        (self.wake)();
        if !self.is_announced.replace(true) {
            return None;
        }
        self.is_announced.set(false);
        let (ticket, job) = self.queue.borrow_mut().pop_front()?;
        match job {
            Job::Short(job) => Some(Some(job(&ticket))),
            Job::Long(start) => {
                let result = Rc::new(RefCell::new(None));
                let wake = Rc::clone(&self.wake);
                let to = Rc::clone(&result);
                let done = Box::new(move |found| {
                    to.replace(Some(found));
                    wake();
                });
                let alive = start(ticket.clone(), done);
                *running = Some(Running { ticket, result, _alive: alive });
                None
            }
        }
    }

    /// Returns true while a job runs or waits.
    pub fn is_busy(&self) -> bool {
        let is_wanted = |running: &Running<T>| !running.ticket.is_cancelled();
        self.running.borrow().as_ref().is_some_and(is_wanted)
            || self.queue.borrow().iter().any(|(ticket, _)| !ticket.is_cancelled())
    }
}

impl<T> Worker<T> {
    /// Cancels all jobs.
    pub fn cancel_all(&self) {
        self.queue.borrow_mut().clear();
        if let Some(running) = self.running.borrow().as_ref() {
            running.ticket.cancel();
        }
    }
}

impl<T> Drop for Worker<T> {
    fn drop(&mut self) {
        self.cancel_all();
    }
}
