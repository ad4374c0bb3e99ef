//! Roulette of walks: value / q with probability q, else nothing. Unbiased for every q > 0; the
//! choice is only one of variance and cost. Shadow rays have a roulette of their own
//! ([`crate::select`]).

use crate::names::as_text;
use std::fmt;
use std::str::FromStr;

/// How walks end at random.
///
/// Bounces are counted along the walk: bounce 0 is the scattering at its first surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathRoulette {
    /// From bounce `start` on, a walk survives with the albedo that it meets. The probability is
    /// local, so it is part of the densities in both directions.
    Albedo {
        /// The first bounce that may end a walk.
        start: u32,
    },
    /// From bounce `start` on, a walk survives with its throughput, up to 1. The probability
    /// depends on the walk's history, so it is in no density.
    Throughput {
        /// The first bounce that may end a walk.
        start: u32,
    },
    /// Walks end by the limit of path length, or by escaping.
    Off,
}

impl Default for PathRoulette {
    fn default() -> Self {
        Self::Albedo { start: 0 }
    }
}

impl PathRoulette {
    /// Returns the probability that a walk goes on at `bounce`. `throughput` is relative to the walk's
    /// start and includes the scattering at hand.
    #[inline]
    pub fn survival_prob(self, bounce: usize, albedo: f32, throughput: f32) -> f32 {
        match self {
            Self::Albedo { .. } => self.density_factor(bounce, || albedo),
            Self::Throughput { start } if bounce >= start as usize => throughput.clamp(0.0, 1.0),
            Self::Throughput { .. } | Self::Off => 1.0,
        }
    }

    /// Returns the part of the survival probability that belongs to the density of the next vertex. The
    /// albedo is asked for where it matters.
    #[inline]
    pub fn density_factor(self, bounce: usize, albedo: impl FnOnce() -> f32) -> f32 {
        match self {
            Self::Albedo { start } if bounce < start as usize => 1.0,
            Self::Albedo { .. } => albedo().clamp(0.0, 1.0),
            Self::Throughput { .. } | Self::Off => 1.0,
        }
    }

    /// Returns the first bounce that changes a density; None: none does.
    #[inline]
    pub(super) fn density_start(self) -> Option<usize> {
        match self {
            Self::Albedo { start } => Some(start as usize),
            Self::Throughput { .. } | Self::Off => None,
        }
    }
}

/// Why a roulette cannot be read.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("`{0}` is no roulette: expected `albedo[:START]`, `throughput[:START]`, `off`")]
pub struct PathRouletteError(String);

impl FromStr for PathRoulette {
    type Err = PathRouletteError;

    fn from_str(text: &str) -> Result<Self, PathRouletteError> {
        let error = || PathRouletteError(text.to_owned());
        let (name, start) = match text.split_once(':') {
            Some((name, start)) => (name, Some(start.parse::<u32>().map_err(|_| error())?)),
            None => (text, None),
        };
        match (name, start) {
            ("albedo", start) => Ok(Self::Albedo {
                start: start.unwrap_or(0),
            }),
            ("throughput", start) => Ok(Self::Throughput {
                start: start.unwrap_or(0),
            }),
            ("off", None) => Ok(Self::Off),
            _ => Err(error()),
        }
    }
}

as_text!(PathRoulette);

impl fmt::Display for PathRoulette {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Albedo { start } => write!(f, "albedo:{start}"),
            Self::Throughput { start } => write!(f, "throughput:{start}"),
            Self::Off => write!(f, "off"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{check_near, check_texts};

    #[test]
    fn names_are_read_and_written() {
        let good = ["albedo:0", "albedo:3", "throughput:2", "off"];
        check_texts::<PathRoulette>(&good, &["", "albedo:", "off:2", "throughput:x"]);
        assert_eq!("albedo".parse(), Ok(PathRoulette::Albedo { start: 0 }));
    }

    #[test]
    fn only_local_probabilities_are_in_densities() {
        let albedo = PathRoulette::Albedo { start: 1 };
        let throughput = PathRoulette::Throughput { start: 0 };
        for (found, expected) in [
            (albedo.survival_prob(1, 0.3, 0.9), 0.3),
            (albedo.density_factor(1, || 0.3), 0.3),
            (albedo.density_factor(0, || 0.3), 1.0),
            (throughput.survival_prob(0, 0.3, 0.9), 0.9),
            (throughput.density_factor(0, || 0.3), 1.0),
        ] {
            check_near(found, expected, 1e-6, "a probability");
        }
    }
}
