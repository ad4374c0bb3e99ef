//! The host's view of a running experiment: events, a clock, and a way to stop.

use crate::results::Record;
use bidir::driver::{Progress, Stop};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The host of an experiment: receives events, supplies the clocks, and can stop the run.
///
/// Only one thread at a time calls its methods.
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

    /// Returns the flag that asks to stop. The unfinished render is then dropped.
    fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::default()
    }
}

/// The host of a render, which passes its progress to an observer.
pub(super) struct Host<'a> {
    observer: Mutex<&'a mut dyn Observer>,
    flag: Arc<AtomicBool>,
    samples: AtomicU64,
    samples_per_pass: u64,
    /// Returns the event of a pass, given the number of passes before it. None: there is no event.
    event: &'a (dyn Fn(u64) -> Option<Event<'a>> + Sync),
}

impl<'a> Host<'a> {
    /// Returns a host without events.
    pub(super) fn new(observer: &'a mut dyn Observer) -> Self {
        Self::telling(observer, 1, &|_| None)
    }

    /// Returns a host that notifies the observer of the beginning of each pass.
    pub(super) fn telling(
        observer: &'a mut dyn Observer,
        samples_per_pass: u64,
        event: &'a (dyn Fn(u64) -> Option<Event<'a>> + Sync),
    ) -> Self {
        let host = Self {
            flag: observer.stop_flag(),
            observer: Mutex::new(observer),
            samples: AtomicU64::new(0),
            samples_per_pass: samples_per_pass.max(1),
            event,
        };
        host.tell(0);
        host
    }

    fn tell(&self, passes: u64) {
        if let Some(event) = (self.event)(passes) {
            self.with(|observer| observer.notify(event));
        }
    }

    pub(super) fn with<T>(&self, ask: impl FnOnce(&mut dyn Observer) -> T) -> T {
        let observer = self.observer.lock();
        ask(*observer.unwrap_or_else(PoisonError::into_inner))
    }
}

impl Progress for Host<'_> {
    fn advance(&self, samples: u64) {
        let before = self.samples.fetch_add(samples, Ordering::Relaxed);
        let passes = [before, before + samples].map(|samples| samples / self.samples_per_pass);
        if passes[0] < passes[1] {
            self.tell(passes[1]);
        }
    }

    fn stop(&self) -> Stop<'_> {
        Stop::when(&self.flag)
    }

    fn nanoseconds(&self) -> u64 {
        (self.with(|observer| observer.seconds()) * 1e9) as u64
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
