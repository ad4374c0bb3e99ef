//! How many samples a part of training takes: 2¹⁴ where a sample costs no more than it usually does, and
//! fewer where subpaths are long. With w the mean work of a sample and w₀ the usual one, it is the power of
//! two just below
//!
//! 2¹⁴ (w₀ / w)²,
//!
//! and not below 2⁶: the longer subpaths are, the less time training takes, which is then the least of it.
//!
//! Training only estimates what estimators choose by, so fewer samples add no bias. Work is counted and
//! not timed: a scene is trained alike on every machine.

use crate::stats::Stats;

/// Enough for the mean luminance to within a few percent in most scenes.
const MOST: u64 = 1 << 14;
/// With fewer there is nothing to learn from.
const LEAST: u64 = 1 << 6;
/// The groups of [`MOST`] samples: some for every thread.
const GROUPS: u64 = 64;
/// So many samples share a light subpath in some plans: no group is smaller.
const SMALLEST_GROUP: u64 = 4;

/// A number of samples: a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Extent(u64);

impl Extent {
    /// As many samples where one makes `work`, and `usual` work is w₀. Unit: as [`work`].
    pub(super) fn new(usual: f64, work: f64) -> Self {
        let ratio = (usual / work.max(usual)).min(1.0);
        let samples = MOST as f64 * ratio * ratio;
        Self(1 << (samples as u64).max(LEAST).ilog2())
    }

    /// How many samples there are.
    pub(super) fn samples(self) -> u64 {
        self.0
    }

    /// How many of them make a group.
    pub(super) fn group(self) -> u64 {
        (self.0 / GROUPS).max(SMALLEST_GROUP)
    }

    /// How many groups that are.
    pub(super) fn groups(self) -> u64 {
        self.0 / self.group()
    }
}

/// The cost of samples. Unit: rays and connections.
pub(super) fn work(stats: &Stats) -> f64 {
    (stats.rays.total() + stats.candidates) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costly_samples_are_fewer() {
        for (work, samples) in [
            (0.0, MOST),
            (64.0, MOST),
            (65.0, MOST / 2),
            (128.0, MOST / 4),
            (512.0, 256),
            (1e9, LEAST),
            (f64::INFINITY, LEAST),
        ] {
            let extent = Extent::new(64.0, work);
            assert_eq!(extent.samples(), samples, "{work}");
            assert_eq!(extent.group() * extent.groups(), samples);
            assert!(extent.group() >= SMALLEST_GROUP && extent.groups() <= GROUPS);
        }
        assert_eq!(Extent::new(64.0, 1.0).group(), 256);
    }
}
