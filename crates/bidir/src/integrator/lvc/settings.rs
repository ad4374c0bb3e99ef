//! How a light vertex cache is made and used.

use crate::path::MisCount;
use std::fmt;
use std::str::FromStr;

/// What [`Lvc`](super::Lvc) can be told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LvcSettings {
    /// M: how many vertices of the cache are candidates for each camera vertex.
    pub candidates: CandidateCount,
    /// How they are chosen.
    pub proposal: ProposalKind,
    /// How many samples bring one light subpath to the cache.
    pub samples_per_subpath: SamplesPerSubpath,
    /// What weights take for the number of samples of a strategy.
    pub mis_count: MisCount,
}

/// How vertices of the cache are proposed to camera vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProposalKind {
    /// Each is as likely as others.
    Uniform,
    /// By what training found to contribute, from place to place.
    #[default]
    Learned,
}

impl ProposalKind {
    /// Every kind with its name on the command line.
    pub const NAMES: [(&'static str, Self); 2] =
        [("uniform", Self::Uniform), ("learned", Self::Learned)];
}

/// A number of candidates, from 1 to [`CandidateCount::MAX`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CandidateCount(u16);

impl CandidateCount {
    /// The most: candidates of a sample are in memory together, M for each of its camera vertices.
    pub const MAX: u16 = 4096;

    /// `count`, brought into the range.
    pub const fn of(count: u16) -> Self {
        match count {
            0 => Self(1),
            1..=Self::MAX => Self(count),
            _ => Self(Self::MAX),
        }
    }

    /// M.
    #[inline]
    pub fn get(self) -> u16 {
        self.0
    }
}

impl Default for CandidateCount {
    fn default() -> Self {
        Self::of(2)
    }
}

/// A number of samples, a power of two from 1 to [`SamplesPerSubpath::MAX`], so that groups of samples
/// have whole numbers of light subpaths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplesPerSubpath(u16);

impl SamplesPerSubpath {
    /// The most: a group has one subpath at the least.
    pub const MAX: u16 = 256;

    /// 2^`exponent`, or the most.
    pub const fn power_of_two(exponent: u32) -> Self {
        match 1u16.checked_shl(exponent) {
            Some(count) if count <= Self::MAX => Self(count),
            _ => Self(Self::MAX),
        }
    }

    /// The number.
    #[inline]
    pub fn get(self) -> u16 {
        self.0
    }
}

impl Default for SamplesPerSubpath {
    fn default() -> Self {
        Self::power_of_two(1)
    }
}

/// Why a number cannot be read.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("`{given}`: expected {expected}")]
pub struct CountError {
    given: String,
    expected: &'static str,
}

/// The number in `text`, if it `is_valid`.
fn read(
    text: &str,
    is_valid: impl Fn(&u16) -> bool,
    expected: &'static str,
) -> Result<u16, CountError> {
    let count = text.parse().ok().filter(is_valid);
    count.ok_or_else(|| CountError {
        given: text.to_owned(),
        expected,
    })
}

impl FromStr for CandidateCount {
    type Err = CountError;

    fn from_str(text: &str) -> Result<Self, CountError> {
        let is_valid = |count: &u16| (1..=Self::MAX).contains(count);
        read(text, is_valid, "a whole number from 1 to 4096").map(Self)
    }
}

impl FromStr for SamplesPerSubpath {
    type Err = CountError;

    fn from_str(text: &str) -> Result<Self, CountError> {
        let is_valid = |count: &u16| count.is_power_of_two() && *count <= Self::MAX;
        read(text, is_valid, "a power of two from 1 to 256").map(Self)
    }
}

impl fmt::Display for CandidateCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Display for SamplesPerSubpath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check<T: FromStr<Err = CountError> + fmt::Display>(good: &[&str], bad: &[&str], most: u16) {
        for text in good {
            assert_eq!(
                text.parse::<T>().map(|count| count.to_string()).as_deref(),
                Ok(*text)
            );
        }
        for text in bad {
            let error = text.parse::<T>().map(|_| ()).unwrap_err().to_string();
            assert!(error.ends_with(&format!("from 1 to {most}")), "{error}");
        }
    }

    #[test]
    fn numbers_are_read_and_written() {
        let bad = ["", "0", "-1", "4097", "99999999999", "x"];
        check::<CandidateCount>(&["1", "3", "4096"], &bad, CandidateCount::MAX);
        let bad = ["", "0", "-2", "3", "512", "65536", "x"];
        check::<SamplesPerSubpath>(&["1", "8", "256"], &bad, SamplesPerSubpath::MAX);
    }
}
