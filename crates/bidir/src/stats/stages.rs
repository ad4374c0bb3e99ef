//! The time of stages, measured in some of the samples by the host's clock.
//!
//! Times differ from run to run, so they are separate from counters: no film, no counter and no estimate depends on
//! them.

use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// A monotonic clock, such as [`Instant::now`]. The host gives it; the library reads no other.
pub type Clock = fn() -> Instant;

/// The number of batches of a thread per measured one. It is prime, so that for no image width the same columns are
/// measured in every row.
const MEASURED_EVERY: u32 = 7;

/// A stage of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Walking the subpaths, with their rays.
    Walk,
    /// Hits of light by a bidirectional camera walk, and their weights: s = 0.
    Hits,
    /// The light image, t = 1: connections, weights and shadow rays.
    LightImage,
    /// Connections and weights of s ≥ 1 and t ≥ 2, with light points of their own.
    Candidates,
    /// Choosing candidates.
    Select,
    /// Shadow rays of the chosen candidates.
    Shadow,
    /// All work of path tracing at its vertices: hits, light points, weights and shadow rays.
    Direct,
    /// Adding contributions to the pass, without adding the pass to the film.
    Film,
}

impl Stage {
    /// Every stage with its name.
    pub const NAMES: [(&'static str, Self); 8] = [
        ("walk", Self::Walk),
        ("hits", Self::Hits),
        ("light_image", Self::LightImage),
        ("candidates", Self::Candidates),
        ("select", Self::Select),
        ("shadow", Self::Shadow),
        ("direct", Self::Direct),
        ("film", Self::Film),
    ];
}

/// The time of each stage, summed over the samples that were measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageTimes {
    /// Samples that were measured.
    pub samples: u64,
    times: [Duration; Stage::NAMES.len()],
}

impl StageTimes {
    /// Returns the time of `stage`.
    pub fn of(&self, stage: Stage) -> Duration {
        self.times[stage as usize]
    }

    /// Returns the time of all stages.
    pub fn total(&self) -> Duration {
        self.times.iter().sum()
    }
}

impl AddAssign<&Self> for StageTimes {
    fn add_assign(&mut self, other: &Self) {
        self.samples += other.samples;
        for (time, other) in self.times.iter_mut().zip(&other.times) {
            *time += *other;
        }
    }
}

/// Measures the stages of a thread's samples. Without a clock it does nothing.
#[derive(Clone, Debug, Default)]
pub struct Stopwatch {
    clock: Option<Clock>,
    /// The number of batches since the last measured one.
    waited: u32,
    /// The end of the last stage. None: this batch is not measured.
    last: Option<Instant>,
    times: StageTimes,
}

impl Stopwatch {
    /// Makes a stopwatch that reads `clock`, if there is one.
    pub(crate) fn new(clock: Option<Clock>) -> Self {
        Self {
            clock,
            ..Self::default()
        }
    }

    /// Begins a batch of `samples`, and its first stage.
    #[inline]
    pub(crate) fn begin_samples(&mut self, samples: usize) {
        self.begin();
        if self.last.is_some() {
            self.times.samples += samples as u64;
        }
    }

    /// Begins the light subpaths of a batch, which are measured as often as batches of samples.
    #[inline]
    pub(crate) fn begin(&mut self) {
        let Some(clock) = self.clock else { return };
        self.waited += 1;
        self.last = None;
        if self.waited == MEASURED_EVERY {
            self.waited = 0;
            self.last = Some(clock());
        }
    }

    /// Ends `stage`, and begins the next.
    #[inline]
    pub(crate) fn end(&mut self, stage: Stage) {
        if let (Some(clock), Some(last)) = (self.clock, self.last) {
            let now = clock();
            self.times.times[stage as usize] += now - last;
            self.last = Some(now);
        }
    }

    /// Returns the times measured since the last call.
    pub(crate) fn take(&mut self) -> StageTimes {
        std::mem::take(&mut self.times)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    thread_local! {
        static NOW: Cell<Option<Instant>> = const { Cell::new(None) };
    }

    /// Goes on by a microsecond whenever it is looked at.
    fn ticking() -> Instant {
        let now = NOW.get().unwrap_or_else(Instant::now) + Duration::from_micros(1);
        NOW.set(Some(now));
        now
    }

    fn measure(watch: &mut Stopwatch, samples: u32) {
        for _ in 0..samples {
            watch.begin_samples(1);
            for stage in [Stage::Walk, Stage::Walk, Stage::Film] {
                watch.end(stage);
            }
        }
    }

    #[test]
    fn one_of_so_many_samples_is_measured() {
        let mut watch = Stopwatch::new(Some(ticking));
        measure(&mut watch, MEASURED_EVERY - 1);
        assert_eq!(watch.take(), StageTimes::default());
        measure(&mut watch, 2 * MEASURED_EVERY);
        let times = watch.take();
        let micros = |stage| times.of(stage).as_micros();
        assert_eq!(times.samples, 2);
        assert_eq!((micros(Stage::Walk), micros(Stage::Film)), (4, 2));
        assert_eq!((micros(Stage::Shadow), times.total().as_micros()), (0, 6));
        assert_eq!(watch.take(), StageTimes::default());
    }

    #[test]
    fn nothing_is_measured_without_a_clock() {
        let mut watch = Stopwatch::new(None);
        measure(&mut watch, 3 * MEASURED_EVERY);
        assert_eq!(watch.take(), StageTimes::default());
    }

    #[test]
    fn times_add_up_stage_by_stage() {
        let mut watch = Stopwatch::new(Some(ticking));
        let mut sum = StageTimes::default();
        for _ in 0..3 {
            measure(&mut watch, MEASURED_EVERY);
            sum += &watch.take();
        }
        assert_eq!((sum.samples, sum.of(Stage::Film).as_micros()), (3, 3));
    }

    #[test]
    fn every_stage_has_its_place() {
        for (i, (_, stage)) in Stage::NAMES.into_iter().enumerate() {
            assert_eq!(stage as usize, i);
        }
    }
}
