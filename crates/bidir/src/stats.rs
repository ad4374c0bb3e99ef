//! Counters of a render: rays where they are traced, candidates, the fate of each strategy's contributions, and
//! dropped contributions; and separately, times by a host's clock.

mod stages;
mod strategies;

pub use stages::{Clock, Stage, StageTimes, Stopwatch};
pub use strategies::{LayerCounts, StrategyCounts, StrategyTable};

use crate::strategy::Strategy;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::collections::BTreeSet;
use std::ops::AddAssign;

/// Rays by kind, counted where they are traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Rays of camera walks.
    pub camera: u64,
    /// Rays of light walks.
    pub light: u64,
    /// Shadow rays that join s ≥ 1 with t ≥ 2.
    pub connection: u64,
    /// Shadow rays of the light image, t = 1.
    pub light_image: u64,
}

impl RayCounts {
    /// Returns the number of all rays.
    pub fn total(&self) -> u64 {
        self.camera + self.light + self.connection + self.light_image
    }
}

/// Writes the kinds, and their sum as `total`.
impl Serialize for RayCounts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut rays = serializer.serialize_struct("RayCounts", 5)?;
        rays.serialize_field("camera", &self.camera)?;
        rays.serialize_field("light", &self.light)?;
        rays.serialize_field("connection", &self.connection)?;
        rays.serialize_field("light_image", &self.light_image)?;
        rays.serialize_field("total", &self.total())?;
        rays.end()
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.light += other.light;
        self.connection += other.connection;
        self.light_image += other.light_image;
    }
}

/// The origin of a dropped contribution, which was not finite, or too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Dropped {
    /// The pass.
    pub pass: u64,
    /// The pixel whose sample made it.
    pub pixel: [u32; 2],
    /// The strategy that made it.
    pub strategy: Strategy,
}

/// The number of dropped contributions in the list: the first ones by (pass, pixel, strategy).
pub const LISTED_DROPS: usize = 64;

/// The counters of a render, or of a part of one. The sum of parts does not depend on their order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Camera samples taken.
    pub samples: u64,
    /// Rays by kind.
    pub rays: RayCounts,
    /// Shadow rays of connections that are blocked.
    pub connections_blocked: u64,
    /// Shadow rays of the light image that are blocked.
    pub light_image_blocked: u64,
    /// Candidate connections evaluated.
    pub candidates: u64,
    /// The fate of the contributions of each strategy.
    pub strategies: StrategyTable,
    /// Counts of the strategies that have images.
    pub strategy_images: StrategyTable<LayerCounts>,
    /// Contributions dropped.
    pub dropped: u64,
    /// The first dropped contributions.
    pub dropped_list: BTreeSet<Dropped>,
}

impl Stats {
    /// Counts a contribution of `strategy` that is not zero, before selection and visibility.
    #[inline]
    pub fn count_candidate(&mut self, strategy: Strategy) {
        self.strategies.of(strategy).candidates += 1;
        self.candidates += u64::from(strategy.s >= 1 && strategy.t >= 2);
    }

    /// Counts contributions like [`Self::count_candidate`], all of connections with s ≥ 1 and t ≥ 2.
    #[inline]
    pub fn count_connections(&mut self, strategies: impl ExactSizeIterator<Item = Strategy>) {
        self.candidates += strategies.len() as u64;
        for strategy in strategies {
            self.strategies.of(strategy).candidates += 1;
        }
    }

    /// Counts a shadow ray of `strategy`.
    #[inline]
    pub fn count_shadow_ray(&mut self, strategy: Strategy) {
        self.strategies.of(strategy).traced += 1;
        match strategy.t {
            1 => self.rays.light_image += 1,
            _ => self.rays.connection += 1,
        }
    }

    /// Counts that a shadow ray of `strategy`, counted before, is blocked.
    #[inline]
    pub fn count_blocked(&mut self, strategy: Strategy) {
        self.strategies.of(strategy).blocked += 1;
        match strategy.t {
            1 => self.light_image_blocked += 1,
            _ => self.connections_blocked += 1,
        }
    }

    /// Counts a contribution that was dropped.
    pub fn drop_contribution(&mut self, dropped: Dropped) {
        self.dropped += 1;
        self.list(dropped);
    }

    fn list(&mut self, dropped: Dropped) {
        self.dropped_list.insert(dropped);
        if self.dropped_list.len() > LISTED_DROPS {
            self.dropped_list.pop_last();
        }
    }
}

impl AddAssign<&Self> for Stats {
    fn add_assign(&mut self, other: &Self) {
        self.samples += other.samples;
        self.rays += other.rays;
        self.connections_blocked += other.connections_blocked;
        self.light_image_blocked += other.light_image_blocked;
        self.candidates += other.candidates;
        self.strategies += &other.strategies;
        self.strategy_images += &other.strategy_images;
        self.dropped += other.dropped;
        other
            .dropped_list
            .iter()
            .for_each(|&dropped| self.list(dropped));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_of_drops_does_not_depend_on_order() {
        let at = |pass| Dropped {
            pass,
            pixel: [1, 2],
            strategy: Strategy::new(0, 2),
        };
        let (mut forwards, mut backwards) = (Stats::default(), Stats::default());
        (0..200).for_each(|pass| forwards.drop_contribution(at(pass)));
        let passes = (0..200).rev();
        passes.for_each(|pass| backwards.drop_contribution(at(pass)));
        assert_eq!(forwards, backwards);
        let listed = forwards.dropped_list.len();
        assert_eq!((forwards.dropped, listed), (200, LISTED_DROPS));
        let mut sum = Stats::default();
        sum += &backwards;
        assert_eq!(sum, forwards);
    }

    #[test]
    fn rays_are_counted_by_kind_and_by_strategy() {
        let mut stats = Stats::default();
        for (s, t) in [(0, 3), (1, 2), (2, 1), (2, 1)] {
            stats.count_candidate(Strategy::new(s, t));
        }
        for (s, t) in [(1, 2), (2, 1), (2, 1)] {
            stats.count_shadow_ray(Strategy::new(s, t));
        }
        stats.count_blocked(Strategy::new(2, 1));
        assert_eq!((stats.candidates, stats.connections_blocked), (1, 0));
        assert_eq!((stats.rays.connection, stats.rays.light_image), (1, 2));
        assert_eq!(stats.light_image_blocked, 1);
        let counts = |candidates, traced, blocked| StrategyCounts {
            candidates,
            traced,
            blocked,
        };
        let rows: Vec<_> = stats.strategies.rows().collect();
        let expected = [
            (Strategy::new(0, 3), counts(1, 0, 0)),
            (Strategy::new(1, 2), counts(1, 1, 0)),
            (Strategy::new(2, 1), counts(2, 2, 1)),
        ];
        assert_eq!(rows, expected);
    }
}
