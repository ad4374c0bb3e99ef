//! Threads: how many there are, and a pool that works with as many as the system gives.
//!
//! A system limits the threads of a user and the memory for their stacks. So every thread of a pool is
//! started before the pool is made of those that were; without any, the calling thread does all work.

use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuilder};
use std::sync::mpsc::{Sender, channel};
use std::thread;
use std::{fmt, io};

/// How many threads compute: as many as were asked for, within what a processor has a use for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Threads {
    asked: usize,
    processors: usize,
}

impl Threads {
    /// The most that may be asked for.
    pub const MOST: usize = 1024;
    /// The most for each processor. With many more, threads that wait for each other take the time of
    /// those that they wait for.
    pub const PER_PROCESSOR: usize = 4;

    /// So many; 0 is one per processor.
    pub fn new(asked: usize) -> Self {
        Self {
            asked,
            processors: thread::available_parallelism().map_or(1, usize::from),
        }
    }

    /// Returns how many there are to be.
    pub fn count(self) -> usize {
        match self.asked {
            0 => self.processors,
            asked => asked.min(Self::PER_PROCESSOR * self.processors),
        }
    }

    /// Says that there are fewer than were asked for. None: there are as many.
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

/// Threads that the system did not start.
#[derive(Debug)]
pub struct Shortage {
    started: usize,
    wanted: usize,
    error: io::Error,
}

impl Shortage {
    /// Returns true where no thread was started.
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

/// Threads that wait to become those of a pool.
struct Recruits {
    waiting: Vec<Sender<ThreadBuilder>>,
    shortage: Option<Shortage>,
}

impl Recruits {
    /// Starts threads, up to the first that cannot be.
    fn start(threads: Threads) -> Self {
        let wanted = threads.count();
        let mut waiting = Vec::new();
        let mut shortage = None;
        for started in 0..wanted {
            match recruit() {
                Ok(sender) => waiting.push(sender),
                Err(error) => {
                    shortage = Some(Shortage {
                        started,
                        wanted,
                        error,
                    });
                    break;
                }
            }
        }
        Self { waiting, shortage }
    }

    /// Makes `build` a pool of them. None: there are none.
    fn join<T, E>(
        self,
        build: impl FnOnce(&mut dyn FnMut(ThreadBuilder) -> io::Result<()>, usize) -> Result<T, E>,
    ) -> (Option<T>, Option<Shortage>) {
        let Self { waiting, shortage } = self;
        let count = waiting.len();
        if count == 0 {
            return (None, shortage);
        }
        let mut waiting = waiting.into_iter();
        let mut hand_over = |work| match waiting.next() {
            Some(sender) => sender
                .send(work)
                .map_err(|_| io::ErrorKind::BrokenPipe.into()),
            None => Err(io::ErrorKind::WouldBlock.into()),
        };
        (build(&mut hand_over, count).ok(), shortage)
    }
}

/// Returns a thread that does what it is sent; without anything it ends with its sender.
fn recruit() -> io::Result<Sender<ThreadBuilder>> {
    let (sender, receiver) = channel();
    let wait = move || {
        if let Ok(work) = receiver.recv() {
            ThreadBuilder::run(work);
        }
    };
    thread::Builder::new().name("worker".into()).spawn(wait)?;
    Ok(sender)
}

/// Makes the pool that everything outside of a session runs on; once in a process, before anything
/// else is computed. If no thread can be started, the calling thread becomes a pool of its own.
///
/// None: there are as many threads as were asked for.
pub fn start_pool(threads: Threads) -> Option<Shortage> {
    // It fails where there is a pool already, which then is the one that is used.
    let (_, shortage) = Recruits::start(threads).join(|spawn, count| {
        let builder = ThreadPoolBuilder::new().num_threads(count);
        builder.spawn_handler(spawn).build_global()
    });
    if shortage.as_ref().is_some_and(Shortage::is_total) {
        stand_alone();
    }
    shortage
}

/// Makes the calling thread a pool of its own, for good, unless it is in one: parallel iterators then
/// run on it alone, where the pool of the process may have no thread. Its few kilobytes are not freed.
pub fn stand_alone() {
    if rayon::current_thread_index().is_none() {
        let builder = ThreadPoolBuilder::new().num_threads(1);
        // It starts no thread, so there is nothing to refuse; where it fails all the same, work goes to
        // the pool of the process.
        let pool = builder.use_current_thread().build();
        std::mem::forget(pool);
    }
}

/// The threads of a session.
pub(super) struct Workers {
    /// None: the calling thread is the only one.
    pool: Option<ThreadPool>,
    shortage: Option<Shortage>,
}

impl Workers {
    pub(super) fn start(threads: Threads) -> Self {
        let (pool, shortage) = Recruits::start(threads).join(|spawn, count| {
            let builder = ThreadPoolBuilder::new().num_threads(count);
            builder.spawn_handler(spawn).build()
        });
        Self { pool, shortage }
    }

    pub(super) fn count(&self) -> usize {
        let pool = self.pool.as_ref();
        pool.map_or(1, ThreadPool::current_num_threads)
    }

    /// Threads that are missing.
    pub(super) fn shortage(&self) -> Option<&Shortage> {
        self.shortage.as_ref()
    }

    /// Runs `work` with its parallel iterators on these threads.
    pub(super) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        if let Some(pool) = &self.pool {
            pool.install(work)
        } else {
            stand_alone();
            work()
        }
    }

    /// Runs `work` on each of these threads, with its number.
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
        let (pool, shortage) = Recruits {
            waiting: Vec::new(),
            shortage: Some(Shortage {
                started: 0,
                wanted: 2,
                error: io::ErrorKind::WouldBlock.into(),
            }),
        }
        .join(|_, _| -> Result<ThreadPool, io::Error> { unreachable!("there is no thread") });
        Workers { pool, shortage }
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
    fn a_pool_has_the_threads_that_were_started() {
        let mut recruits = Recruits::start(Threads {
            asked: 3,
            processors: 1,
        });
        assert_eq!(recruits.waiting.len(), 3);
        recruits.waiting.pop();
        let (pool, _) = recruits.join(|spawn, count| {
            let builder = ThreadPoolBuilder::new().num_threads(count);
            builder.spawn_handler(spawn).build()
        });
        assert_eq!(pool.unwrap().broadcast(|context| context.index()), [0, 1]);
    }
}
