//! Long operations that leave the interpreter responsive.

use crate::error::of_file;
use bidir::driver::{Threads, stand_alone, start_pool};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// The interval between checks for signals.
const POLL: Duration = Duration::from_millis(50);

/// A flag that asks an operation to stop.
#[derive(Debug, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Returns the flag itself.
    pub(crate) fn flag(&self) -> &Arc<AtomicBool> {
        &self.0
    }

    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs `work` in a separate thread, while other Python threads run.
///
/// Meanwhile, this thread checks for signals, since only the interpreter's main thread receives Ctrl-C, and
/// passes the messages of `work` to `hear`. If a signal or `hear` raises an exception, `work` is asked to
/// stop, and the exception is returned after it has stopped. At `deadline`, `work` is asked to stop without
/// an exception. If the system cannot start a thread, `work` runs on this one, and signals and messages wait
/// until it ends.
pub(crate) fn wait<T: Send, M: Send>(
    py: Python<'_>,
    deadline: Option<Instant>,
    hear: impl FnMut(Python<'_>, M) -> PyResult<()> + Send,
    work: impl FnOnce(&Stop, &Sender<M>) -> T + Send,
) -> PyResult<T> {
    let (stop, work) = (&Stop::default(), &Mutex::new(Some(work)));
    let (sender, receiver) = channel();
    let run = move |sender: Sender<M>| {
        let work = work.lock().unwrap_or_else(PoisonError::into_inner).take();
        work.map(|work| compute(|| work(stop, &sender)))
    };
    let (done, raised) = py.detach(move || {
        thread::scope(|scope| {
            let in_thread = sender.clone();
            let worker = thread::Builder::new().spawn_scoped(scope, move || run(in_thread));
            let done = match worker {
                Ok(worker) => {
                    drop(sender);
                    let raised = listen(&receiver, hear, stop, deadline);
                    return (worker.join(), raised);
                }
                Err(_) => run(sender),
            };
            (Ok(done), listen(&receiver, hear, stop, deadline))
        })
    });
    match (done, raised) {
        (_, Some(error)) => Err(error),
        (Ok(Some(value)), None) => Ok(value),
        (_, None) => {
            let message = "internal error of the renderer: please report it";
            Err(pyo3::exceptions::PyRuntimeError::new_err(message))
        }
    }
}

/// Passes messages to `hear` until the channel closes, checks for signals, and sets `stop` at `deadline`. Returns the
/// first exception.
fn listen<M: Send>(
    receiver: &Receiver<M>,
    mut hear: impl FnMut(Python<'_>, M) -> PyResult<()> + Send,
    stop: &Stop,
    deadline: Option<Instant>,
) -> Option<PyErr> {
    let mut raised = None;
    loop {
        if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            stop.set();
        }
        let heard = match receiver.recv_timeout(POLL) {
            Ok(message) => Python::attach(|py| hear(py, message)),
            Err(RecvTimeoutError::Timeout) => Python::attach(check_signals),
            // The worker has ended and dropped its end of the channel.
            Err(RecvTimeoutError::Disconnected) => return raised,
        };
        if let Err(error) = heard {
            stop.set();
            raised.get_or_insert(error);
        }
    }
}

/// Runs `work`, with its parallel iterators on the process's thread pool, or on this thread if the system
/// started no other.
fn compute<T>(work: impl FnOnce() -> T) -> T {
    static IS_ALONE: OnceLock<bool> = OnceLock::new();
    let start = || start_pool(Threads::new(0)).is_some_and(|shortage| shortage.is_total());
    if *IS_ALONE.get_or_init(start) {
        stand_alone();
    }
    work()
}

/// Runs `work` on this thread, while other Python threads run.
pub(crate) fn beside<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| compute(work))
}

/// Runs `work` on files like [`beside`], and converts its error.
pub(crate) fn try_beside<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> formats::Result<T> + Send,
) -> PyResult<T> {
    beside(py, work).map_err(|error| of_file(py, &error))
}

/// Raises the exception of a pending signal; does nothing outside the interpreter's main thread.
fn check_signals(py: Python<'_>) -> PyResult<()> {
    py.check_signals()
}

/// Runs `work` like [`wait`], without messages.
pub(crate) fn wait_silently<T: Send>(
    py: Python<'_>,
    deadline: Option<Instant>,
    work: impl FnOnce(&Stop) -> T + Send,
) -> PyResult<T> {
    wait(py, deadline, |_, ()| Ok(()), |stop, _| work(stop))
}
