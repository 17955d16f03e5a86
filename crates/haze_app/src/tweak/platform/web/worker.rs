//! Work that is too long for a frame. A page has no threads: each job runs between two frames, and the page stands still
//! meanwhile.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::io;
use std::rc::Rc;

/// Runs jobs in order, one in a frame. Dropping it cancels all jobs.
pub struct Worker<T> {
    queue: RefCell<VecDeque<(Ticket, Job<T>)>>,
    wake: Box<dyn Fn()>,
    /// A frame was shown since the next job was first seen, so that it could tell about the work.
    is_announced: Cell<bool>,
}

type Job<T> = Box<dyn FnOnce(&Ticket) -> T>;

/// Cancellation flag of a job. Clones share the flag.
#[derive(Clone, Debug, Default)]
pub struct Ticket(Rc<Cell<bool>>);

impl Ticket {
    /// Cancels the job: it is not started.
    pub fn cancel(&self) {
        self.0.set(true);
    }

    /// Returns true if the job is cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.get()
    }
}

impl<T: 'static> Worker<T> {
    /// `wake` is called while jobs wait.
    ///
    /// # Errors
    /// None; a thread of the system has some.
    pub fn new(_: &str, wake: impl Fn() + 'static) -> io::Result<Self> {
        Ok(Self { queue: RefCell::default(), wake: Box::new(wake), is_announced: Cell::new(false) })
    }

    /// Appends a job to the queue.
    pub fn submit(&self, job: impl FnOnce(&Ticket) -> T + 'static) -> Ticket {
        let ticket = Ticket::default();
        self.queue.borrow_mut().push_back((ticket.clone(), Box::new(job)));
        (self.wake)();
        ticket
    }

    /// Runs the next job, one frame after it was first seen, and returns its result. The inner `None` is that of a thread
    /// that panicked.
    pub fn poll(&self) -> Option<Option<T>> {
        self.queue.borrow_mut().retain(|(ticket, _)| !ticket.is_cancelled());
        if self.queue.borrow().is_empty() {
            return None;
        }
        (self.wake)();
        if !self.is_announced.replace(true) {
            return None;
        }
        self.is_announced.set(false);
        let (ticket, job) = self.queue.borrow_mut().pop_front()?;
        Some(Some(job(&ticket)))
    }

    /// Returns true while a job waits.
    pub fn is_busy(&self) -> bool {
        self.queue.borrow().iter().any(|(ticket, _)| !ticket.is_cancelled())
    }
}
