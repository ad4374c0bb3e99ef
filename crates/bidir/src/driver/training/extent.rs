//! How many samples a part of training takes: n = 2¹⁴ where a sample costs what it usually does, and
//! fewer where subpaths are so long that n samples would cost more than a given work W. With w the mean
//! work of a sample, n is the power of two just below W / w, and not below 2⁶.
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
    /// As many samples as make `work`, where one makes `of_sample`. Unit: as [`work`].
    pub(super) fn within(work: f64, of_sample: f64) -> Self {
        let samples = (work / of_sample.max(1.0)) as u64;
        Self((1 << samples.max(LEAST).ilog2()).min(MOST))
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

/// What samples cost. Unit: rays and connections.
pub(super) fn work(stats: &Stats) -> f64 {
    (stats.rays.total() + stats.candidates) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costly_samples_are_fewer() {
        let work = 1024.0 * MOST as f64;
        for (of_sample, samples) in [
            (0.0, MOST),
            (1024.0, MOST),
            (1025.0, MOST / 2),
            (2048.0, MOST / 2),
            (1e5, 128),
            (1e9, LEAST),
            (f64::INFINITY, LEAST),
        ] {
            let extent = Extent::within(work, of_sample);
            assert_eq!(extent.samples(), samples, "{of_sample}");
            assert_eq!(extent.group() * extent.groups(), samples);
            assert!(extent.group() >= SMALLEST_GROUP && extent.groups() <= GROUPS);
        }
        assert_eq!(Extent::within(work, 1.0).group(), 256);
    }
}
