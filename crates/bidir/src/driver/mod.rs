//! Rendering: passes of samples into a film.
//!
//! A pass is one sample of every pixel, and a light subpath for each sample or for several. [`Session`] renders pass
//! by pass for hosts that want to look, stop and go on; [`render`] does all at once. The state is (settings, next
//! pass, film, counters), and no more. The same passes give the same bits for any number of threads.
//!
//! There is no clock here: a host with a time budget passes the time that it measured to [`Budget`] between passes.

mod blank;
mod budget;
mod deposit;
mod features;
mod replay;
mod session;
mod spread;
mod threads;
mod training;
mod variance;

pub use crate::settings::Settings;
pub use accel::Stop;
pub use budget::{Budget, Spent, Stopping};
pub use replay::{Landing, Replay, ReplayedTerm, Selection};
pub use session::{SceneHandle, Session};
pub use threads::{Shortage, Threads, stand_alone, stands_alone, start_pool};
pub use training::{Effort, Plan, Training};
pub use variance::StrategyMoments;

use crate::analysis::LostLight;
use crate::film::{Film, FilmError};
use crate::scene::Scene;
use crate::stats::Clock;
use crate::view::View;
use thiserror::Error;

/// The resources that a render may use. They do not change the image.
#[derive(Clone, Copy, Debug)]
pub struct Resources {
    /// The number of threads, limited as [`Threads`] says; 0 is one per processor.
    pub threads: usize,
    /// The most memory of the film. Unit: bytes.
    pub film_memory: u64,
    /// The clock that measures the stages of some samples, for [`Session::stage_times`]. None: nothing is measured.
    pub clock: Option<Clock>,
}

impl Default for Resources {
    fn default() -> Self {
        Self {
            threads: 0,
            film_memory: Self::DEFAULT_FILM_MEMORY,
            clock: None,
        }
    }
}

impl Resources {
    /// 16 GiB: about 80 million pixels.
    pub const DEFAULT_FILM_MEMORY: u64 = 16 << 30;
}

/// Receives progress from all threads, and says if the render goes on.
pub trait Progress: Sync {
    /// Reports `samples` finished samples.
    fn advance(&self, samples: u64);

    /// Reports `samples` samples of an earlier run, which took no time in this one.
    fn resume(&self, samples: u64) {
        self.advance(samples);
    }

    /// Returns the flag by which the host gives up the running pass, which is then forgotten. All threads check it
    /// before every ray, and a ray checks it before every instance.
    fn stop(&self) -> Stop<'_> {
        Stop::NEVER
    }

    /// Returns the time of the host's clock, since any moment. A session reads it only if its film keeps
    /// [`Aov::Time`](crate::film::Aov::Time). Unit: nanoseconds.
    fn nanoseconds(&self) -> u64 {
        0
    }
}

/// Ignores reports, and never stops.
impl Progress for () {
    fn advance(&self, _samples: u64) {}
}

/// Why a session cannot begin.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SessionError {
    /// The film needs too much memory.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The list of strategies makes no path within the limit of length.
    #[error("the list of strategies `{strategies}` {lost}")]
    NoPath {
        /// The list.
        strategies: String,
        /// [`LostLight::All`].
        lost: LostLight,
    },
    /// The host asked to stop before training was complete.
    #[error("stopped before the first pass")]
    Stopped,
}

/// Renders `passes` passes.
///
/// Errors: as [`Session::new`].
pub fn render(
    scene: &Scene,
    view: &View,
    settings: &Settings,
    passes: u64,
    resources: &Resources,
) -> Result<Film, SessionError> {
    let mut session = Session::new(scene, view, settings.clone(), resources)?;
    for _ in 0..passes {
        session.step(&());
    }
    Ok(session.into_film())
}
