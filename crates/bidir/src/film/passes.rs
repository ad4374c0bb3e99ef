//! The set of passes that a film holds: disjoint half-open ranges, counted from 0.
//!
//! Its text is `0..64` or `0..16, 32..64`. Ranges are sorted, and neighbours are joined, so that equal sets are equal
//! values.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;
use thiserror::Error;

/// A set of passes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct PassSet {
    /// The ranges: sorted, none empty, none touching the next.
    ranges: Vec<Range<u64>>,
}

/// The error of a text that is not a set of passes.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("`{0}` is not a range of passes like 0..64")]
pub struct ParsePassSetError(pub String);

impl PassSet {
    /// Returns the number of passes.
    pub fn len(&self) -> u64 {
        self.ranges
            .iter()
            .map(|range| range.end - range.start)
            .sum()
    }

    /// Returns true if the set has no pass.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// Returns the ranges, sorted, none touching the next.
    pub fn ranges(&self) -> &[Range<u64>] {
        &self.ranges
    }

    /// Returns true if the set has `pass`.
    pub fn contains(&self, pass: u64) -> bool {
        self.ranges[self.first_ending_after(pass)..]
            .first()
            .is_some_and(|range| range.start <= pass)
    }

    /// Adds a range of passes, some of which may be in the set already.
    pub fn insert(&mut self, range: Range<u64>) {
        if range.is_empty() {
            return;
        }
        let begin = self.ranges.partition_point(|old| old.end < range.start);
        let end = self.ranges.partition_point(|old| old.start <= range.end);
        let touching = &self.ranges[begin..end];
        let start = touching.first().map_or(range.start, |old| old.start);
        let stop = touching.last().map_or(range.end, |old| old.end);
        let joined = start.min(range.start)..stop.max(range.end);
        self.ranges.splice(begin..end, [joined]);
    }

    /// Returns the passes of both sets.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let ranges = self.ranges.iter().chain(&other.ranges);
        ranges.cloned().collect()
    }

    /// Returns the passes that are in both sets.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let mut ranges = Vec::new();
        let (mut a, mut b) = (
            self.ranges.iter().peekable(),
            other.ranges.iter().peekable(),
        );
        while let (Some(x), Some(y)) = (a.peek(), b.peek()) {
            let both = x.start.max(y.start)..x.end.min(y.end);
            // The range that ends first overlaps no later range of the other set.
            if x.end < y.end {
                a.next();
            } else {
                b.next();
            }
            if !both.is_empty() {
                ranges.push(both);
            }
        }
        Self { ranges }
    }

    /// Returns the passes of `self` that are not in `other`.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Self {
        let mut ranges = Vec::new();
        for range in &self.ranges {
            let mut begin = range.start;
            let held = &other.ranges[other.first_ending_after(range.start)..];
            for held in held.iter().take_while(|held| held.start < range.end) {
                if begin < held.start {
                    ranges.push(begin..held.start);
                }
                begin = held.end;
            }
            if begin < range.end {
                ranges.push(begin..range.end);
            }
        }
        Self { ranges }
    }

    /// Returns the first pass, from `from` on, that is not in the set.
    pub fn first_missing(&self, from: u64) -> u64 {
        let range = self.ranges.get(self.first_ending_after(from));
        let held = range.filter(|range| range.start <= from);
        held.map_or(from, |range| range.end)
    }

    /// Returns the index of the first range that ends after `pass`.
    fn first_ending_after(&self, pass: u64) -> usize {
        self.ranges.partition_point(|range| range.end <= pass)
    }
}

/// Makes a set of ranges in any order, which may overlap or be empty.
impl FromIterator<Range<u64>> for PassSet {
    fn from_iter<I: IntoIterator<Item = Range<u64>>>(ranges: I) -> Self {
        let mut sorted: Vec<_> = ranges.into_iter().filter(|r| !r.is_empty()).collect();
        sorted.sort_unstable_by_key(|range| range.start);
        sorted.dedup_by(|next, last| {
            let touches = next.start <= last.end;
            if touches {
                last.end = last.end.max(next.end);
            }
            touches
        });
        Self { ranges: sorted }
    }
}

impl From<Range<u64>> for PassSet {
    fn from(range: Range<u64>) -> Self {
        [range].into_iter().collect()
    }
}

