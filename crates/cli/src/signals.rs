//! Signals. The first Ctrl-C or SIGTERM interrupts the running work, and the command ends with the complete passes;
//! the second ends the command at once. SIGUSR1 requests that files are written.

use crate::exit::{Exit, Failure};
use bidir::driver::{Stop, stands_alone};
use signal_hook::consts::{SIGABRT, SIGINT, SIGTERM};
use signal_hook::flag;
use std::panic;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// The interval between two checks of the flag.
const GAP: Duration = Duration::from_millis(50);
/// The size of the stack of a thread that works instead of the main thread. Unit: bytes.
const STACK: usize = 8 << 20;

/// The signals that end a render, each with its exit.
const SIGNALS: [(i32, Exit); 2] = [(SIGINT, Exit::Interrupted), (SIGTERM, Exit::Terminated)];

/// The signals that have arrived.
#[derive(Debug)]
pub(crate) struct Signals {
    received: Arc<AtomicUsize>,
    write: Arc<AtomicBool>,
    /// True after the first signal, or after the time of an alarm.
    stop: Arc<AtomicBool>,
}

impl Signals {
    /// Installs the handlers; a second signal ends the process at once.
    pub(crate) fn watch() -> Result<Self, Failure> {
        let received = Arc::new(AtomicUsize::new(0));
        let again = Arc::new(AtomicBool::new(false));
        let stop = Arc::new(AtomicBool::new(false));
        for (signal, exit) in SIGNALS {
            // The order matters: `again` is still unset when the first signal arrives.
            flag::register_conditional_shutdown(signal, exit.code().into(), Arc::clone(&again))
                .and_then(|_| flag::register(signal, Arc::clone(&again)))
                .and_then(|_| flag::register_usize(signal, Arc::clone(&received), signal as usize))
                .and_then(|_| flag::register(signal, Arc::clone(&stop)))
                .map_err(unwatched)?;
        }
        let write = Arc::new(AtomicBool::new(false));
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&write)).map_err(unwatched)?;
        Ok(Self {
            received,
            write,
            stop,
        })
    }

    /// Returns a stop that asks to interrupt the running work, after the first signal or the time of an alarm.
    pub(crate) fn stop(&self) -> Stop<'_> {
        Stop::when(&self.stop)
    }

    /// Returns the flag of [`Self::stop`].
    pub(crate) fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Sets an alarm, which also sets the flag of [`Self::stop`], after this time.
    pub(crate) fn set_alarm(&self, after: Duration) -> Result<(), Failure> {
        let stop = self.stop_flag();
        let ring = move || {
            thread::sleep(after);
            stop.store(true, Ordering::Relaxed);
        };
        let thread = thread::Builder::new().name("alarm".to_owned());
        thread.spawn(ring).map(drop).map_err(|error| {
            let message = format!("cannot start a thread for the time limit: {error}");
            Failure::new(Exit::RenderFailed, message)
        })
    }

    /// Does `work` in a separate thread, as it does not check the flag. Calls `tick` meanwhile, every [`GAP`]. None:
    /// the flag was set before the work was done; then the thread ends with the process.
    pub(crate) fn wait_for<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
        mut tick: impl FnMut(),
    ) -> Option<T> {
        if stands_alone() {
            // Parallel iterators run on this thread alone.
            return Some(work());
        }
        let work = Arc::new(Mutex::new(Some(work)));
        let (sender, receiver) = mpsc::channel();
        let in_thread = Arc::clone(&work);
        // The stack that a person asks for is that of all threads.
        let thread = match std::env::var_os("RUST_MIN_STACK") {
            Some(_) => thread::Builder::new(),
            None => thread::Builder::new().stack_size(STACK),
        };
        let Ok(thread) = thread.spawn(move || sender.send(done(&in_thread))) else {
            // Without a thread, the flag is looked at afterwards.
            return done(&work);
        };
        loop {
            match receiver.recv_timeout(GAP) {
                Ok(done) => return done,
                Err(RecvTimeoutError::Timeout) if self.stop().is_asked() => return None,
                Err(RecvTimeoutError::Timeout) => tick(),
                // It panicked.
                Err(RecvTimeoutError::Disconnected) => match thread.join() {
                    Ok(_) => return None,
                    Err(panic) => panic::resume_unwind(panic),
                },
            }
        }
    }

    /// Returns true if SIGUSR1 arrived since the last call.
    pub(crate) fn take_write_request(&self) -> bool {
        self.write.swap(false, Ordering::Relaxed)
    }

    /// Returns the exit of a command whose work a signal interrupted.
    pub(crate) fn ended(&self) -> Exit {
        self.exit().unwrap_or(Exit::Interrupted)
    }

    /// Returns the exit for the signal that arrived. None: no signal arrived.
    pub(crate) fn exit(&self) -> Option<Exit> {
        let received = self.received.load(Ordering::Relaxed);
        let of = |&&(signal, _): &&(i32, Exit)| signal as usize == received;
        SIGNALS.iter().find(of).map(|&(_, exit)| exit)
    }
}

/// Does `work` and returns its result. None: it was done before.
fn done<T>(work: &Mutex<Option<impl FnOnce() -> T>>) -> Option<T> {
    let work = work.lock().unwrap_or_else(PoisonError::into_inner).take();
    work.map(|work| work())
}

/// Makes the command end with a specific exit code when the system refuses memory.
///
/// The standard library then prints the number of bytes and aborts; nothing else in this program aborts.
pub(crate) fn end_without_memory() {
    let always = Arc::new(AtomicBool::new(true));
    // If this fails, an abort still ends the command.
    let _ = flag::register_conditional_shutdown(SIGABRT, Exit::Scene.code().into(), always);
}

/// Makes a write beyond the limit on file sizes fail, instead of ending the process.
pub(crate) fn survive_size_limits() {
    // If this fails, the signal still ends the process.
    #[cfg(unix)]
    let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

#[expect(clippy::needless_pass_by_value, reason = "`map_err` gives the value")]
fn unwatched(error: std::io::Error) -> Failure {
    let message = format!("cannot watch signals: {error}");
    Failure::new(Exit::RenderFailed, message)
}
