//! Work that takes long, beside an interpreter that goes on.

use bidir::driver::{Threads, stand_alone, start_pool};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;

/// How often the interpreter is asked whether a signal came.
const POLL: Duration = Duration::from_millis(50);

/// Whether work shall stop.
#[derive(Debug, Default)]
pub(crate) struct Stop(AtomicBool);

impl Stop {
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Does `work` in a thread of its own, while other threads of Python run.
///
/// This thread asks for signals meanwhile: only that of the interpreter is told of Ctrl-C. What
/// `work` sends is given to `hear` here. Where a signal raises an exception, or `hear` does, `work` is
/// asked to stop, and the exception is returned when it has. Where the system starts no thread, `work`
/// runs on this one, and signals and messages wait until it is done.
pub(crate) fn wait<T: Send, M: Send>(
    py: Python<'_>,
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
                    let raised = listen(&receiver, hear, stop);
                    return (worker.join(), raised);
                }
                Err(_) => run(sender),
            };
            (Ok(done), listen(&receiver, hear, stop))
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

/// Hears what is sent, until nothing more can be; asks for signals meanwhile. Returns the first exception.
fn listen<M: Send>(
    receiver: &Receiver<M>,
    mut hear: impl FnMut(Python<'_>, M) -> PyResult<()> + Send,
    stop: &Stop,
) -> Option<PyErr> {
    let mut raised = None;
    loop {
        let heard = match receiver.recv_timeout(POLL) {
            Ok(message) => Python::attach(|py| hear(py, message)),
            Err(RecvTimeoutError::Timeout) => Python::attach(check_signals),
            // The worker is done, and its end of the channel is gone.
            Err(RecvTimeoutError::Disconnected) => return raised,
        };
        if let Err(error) = heard {
            stop.set();
            raised.get_or_insert(error);
        }
    }
}

/// Does `work`, with its parallel iterators on the threads of the process, or on this one where the
/// system started none.
fn compute<T>(work: impl FnOnce() -> T) -> T {
    static IS_ALONE: OnceLock<bool> = OnceLock::new();
    let start = || start_pool(Threads::new(0)).is_some_and(|shortage| shortage.is_total());
    if *IS_ALONE.get_or_init(start) {
        stand_alone();
    }
    work()
}

/// Does `work` here, while other threads of Python run.
pub(crate) fn beside<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| compute(work))
}

/// Raises what a signal asks for; on other threads than the interpreter's it does nothing.
fn check_signals(py: Python<'_>) -> PyResult<()> {
    py.check_signals()
}

/// The same for work that tells nothing meanwhile.
pub(crate) fn wait_silently<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> T + Send,
) -> PyResult<T> {
    wait(py, |_, ()| Ok(()), |stop, _| work(stop))
}
