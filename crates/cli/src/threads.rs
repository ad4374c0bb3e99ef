//! Starts threads, and warns if there are fewer than requested.

use crate::console::Console;
use bidir::driver::{Shortage, Threads, start_pool};

/// Starts the threads of a command that does not render; sessions of renders start their own. 0: one per processor.
pub(crate) fn start(requested: impl Into<usize>, console: Console) {
    if let Some(shortage) = start_for_render(requested, console) {
        console.warning(shortage);
    }
}

/// Starts the threads of a command that renders. Returns a shortage without a warning: the session that follows
/// warns of its own shortage, which is the larger one.
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
