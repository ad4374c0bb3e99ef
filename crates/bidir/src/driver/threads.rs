//! Numbers of threads, and pools of as many threads as the system gives.
//!
//! A system limits the threads of a user and the memory for their stacks. A pool has as many threads as the system
//! starts at once; if it starts none, the calling thread does all work.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::{fmt, io};

/// The number of threads to compute with: the one asked for, but at most [`Self::PER_PROCESSOR`] for each processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Threads {
    asked: usize,
    processors: usize,
}

impl Threads {
    /// The most threads that a user may ask for.
    pub const MOST: usize = 1024;
    /// The most threads for each processor. With many more, waiting threads take time from those that they wait for.
    pub const PER_PROCESSOR: usize = 4;

    /// Makes the number from the one asked for; 0 is one per processor.
    pub fn new(asked: usize) -> Self {
        Self {
            asked,
            processors: thread::available_parallelism().map_or(1, usize::from),
        }
    }

    /// Returns the number of threads to start.
    pub fn count(self) -> usize {
        match self.asked {
            0 => self.processors,
            asked => asked.min(Self::PER_PROCESSOR * self.processors),
        }
    }

    /// Returns a warning that there are fewer threads than were asked for. None: there are as many.
    pub fn warning(self) -> Option<String> {
        let Self { asked, processors } = self;
        (self.count() < asked).then(|| {
            let count = self.count();
            let per = Self::PER_PROCESSOR;
            format!(
                "{count} threads instead of {asked}: more than {per} per processor, of which there \
                 are {processors}, only slow each other down"
            )
        })
    }
}

/// The threads that the system did not start, and why.
#[derive(Debug)]
pub struct Shortage {
    started: usize,
    wanted: usize,
    error: io::Error,
}

impl Shortage {
    /// Returns true if no thread was started.
    pub fn is_total(&self) -> bool {
        self.started == 0
    }
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            started,
            wanted,
            error,
        } = self;
        match started {
            0 => write!(
                f,
                "the system starts no thread ({error}): the calling thread does all work"
            ),
            _ => write!(
                f,
                "the system starts {started} of {wanted} threads: {error}"
            ),
        }
    }
}

/// Returns the number of threads, at most `wanted`, that the system starts at once, and the error that kept it from
/// starting more.
fn startable(wanted: usize) -> (usize, Option<io::Error>) {
    let gate = Mutex::new(());
    let wait = || drop(gate.lock());
    thread::scope(|scope| {
        let closed = gate.lock().unwrap_or_else(PoisonError::into_inner);
        let mut started = Vec::new();
        let error = loop {
            if started.len() == wanted {
                break None;
            }
            match thread::Builder::new().spawn_scoped(scope, wait) {
                Ok(thread) => started.push(thread),
                Err(error) => break Some(error),
            }
        };
        drop(closed);
        let count = started.len();
        // Joined, so that their places are free for the pool's threads.
        for thread in started {
            // A thread that only waits cannot panic.
            let _ = thread.join();
        }
        (count, error)
    })
}

/// Makes a pool of as many threads as the system starts. Returns no pool if it starts none.
fn build_pool<T>(
    threads: Threads,
    build: impl FnOnce(ThreadPoolBuilder) -> Result<T, ThreadPoolBuildError>,
) -> (Option<T>, Option<Shortage>) {
    let wanted = threads.count();
    let short = |started, error| Shortage {
        started,
        wanted,
        error,
    };
    let (started, error) = startable(wanted);
    if started == 0 {
        return (None, error.map(|error| short(0, error)));
    }
    match build(ThreadPoolBuilder::new().num_threads(started)) {
        Ok(pool) => (Some(pool), error.map(|error| short(started, error))),
        Err(error) => (None, Some(short(0, io::Error::other(error)))),
    }
}

/// Makes the pool of the process, on which everything outside of a session runs. Call it once, before anything else
/// is computed. If no thread can be started, the calling thread becomes a pool of its own.
///
/// None: all threads were started.
pub fn start_pool(threads: Threads) -> Option<Shortage> {
    let (pool, shortage) = build_pool(threads, ThreadPoolBuilder::build_global);
    if pool.is_none() {
        stand_alone();
    }
    shortage
}

