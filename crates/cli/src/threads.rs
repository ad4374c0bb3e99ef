//! Starts threads, and warns if there are fewer than requested.

use crate::console::Console;
use bidir::driver::{Shortage, Threads, start_pool};

/// Starts the threads of all commands but renders, whose sessions have their own. 0: one per processor.
pub(crate) fn start(requested: impl Into<usize>, console: Console) {
    if let Some(shortage) = start_for_render(requested, console) {
        console.warning(shortage);
    }
}

/// Does the same without a warning of a shortage, which the session that follows gives: its shortage is
/// the larger one.
pub(crate) fn start_for_render(requested: impl Into<usize>, console: Console) -> Option<Shortage> {
    start_pool(limited(requested, console))
}

/// Returns the requested number of threads, limited per processor with a warning.
pub(crate) fn limited(requested: impl Into<usize>, console: Console) -> Threads {
    let threads = Threads::new(requested.into());
    if let Some(warning) = threads.warning() {
        console.warning(warning);
    }
    threads
}
