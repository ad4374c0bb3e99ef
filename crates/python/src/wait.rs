//! Work that takes long, beside an interpreter that goes on.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
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
/// asked to stop, and the exception is returned when it has.
pub(crate) fn wait<T: Send, M: Send>(
    py: Python<'_>,
    mut hear: impl FnMut(Python<'_>, M) -> PyResult<()> + Send,
    work: impl FnOnce(&Stop, &Sender<M>) -> T + Send,
) -> PyResult<T> {
    let stop = Stop::default();
    let (sender, receiver) = channel();
    let stop = &stop;
    let (done, raised) = py.detach(move || {
        std::thread::scope(|scope| {
            let worker = scope.spawn(move || work(stop, &sender));
            let mut raised = None;
            loop {
                let heard = match receiver.recv_timeout(POLL) {
                    Ok(message) => Python::attach(|py| hear(py, message)),
                    Err(RecvTimeoutError::Timeout) => Python::attach(check_signals),
                    // The worker is done, and its end of the channel is gone.
                    Err(RecvTimeoutError::Disconnected) => break,
                };
                if let Err(error) = heard {
                    stop.set();
                    raised.get_or_insert(error);
                }
            }
            (worker.join(), raised)
        })
    });
    match (done, raised) {
        (_, Some(error)) => Err(error),
        (Ok(value), None) => Ok(value),
        (Err(_), None) => {
            let message = "internal error of the renderer: please report it";
            Err(pyo3::exceptions::PyRuntimeError::new_err(message))
        }
    }
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