/// Makes the calling thread a pool of its own, for good, unless it is in a pool: parallel iterators then run on this
/// thread only, even if the pool of the process has none. The pool's few kilobytes are not freed.
pub fn stand_alone() {
    if !stands_alone() {
        let builder = ThreadPoolBuilder::new().num_threads(1);
        // The pool starts no thread, so that the system has nothing to refuse; if building it fails all the same,
        // work goes to the pool of the process.
        let pool = builder.use_current_thread().build();
        std::mem::forget(pool);
    }
}

/// Returns true for a thread that is in a pool, perhaps one of its own. Where this is the main thread,
/// [`start_pool`] found no thread, and parallel iterators of another thread have no pool to run on.
pub fn stands_alone() -> bool {
    rayon::current_thread_index().is_some()
}

/// The threads of a session.
pub(super) struct Workers {
    /// None: the calling thread is the only one.
    pool: Option<ThreadPool>,
    shortage: Option<Shortage>,
}

impl Workers {
    pub(super) fn start(threads: Threads) -> Self {
        let (pool, shortage) = build_pool(threads, ThreadPoolBuilder::build);
        Self { pool, shortage }
    }

    pub(super) fn count(&self) -> usize {
        let pool = self.pool.as_ref();
        pool.map_or(1, ThreadPool::current_num_threads)
    }

    /// Returns the threads that the system did not start. None: it started all.
    pub(super) fn shortage(&self) -> Option<&Shortage> {
        self.shortage.as_ref()
    }

    /// Runs `work`, with its parallel iterators, on these threads.
    pub(super) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        if let Some(pool) = &self.pool {
            pool.install(work)
        } else {
            stand_alone();
            work()
        }
    }

    /// Runs `work` on each of these threads, with the number of the thread.
    pub(super) fn broadcast(&self, work: impl Fn(usize) + Sync) {
        match &self.pool {
            Some(pool) => drop(pool.broadcast(|context| work(context.index()))),
            None => work(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    /// Returns the workers of a system that starts no thread.
    fn refused() -> Workers {
        let shortage = Shortage {
            started: 0,
            wanted: 2,
            error: io::ErrorKind::WouldBlock.into(),
        };
        Workers {
            pool: None,
            shortage: Some(shortage),
        }
    }

    #[test]
    fn no_processor_has_more_than_four_threads() {
        let threads = |asked| Threads {
            asked,
            processors: 2,
        };
        assert_eq!([0, 1, 8].map(|asked| threads(asked).count()), [2, 1, 8]);
        assert!([0, 1, 8].iter().all(|&a| threads(a).warning().is_none()));
        for asked in [9, Threads::MOST, usize::MAX] {
            assert_eq!(threads(asked).count(), 8);
            let warning = threads(asked).warning().unwrap();
            assert!(warning.starts_with(&format!("8 threads instead of {asked}: ")));
        }
    }

    #[test]
    fn without_threads_the_caller_works() {
        let workers = refused();
        assert_eq!(workers.count(), 1);
        let text = workers.shortage().unwrap().to_string();
        assert!(text.starts_with("the system starts no thread"), "{text}");
        // Again in another thread, as sessions move between them.
        for _ in 0..2 {
            let run = || {
                let own = thread::current().id();
                workers.broadcast(|index| assert_eq!((index, thread::current().id()), (0, own)));
                let ids = || (0..1000).into_par_iter().map(|_| thread::current().id());
                workers.install(|| ids().for_each(|id| assert_eq!(id, own)));
            };
            thread::scope(|scope| scope.spawn(run).join().unwrap());
        }
    }

    #[test]
    fn a_pool_has_the_threads_that_the_system_starts() {
        assert!(matches!(startable(3), (3, None)));
        let workers = Workers::start(Threads {
            asked: 3,
            processors: 1,
        });
        assert!(workers.count() == 3 && workers.shortage().is_none());
    }
}
