//! Which passes a film holds: disjoint half-open ranges, counted from 0.
//!
//! Written `0..64` or `0..16, 32..64`. Sets are kept sorted with neighbours joined, so that equal
//! sets are equal values.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;
use thiserror::Error;

/// A set of passes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct PassSet {
    /// Sorted, not empty, and never touching.
    ranges: Vec<Range<u64>>,
}

/// The text is no set of passes.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("`{0}` is not a range of passes like 0..64")]
pub struct ParsePassSetError(pub String);

impl PassSet {
    /// The number of passes.
    pub fn len(&self) -> u64 {
        self.ranges
            .iter()
            .map(|range| range.end - range.start)
            .sum()
    }

    /// True where no pass is held.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// The ranges, sorted, none touching the next.
    pub fn ranges(&self) -> &[Range<u64>] {
        &self.ranges
    }

    /// Is `pass` held?
    pub fn contains(&self, pass: u64) -> bool {
        self.ranges.iter().any(|range| range.contains(&pass))
    }

    /// Adds passes, those that were there included.
    pub fn insert(&mut self, range: Range<u64>) {
        if range.is_empty() {
            return;
        }
        let (touching, mut rest): (Vec<_>, Vec<_>) = std::mem::take(&mut self.ranges)
            .into_iter()
            .partition(|old| old.start <= range.end && range.start <= old.end);
        let joined = touching.iter().fold(range, |joined, old| {
            joined.start.min(old.start)..joined.end.max(old.end)
        });
        rest.push(joined);
        rest.sort_by_key(|range| range.start);
        self.ranges = rest;
    }

    /// Both sets.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let mut union = self.clone();
        for range in &other.ranges {
            union.insert(range.clone());
        }
        union
    }

    /// The passes that both hold.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let mut both = Self::default();
        for a in &self.ranges {
            for b in &other.ranges {
                both.insert(a.start.max(b.start)..a.end.min(b.end));
            }
        }
        both
    }

    /// The passes of `self` that `other` lacks.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Self {
        let mut rest = Self::default();
        for range in &self.ranges {
            let mut begin = range.start;
            for held in &other.ranges {
                rest.insert(begin..held.start.min(range.end));
                begin = begin.max(held.end);
            }
            rest.insert(begin..range.end);
        }
        rest
    }

    /// The first pass at or after `from` that is not held.
    pub fn first_missing(&self, from: u64) -> u64 {
        let held = self.ranges.iter().find(|range| range.contains(&from));
        held.map_or(from, |range| range.end)
    }
}

impl From<Range<u64>> for PassSet {
    fn from(range: Range<u64>) -> Self {
        let mut set = Self::default();
        set.insert(range);
        set
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
        let mut set = Self::default();
        if text.trim() == "none" {
            return Ok(set);
        }
        for part in text.split(',') {
            let (begin, end) = part.split_once("..").ok_or_else(error)?;
            let number = |text: &str| text.trim().parse::<u64>().map_err(|_| error());
            let range = number(begin)?..number(end)?;
            if range.is_empty() {
                return Err(error());
            }
            set.insert(range);
        }
        Ok(set)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        assert_eq!(set("0..4, 8..9").to_string(), "0..4, 8..9");
        assert_eq!(set("0..4, 8..9").first_missing(2), 4);
        assert_eq!(set("none"), PassSet::default());
    }

    #[test]
    fn other_texts_are_refused() {
        for text in [
            "", "4", "4..", "..4", "4..4", "8..4", "-1..4", "0..4,", "a..b",
        ] {
            assert!(text.parse::<PassSet>().is_err(), "{text}");
        }
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
            let first = (0..1000).find(|pass| !x.contains(pass)).unwrap();
            prop_assert_eq!(a.first_missing(0), first);
        }
    }
}