impl fmt::Display for PassSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        for (i, range) in self.ranges.iter().enumerate() {
            let comma = if i == 0 { "" } else { ", " };
            write!(f, "{comma}{}..{}", range.start, range.end)?;
        }
        Ok(())
    }
}

impl FromStr for PassSet {
    type Err = ParsePassSetError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let error = || ParsePassSetError(text.to_owned());
        if text.trim() == "none" {
            return Ok(Self::default());
        }
        let ranges = text.split(',').map(|part| {
            let (begin, end) = part.split_once("..").ok_or_else(error)?;
            let number = |text: &str| text.trim().parse::<u64>().map_err(|_| error());
            let range = number(begin)?..number(end)?;
            if range.is_empty() {
                return Err(error());
            }
            Ok(range)
        });
        ranges.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_texts;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn set(text: &str) -> PassSet {
        text.parse().unwrap()
    }

    fn members(set: &PassSet) -> BTreeSet<u64> {
        set.ranges().iter().cloned().flatten().collect()
    }

    fn any_set() -> impl Strategy<Value = PassSet> {
        prop::collection::vec((0u64..40, 0u64..9), 0..6).prop_map(|parts| {
            let mut set = PassSet::default();
            for (begin, length) in parts {
                set.insert(begin..begin + length);
            }
            set
        })
    }

    #[test]
    fn neighbours_are_joined() {
        assert_eq!(set("4..8, 0..4"), PassSet::from(0..8));
        assert_eq!(set("0..4, 8..9").first_missing(2), 4);
        assert_eq!(set("none"), PassSet::default());
    }

    #[test]
    fn other_texts_are_refused() {
        let bad = [
            "", "4", "4..", "..4", "4..4", "8..4", "-1..4", "0..4,", "a..b",
        ];
        check_texts::<PassSet>(&["0..4, 8..9"], &bad);
    }

    #[test]
    fn the_last_numbers_are_passes_too() {
        let all = PassSet::from(0..u64::MAX);
        assert_eq!(all.union(&set("5..9")), all);
        assert_eq!(all.difference(&all), PassSet::default());
        assert_eq!(all.len(), u64::MAX);
        assert_eq!(all.first_missing(7), u64::MAX);
    }

    #[test]
    fn many_ranges_take_no_time() {
        let text = |begin: u64| {
            let ranges = (begin..begin + 100_000).map(|i| format!("{}..{}", 4 * i, 4 * i + 1));
            ranges.rev().collect::<Vec<_>>().join(",")
        };
        let (a, b) = (set(&text(0)), set(&text(50_000)));
        assert_eq!(a.union(&b).ranges().len(), 150_000);
        assert_eq!(a.intersection(&b).len(), 50_000);
        assert_eq!(a.difference(&b).len(), 50_000);
        let mut filled = a.clone();
        for pass in (0..400_000).step_by(4) {
            filled.insert(pass + 1..pass + 2);
        }
        assert_eq!((filled.len(), filled.ranges().len()), (200_000, 100_000));
    }

    proptest! {
        #[test]
        fn it_is_a_set(a in any_set(), b in any_set()) {
            let (x, y) = (members(&a), members(&b));
            prop_assert_eq!(members(&a.union(&b)), &x | &y);
            prop_assert_eq!(members(&a.intersection(&b)), &x & &y);
            prop_assert_eq!(members(&a.difference(&b)), &x - &y);
            prop_assert_eq!(a.len() as usize, x.len());
            prop_assert_eq!(a.union(&b), b.union(&a));
            prop_assert_eq!(a.to_string().parse::<PassSet>().unwrap(), a.clone());
            let inserted = b.ranges().iter().fold(a.clone(), |mut set, range| {
                set.insert(range.clone());
                set
            });
            prop_assert_eq!(inserted, a.union(&b));
            for from in 0..50 {
                prop_assert_eq!(a.contains(from), x.contains(&from));
                let first = (from..1000).find(|pass| !x.contains(pass)).unwrap();
                prop_assert_eq!(a.first_missing(from), first);
            }
            for set in [a.union(&b), a.intersection(&b), a.difference(&b)] {
                let apart = |pair: &[Range<u64>]| pair[0].end < pair[1].start;
                prop_assert!(set.ranges().windows(2).all(apart), "{set}");
            }
        }
    }
}
