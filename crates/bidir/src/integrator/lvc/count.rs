//! How many vertices of the light cache a camera vertex weighs.

use std::fmt;
use std::str::FromStr;

/// M, from 1 to [`CandidateCount::MAX`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CandidateCount(u16);

impl CandidateCount {
    /// The most: candidates of a sample are in memory together, M for each of its camera vertices.
    pub const MAX: u16 = 4096;

    /// M.
    #[inline]
    pub fn get(self) -> u16 {
        self.0
    }
}

impl Default for CandidateCount {
    fn default() -> Self {
        Self(4)
    }
}

/// Why a number of candidates cannot be read.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("`{0}` is no number of candidates: expected a whole number from 1 to {max}", max = CandidateCount::MAX)]
pub struct CandidateCountError(String);

impl FromStr for CandidateCount {
    type Err = CandidateCountError;

    fn from_str(text: &str) -> Result<Self, CandidateCountError> {
        let count = text.parse().ok();
        let count = count.filter(|count| (1..=Self::MAX).contains(count));
        count
            .map(Self)
            .ok_or_else(|| CandidateCountError(text.to_owned()))
    }
}

impl fmt::Display for CandidateCount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_and_written() {
        for text in ["1", "4", "4096"] {
            assert_eq!(text.parse::<CandidateCount>().unwrap().to_string(), text);
        }
        for text in ["", "0", "-1", "4097", "99999999999", "x"] {
            assert!(text.parse::<CandidateCount>().is_err(), "{text}");
        }
    }
}
