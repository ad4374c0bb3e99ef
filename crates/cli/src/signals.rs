//! Signals: the first Ctrl-C or SIGTERM stops after the running pass, the second at once. SIGUSR1 requests
//! that files are written.

use crate::exit::{Exit, Failure};
use signal_hook::consts::{SIGABRT, SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The signals that end a render, each with its exit.
const SIGNALS: [(i32, Exit); 2] = [(SIGINT, Exit::Interrupted), (SIGTERM, Exit::Terminated)];

/// The signals that have arrived.
#[derive(Debug)]
pub(crate) struct Signals {
    received: Arc<AtomicUsize>,
    write: Arc<AtomicBool>,
}

impl Signals {
    /// Installs the handlers; a second signal ends the process at once.
    pub(crate) fn watch() -> Result<Self, Failure> {
        let received = Arc::new(AtomicUsize::new(0));
        let again = Arc::new(AtomicBool::new(false));
        for (signal, exit) in SIGNALS {
            // The order matters: `again` is still unset when the first signal arrives.
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

    /// Returns true if SIGUSR1 arrived since the last call.
    pub(crate) fn take_write_request(&self) -> bool {
        self.write.swap(false, Ordering::Relaxed)
    }

    /// Returns the exit for the signal that arrived. None: no signal arrived.
    pub(crate) fn exit(&self) -> Option<Exit> {
        let received = self.received.load(Ordering::Relaxed);
        let of = |&&(signal, _): &&(i32, Exit)| signal as usize == received;
        SIGNALS.iter().find(of).map(|&(_, exit)| exit)
    }
}

/// Ends the command with an exit code of its own when the system refuses memory.
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
