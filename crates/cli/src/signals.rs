//! Ctrl-C and SIGTERM: the first asks to stop, the second stops. SIGUSR1 asks to write.

use crate::exit::{Exit, Failure};
use signal_hook::consts::{SIGABRT, SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The signals that end a render, each with how the command then ends.
const SIGNALS: [(i32, Exit); 2] = [(SIGINT, Exit::Interrupted), (SIGTERM, Exit::Terminated)];

/// Whether a signal asked to stop.
#[derive(Debug)]
pub(crate) struct Signals {
    received: Arc<AtomicUsize>,
    write: Arc<AtomicBool>,
}

impl Signals {
    /// Watches from now on; a second signal ends the process at once.
    pub(crate) fn watch() -> Result<Self, Failure> {
        let received = Arc::new(AtomicUsize::new(0));
        let again = Arc::new(AtomicBool::new(false));
        for (signal, exit) in SIGNALS {
            // In this order: the first signal finds `again` unset.
            flag::register_conditional_shutdown(signal, exit.code().into(), Arc::clone(&again))
                .and_then(|_| flag::register(signal, Arc::clone(&again)))
                .and_then(|_| flag::register_usize(signal, Arc::clone(&received), signal as usize))
                .map_err(unwatched)?;
        }
        let write = Arc::new(AtomicBool::new(false));
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&write)).map_err(unwatched)?;
        Ok(Self { received, write })
    }

    /// True where a signal asked to write since this was last asked.
    pub(crate) fn take_write_request(&self) -> bool {
        self.write.swap(false, Ordering::Relaxed)
    }

    /// How the command ends because of a signal. None: there was none.
    pub(crate) fn exit(&self) -> Option<Exit> {
        let received = self.received.load(Ordering::Relaxed);
        let of = |&&(signal, _): &&(i32, Exit)| signal as usize == received;
        SIGNALS.iter().find(of).map(|&(_, exit)| exit)
    }
}

/// Makes the command end with its exit code where the system refuses memory: the library of the language
/// then says how many bytes were asked for, and aborts. Nothing else of this program does.
pub(crate) fn end_without_memory() {
    let always = Arc::new(AtomicBool::new(true));
    // Where it cannot be watched, the abort ends the command.
    let _ = flag::register_conditional_shutdown(SIGABRT, Exit::Scene.code().into(), always);
}

/// Has a write beyond the limit on the size of files fail, where the system would end the process.
pub(crate) fn survive_size_limits() {
    // Where it cannot be watched, the process ends as it would have.
    #[cfg(unix)]
    let _ = flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

#[expect(clippy::needless_pass_by_value, reason = "`map_err` gives the value")]
fn unwatched(error: std::io::Error) -> Failure {
    let message = format!("cannot watch signals: {error}");
    Failure::new(Exit::RenderFailed, message)
}
