//! Threads that are started, and what is said where there are fewer than were asked for.

use crate::console::Console;
use bidir::driver::{Shortage, Threads, start_pool};

/// Starts the threads of everything but renders, whose sessions have their own. `asked` is as
/// `--threads`; 0 is one per processor.
pub(crate) fn start(asked: impl Into<usize>, console: Console) {
    if let Some(shortage) = start_for_render(asked, console) {
        console.warning(shortage);
    }
}

/// The same, where the session that follows warns of a shortage: it comes last, and has the larger one.
pub(crate) fn start_for_render(asked: impl Into<usize>, console: Console) -> Option<Shortage> {
    start_pool(limited(asked, console))
}

/// As many as were asked for, with a warning where there are fewer.
pub(crate) fn limited(asked: impl Into<usize>, console: Console) -> Threads {
    let threads = Threads::new(asked.into());
    if let Some(warning) = threads.warning() {
        console.warning(warning);
    }
    threads
}
