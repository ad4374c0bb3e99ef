//! The limits of a render, by the clock of its host.

use super::Session;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::time::Duration;

/// The limits of a render: the one that is reached first ends it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Budget {
    /// The first pass.
    pub first: u64,
    /// The maximum number of passes from `first` on.
    pub passes: Option<u64>,
    /// The maximum time.
    pub time: Option<Duration>,
    /// The relative error at which the render ends.
    pub noise: Option<f64>,
}

/// The rule that ends a render. A rule that depends on noise or on time may depend on the picture, which biases its
/// mean slightly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stopping {
    /// The number of passes is fixed before the render.
    Fixed,
    /// A clock or a signal ends the render.
    Time,
    /// The noise of the picture is low enough.
    Noise,
}

impl Stopping {
    /// Returns the name of the rule.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Time => "time",
            Self::Noise => "noise",
        }
    }
}

/// The time of a run so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spent {
    /// The passes of this run.
    pub passes: u64,
    /// All time that counts.
    pub total: Duration,
    /// The part of `total` since the first pass of this run.
    pub rendering: Duration,
}

impl Budget {
    /// Returns the passes that may be rendered.
    pub fn range(&self) -> Range<u64> {
        let end = self.passes.map_or(u64::MAX, |passes| self.first + passes);
        self.first..end
    }

    /// Returns the rule that ends the render before its next pass. None: another pass follows.
    pub fn reached(&self, session: &Session<'_>, spent: Spent) -> Option<Stopping> {
        let passes = session.next_pass() - self.first;
        let is_low = |most| Session::looks_at_noise(passes) && session.noise() <= most;
        let noise = || self.noise.is_some_and(is_low).then_some(Stopping::Noise);
        self.used_up(passes, spent).or_else(noise)
    }

    /// Returns the limit of passes or time that is reached after `passes`.
    ///
    /// Expects the next pass to take the mean time of this run's passes. The first pass of a run always has time:
    /// otherwise a render that is continued might never end.
    fn used_up(&self, passes: u64, spent: Spent) -> Option<Stopping> {
        if self.passes.is_some_and(|most| passes >= most) {
            return Some(Stopping::Fixed);
        }
        let next = spent.rendering.div_f64(spent.passes.max(1) as f64);
        let is_over = |most| spent.passes > 0 && spent.total.saturating_add(next) > most;
        self.time.is_some_and(is_over).then_some(Stopping::Time)
    }

    /// Estimates the remaining time after `elapsed`, at the rate of the passes from `before` to `now`, which
    /// took `rendering`. Training before them does not count. None: the budget limits neither passes nor
    /// time.
    pub fn left(
        &self,
        [before, now]: [f64; 2],
        elapsed: Duration,
        rendering: Duration,
    ) -> Option<Duration> {
        let of_passes = self.passes.map(|most| {
            let left = (most as f64 - now).max(0.0) / (now - before).max(1e-9);
            let seconds = rendering.as_secs_f64() * left;
            Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
        });
        let of_time = self.time.map(|most| most.saturating_sub(elapsed));
        of_passes.into_iter().chain(of_time).min()
    }

    /// Returns the used fraction of the budget after a number of passes, which may be fractional. Range:
    /// `[0, 1]`.
    pub fn used(&self, passes: f64, elapsed: Duration) -> f64 {
        let of_passes = self.passes.map_or(0.0, |most| passes / most as f64);
        let of_time = self.time.map_or(0.0, |most| elapsed.div_duration_f64(most));
        of_passes.max(of_time).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn budget(passes: u64) -> Budget {
        Budget {
            first: 0,
            passes: Some(passes),
            time: Some(SECOND * 10),
            noise: None,
        }
    }

    /// Checks the limit after `passes`, of which this run rendered some in `rendering` seconds.
    #[track_caller]
    fn check(passes: u64, [rendered, total, rendering]: [u32; 3], limit: Option<Stopping>) {
        let spent = Spent {
            passes: rendered.into(),
            total: SECOND * total,
            rendering: SECOND * rendering,
        };
        assert_eq!(budget(9).used_up(passes, spent), limit);
    }

    #[test]
    fn a_pass_that_would_exceed_the_time_is_not_started() {
        check(5, [5, 8, 5], None);
        check(5, [2, 7, 6], None);
        check(5, [2, 8, 6], Some(Stopping::Time));
        check(9, [1, 1, 1], Some(Stopping::Fixed));
    }

    #[test]
    fn every_run_renders_a_pass_however_long_training_took() {
        check(5, [0, 20, 0], None);
        check(6, [1, 20, 0], Some(Stopping::Time));
        check(9, [0, 20, 0], Some(Stopping::Fixed));
    }

    #[test]
    fn noise_is_measured_after_every_eighth_more() {
        let passes = 0..40;
        let measured: Vec<_> = passes.filter(|n| Session::looks_at_noise(*n)).collect();
        assert_eq!(measured, [16, 18, 20, 22, 24, 26, 28, 30, 32, 36]);
    }

    #[test]
    fn the_remaining_time_does_not_depend_on_training() {
        let (trained, open) = (SECOND * 300, None);
        let left = |time| {
            let budget = Budget { time, ..budget(10) };
            // Six passes come from the checkpoint, and two took four seconds.
            budget.left([6.0, 8.0], trained + SECOND * 4, SECOND * 4)
        };
        assert_eq!(left(open), Some(SECOND * 4));
        assert_eq!(left(Some(SECOND * 600)), Some(SECOND * 4));
        assert_eq!(left(Some(SECOND * 307)), Some(SECOND * 3));
        assert_eq!(left(Some(SECOND)), Some(Duration::ZERO));
    }

    #[test]
    fn the_remaining_time_of_a_noise_limit_is_unknown() {
        let open = Budget::default();
        assert_eq!(open.left([0.0, 8.0], SECOND, SECOND), None);
    }

    #[test]
    fn the_nearer_limit_counts() {
        let budget = budget(10);
        assert!((budget.used(5.0, SECOND) - 0.5).abs() < 1e-9);
        assert!((budget.used(1.0, SECOND * 8) - 0.8).abs() < 1e-9);
        assert!((budget.used(1.0, SECOND * 80) - 1.0).abs() < 1e-9);
    }
}
