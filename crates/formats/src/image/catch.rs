//! Panics of other crates, caught without a word.
//!
//! A panic prints its message before it can be caught, by a hook that belongs to the process. Here
//! a hook is put in front of that one, once, which is silent for the threads that say so, and
//! hands on all other panics.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;
use std::thread;

thread_local! {
    /// True while this thread's panics are caught.
    static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work`, of which a panic leaves nothing in use that is seen afterwards. Errors: a panic of
/// this thread, whose message is not printed.
pub(super) fn catch_silently<T>(work: impl FnOnce() -> T) -> thread::Result<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = take_hook();
        set_hook(Box::new(move |panic| {
            // A thread that is ending has no such flag any more, and is not caught.
            if !IS_CAUGHT.try_with(Cell::get).unwrap_or(false) {
                previous(panic);
            }
        }));
    });
    let was_caught = IS_CAUGHT.replace(true);
    let result = catch_unwind(AssertUnwindSafe(work));
    IS_CAUGHT.set(was_caught);
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    /// The panics whose messages are looked for happen in a process of their own.
    #[test]
    fn only_panics_that_are_caught_are_silent() {
        let panicking = "image::catch::tests::panics_in_and_out_of_silence";
        let run = Command::new(std::env::current_exe().unwrap())
            .args([panicking, "--exact", "--ignored", "--nocapture"])
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{told}");
        assert_eq!(told.matches("panicked").count(), 2, "{told}");
        assert!(told.contains("in another thread") && told.contains("afterwards"));
    }

    #[test]
    #[ignore = "run by the test above, which reads what it prints"]
    fn panics_in_and_out_of_silence() {
        let caught = catch_silently(|| {
            let other = thread::spawn(|| panic!("in another thread")).join();
            assert!(other.is_err());
            panic!("in silence");
        });
        assert!(caught.is_err());
        assert!(catch_silently(|| 7).is_ok_and(|number| number == 7));
        assert!(catch_unwind(|| panic!("afterwards")).is_err());
    }
}
