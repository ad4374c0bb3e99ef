//! Catches panics of other crates without printing their messages.
//!
//! A panic prints its message before it can be caught, by a hook of the process. The hook installed here is
//! silent for threads that catch panics, and passes all other panics to the previous hook.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;
use std::thread;

thread_local! {
    /// True while panics of this thread are caught.
    static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
}

/// Runs `work`, which must not leave visible state behind if it panics. Errors: a panic of this thread,
/// whose message is not printed.
pub(super) fn catch_silently<T>(work: impl FnOnce() -> T) -> thread::Result<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = take_hook();
        set_hook(Box::new(move |panic| {
            // A thread that is ending has destroyed its flag, and catches nothing.
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

    /// Runs the panics in another process, whose messages are examined.
    #[test]
    fn only_caught_panics_are_silent() {
        let panicking = "image::catch::tests::panics_in_and_out_of_silence";
        let run = Command::new(std::env::current_exe().unwrap())
            .args([panicking, "--exact", "--ignored", "--nocapture"])
            .output()
            .unwrap();
        let messages = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{messages}");
        assert_eq!(messages.matches("panicked").count(), 2, "{messages}");
        assert!(messages.contains("in another thread") && messages.contains("afterwards"));
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
