//! Counts by strategy (s, t), in a triangle of rows n = s + t; row n begins at n(n-1)/2.

use crate::math::fixed::{self, MOMENT_SCALE};
use crate::strategy::Strategy;
use serde::Serialize;
use std::ops::AddAssign;

/// The fate of the contributions of a strategy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct StrategyCounts {
    /// Contributions that are not zero, before selection and visibility.
    pub candidates: u64,
    /// Candidates whose shadow ray was traced: none for s = 0, all for t = 1.
    pub traced: u64,
    /// Candidates whose shadow ray was blocked.
    pub blocked: u64,
}

impl AddAssign for StrategyCounts {
    fn add_assign(&mut self, other: Self) {
        self.candidates += other.candidates;
        self.traced += other.traced;
        self.blocked += other.blocked;
    }
}

/// The counts of a strategy whose images the film keeps. They are integers, so that the order of addition does not
/// matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LayerCounts {
    /// Σ Y², with Y the luminance that one sample added to the strategy's weighted image, in
    /// [`MOMENT_SCALE`]; of a splat before it is divided by the number of light paths.
    squares: i128,
    /// The number of values that the weighted image has, but the raw image lacks because they are too large without
    /// their weight.
    pub raw_dropped: u64,
}

impl LayerCounts {
    /// Counts the luminance that one sample added.
    #[inline]
    pub(crate) fn add_square(&mut self, luminance: f64) {
        let square = fixed::from_f64(luminance * luminance, MOMENT_SCALE);
        // Squares are positive, so that stopping at the top depends on no order.
        self.squares = self.squares.saturating_add(square);
    }

    /// Returns the sum of squares.
    pub fn squares(&self) -> f64 {
        fixed::to_f64(self.squares, MOMENT_SCALE)
    }
}

impl AddAssign for LayerCounts {
    fn add_assign(&mut self, other: Self) {
        self.squares = self.squares.saturating_add(other.squares);
        self.raw_dropped += other.raw_dropped;
    }
}

/// The most vertices of paths with counts of their own; longer ones are counted together. Without a limit of depth
/// there may be half a million strategies.
const MAX_ROW: usize = 32;

/// The counts of each strategy. The sum of tables does not depend on their order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StrategyTable<T = StrategyCounts> {
    /// The counts by rows of n = 1, 2, … vertices, then by s, as far as there are any.
    rows: Vec<T>,
    /// The counts of all strategies of more than [`MAX_ROW`] vertices.
    longer: T,
}

impl<T: Copy + Default + PartialEq> StrategyTable<T> {
    /// Returns the counts of a strategy for an increment.
    #[inline]
    pub(crate) fn of(&mut self, strategy: Strategy) -> &mut T {
        let Some(i) = index(strategy) else {
            return &mut self.longer;
        };
        if i >= self.rows.len() {
            self.rows.resize(i + 1, T::default());
        }
        &mut self.rows[i]
    }

    /// Returns the counts of a strategy; for a path too long for counts of its own, those of all such paths.
    pub fn get(&self, strategy: Strategy) -> T {
        index(strategy).map_or(self.longer, |i| {
            self.rows.get(i).copied().unwrap_or_default()
        })
    }

    /// Returns every strategy with its counts if there are any, shorter paths first.
    pub fn rows(&self) -> impl Iterator<Item = (Strategy, T)> {
        let strategies = (1..).flat_map(|n| (0..n).map(move |s| Strategy::new(s, n - s)));
        strategies
            .zip(self.rows.iter().copied())
            .filter(|(_, counts)| *counts != T::default())
    }

    /// Returns the counts of all strategies of paths that are too long for a row of their own.
    pub fn longer(&self) -> T {
        self.longer
    }
}

impl<T: AddAssign + Copy + Default + PartialEq> AddAssign<&Self> for StrategyTable<T> {
    fn add_assign(&mut self, other: &Self) {
        for (strategy, counts) in other.rows() {
            *self.of(strategy) += counts;
        }
        self.longer += other.longer;
    }
}

/// Returns the place of a strategy in the rows. None: its paths are too long for counts of their own.
#[inline]
fn index(strategy: Strategy) -> Option<usize> {
    let (s, n) = (
        usize::from(strategy.s),
        usize::from(strategy.s + strategy.t),
    );
    (n <= MAX_ROW).then(|| n * n.saturating_sub(1) / 2 + s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(strategies: &[(usize, usize)]) -> StrategyTable {
        let mut table = StrategyTable::<StrategyCounts>::default();
        for &(s, t) in strategies {
            table.of(Strategy::new(s, t)).candidates += 1;
        }
        table
    }

    #[test]
    fn every_strategy_has_a_place_of_its_own() {
        let all: Vec<_> = (1..=MAX_ROW)
            .flat_map(|n| (0..n).map(move |s| (s, n - s)))
            .collect();
        let table = table(&all);
        let named = table.rows().map(|(strategy, counts)| {
            assert_eq!(counts.candidates, 1);
            (usize::from(strategy.s), usize::from(strategy.t))
        });
        assert_eq!(named.collect::<Vec<_>>(), all);
        assert_eq!(table.longer(), StrategyCounts::default());
    }

    #[test]
    fn tables_add_up_in_any_order() {
        let (a, b) = (table(&[(0, 2), (3, 4)]), table(&[(1, 1), (3, 4), (700, 2)]));
        let (mut ab, mut ba) = (a.clone(), b.clone());
        ab += &b;
        ba += &a;
        assert_eq!(ab, ba);
        assert_eq!(ab.of(Strategy::new(3, 4)).candidates, 2);
        assert_eq!(ab.longer().candidates, 1);
    }
}
