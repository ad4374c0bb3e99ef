//! How a light vertex cache is made and used.

use crate::names::{as_text, named};
use std::fmt;
use std::str::FromStr;

/// The settings of [`Method::Lvc`](super::Method::Lvc).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LvcSettings {
    /// M: how many vertices of the cache are candidates for each camera vertex.
    pub candidates: CandidateCount,
    /// How many light points next-event estimation draws for each camera vertex.
    pub next_events: CandidateCount,
    /// How vertices of the cache are chosen.
    pub proposal: ProposalKind,
    /// How light subpaths choose the light that they begin on.
    pub light_start: LightStart,
    /// How many samples bring one light subpath to the cache.
    pub samples_per_subpath: SamplesPerSubpath,
}

impl Default for LvcSettings {
    fn default() -> Self {
        Self {
            candidates: CandidateCount::DEFAULT,
            next_events: CandidateCount::NEXT_EVENTS,
            proposal: ProposalKind::default(),
            light_start: LightStart::default(),
            samples_per_subpath: SamplesPerSubpath::default(),
        }
    }
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

named!(ProposalKind {
    "uniform" => Uniform,
    "learned" => Learned,
});

/// How light subpaths choose the light that they begin on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightStart {
    /// By power.
    Power,
    /// By what training found subpaths to contribute.
    #[default]
    Learned,
}

named!(LightStart {
    "power" => Power,
    "learned" => Learned,
});

/// How many candidates or light points the vertices of camera subpaths have, from 1 to [`CandidateCount::MAX`]: the
/// first vertex of a subpath, which the pixel's noise depends on most, and those behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CandidateCount {
    first: u16,
    deeper: u16,
}

impl CandidateCount {
    /// The most: candidates of a batch are in memory together, M for each camera vertex.
    pub const MAX: u16 = 4096;
    /// The number of candidates that suits most scenes.
    pub const DEFAULT: Self = Self::new(12, 1);
    /// The number of light points that suits most scenes.
    pub const NEXT_EVENTS: Self = Self::new(2, 1);

    /// Returns `first` and `deeper`, brought into the range.
    pub const fn new(first: u16, deeper: u16) -> Self {
        Self {
            first: Self::in_range(first),
            deeper: Self::in_range(deeper),
        }
    }

    /// Returns `count` for every vertex, brought into the range.
    pub const fn of(count: u16) -> Self {
        Self::new(count, count)
    }

    const fn in_range(count: u16) -> u16 {
        match count {
            0 => 1,
            1..=Self::MAX => count,
            _ => Self::MAX,
        }
    }

    /// Returns M of the last vertex of a camera subpath of `t` ≥ 2 vertices, the lens point among them.
    #[inline]
    pub fn at(self, t: usize) -> u16 {
        if t == 2 { self.first } else { self.deeper }
    }

    /// Returns M of the first vertex, and of those behind it.
    pub fn get(self) -> [u16; 2] {
        [self.first, self.deeper]
    }
}

/// A number of samples, a power of two from 1 to [`SamplesPerSubpath::MAX`], so that groups of samples
/// have whole numbers of light subpaths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplesPerSubpath(u16);

impl SamplesPerSubpath {
    /// The most: a group has one subpath at the least.
    pub const MAX: u16 = 256;

    /// Returns 2^`exponent`, or the most.
    pub const fn power_of_two(exponent: u32) -> Self {
        match 1u16.checked_shl(exponent) {
            Some(count) if count <= Self::MAX => Self(count),
            _ => Self(Self::MAX),
        }
    }

    /// Returns the least number that is neither below this one nor below `count`, or the most.
    #[must_use]
    pub fn or_more(self, count: f64) -> Self {
        let count = (count.ceil() as u32).next_power_of_two();
        Self::power_of_two(count.max(self.0.into()).ilog2())
    }

    /// Returns the most that is neither above this one nor above `count`, which is positive.
    #[must_use]
    pub fn or_fewer(self, count: u64) -> Self {
        Self::power_of_two(count.min(self.0.into()).ilog2())
    }

    /// Returns the number.
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

impl FromStr for CandidateCount {
    type Err = CountError;

    fn from_str(text: &str) -> Result<Self, CountError> {
        let expected = "a whole number from 1 to 4096, or two of them as in `8,1`";
        let count = |part: &str| {
            let is_valid = |count: &u16| (1..=Self::MAX).contains(count);
            part.parse().ok().filter(is_valid)
        };
        let (first, deeper) = text.split_once(',').unwrap_or((text, text));
        match (count(first), count(deeper)) {
            (Some(first), Some(deeper)) => Ok(Self::new(first, deeper)),
            _ => Err(CountError {
                given: text.to_owned(),
                expected,
            }),
        }
    }
}

impl FromStr for SamplesPerSubpath {
    type Err = CountError;

    fn from_str(text: &str) -> Result<Self, CountError> {
        let is_valid = |count: &u16| count.is_power_of_two() && *count <= Self::MAX;
        let count = text.parse().ok().filter(is_valid);
        count.map(Self).ok_or_else(|| CountError {
            given: text.to_owned(),
            expected: "a power of two from 1 to 256",
        })
    }
}

impl fmt::Display for CandidateCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self { first, deeper } if first == deeper => write!(f, "{first}"),
            Self { first, deeper } => write!(f, "{first},{deeper}"),
        }
    }
}

as_text!(CandidateCount);
as_text!(SamplesPerSubpath);

impl fmt::Display for SamplesPerSubpath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::check_texts;

    #[test]
    fn numbers_are_read_and_written() {
        let bad = "|0|-1|4097|99999999999|x|1,|,1|8,0|8,1,1|8, 1".split('|');
        let bad: Vec<_> = bad.collect();
        check_texts::<CandidateCount>(&["1", "3", "4096", "8,1", "1,4096"], &bad);
        let bad = ["", "0", "-2", "3", "512", "65536", "x"];
        check_texts::<SamplesPerSubpath>(&["1", "8", "256"], &bad);
        let error = "0".parse::<SamplesPerSubpath>().unwrap_err().to_string();
        assert!(error.contains("from 1 to 256"), "{error}");
    }

    #[test]
    fn fewer_subpaths_are_asked_for_by_powers_of_two() {
        let two = SamplesPerSubpath::default();
        for (count, expected) in [(0.0, 2), (2.0, 2), (2.1, 4), (64.0, 64), (1e9, 256)] {
            assert_eq!(two.or_more(count).get(), expected);
        }
    }

    #[test]
    fn the_first_vertex_has_its_own_number() {
        let counts = CandidateCount::new(7, 2);
        assert_eq!([2, 3, 4, 60].map(|t| counts.at(t)), [7, 2, 2, 2]);
        let most = CandidateCount::new(0, u16::MAX).get();
        assert_eq!(most, [1, CandidateCount::MAX]);
    }
}
