//! The host's view of a running experiment: events, a clock, and a way to stop.

use crate::results::Record;
use bidir::driver::{Progress, Stop};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The host of an experiment: receives events, supplies the clocks, and can stop the run.
///
/// Only one thread at a time calls it.
pub trait Observer: Send {
    /// Receives an event.
    fn notify(&mut self, event: Event<'_>);

    /// Reads the host's clock. Unit: seconds since an arbitrary moment.
    fn seconds(&self) -> f64;

    /// Reads the processor time of all threads of the process so far, user and system. Unit: seconds.
    /// None: the host does not measure it.
    fn processor_seconds(&self) -> Option<f64> {
        None
    }

    /// Returns true to stop; called before each pass. The unfinished render is then dropped.
    fn should_stop(&mut self) -> bool {
        false
    }

    /// Returns the flag that asks to leave the running pass or training, too. It is set only if
    /// [`Self::should_stop`] then returns true.
    fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::default()
    }
}

/// Leaves a pass when the flag of an observer is set.
pub(super) struct Pass<'a>(pub(super) &'a AtomicBool);

impl Progress for Pass<'_> {
    fn advance(&self, _samples: u64) {}

    fn stop(&self) -> Stop<'_> {
        Stop::when(self.0)
    }
}

/// An event of a running experiment.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A warning about a scene, a method or a reference, such as a noisy reference.
    Warning(&'a str),
    /// A pass of one of the two estimators of a reference begins.
    Reference {
        /// The scene.
        scene: &'a str,
        /// Finished passes.
        passes: u64,
        /// All passes.
        of: u64,
    },
    /// A pass of the images of strategies begins.
    Pyramid {
        /// The scene.
        scene: &'a str,
        /// Finished passes.
        passes: u64,
        /// All passes.
        of: u64,
    },
    /// References and images of strategies are complete; the first run without a record is next.
    Begin {
        /// Runs with a record.
        done: usize,
        /// All runs.
        of: usize,
    },
    /// A run is finished.
    Record(&'a Record),
}
