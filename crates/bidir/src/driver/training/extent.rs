//! The number of samples of training: 2¹⁴ if the mean work w of a sample is at most the usual work w₀, and fewer
//! where subpaths are long: the largest power of two that is at most
//!
//! 2¹⁴ (w₀ / w)²,
//!
//! and at least the number of the first samples, which measure w. So training takes less time where subpaths are
//! longer. Films of fewer than 2¹⁰ pixels get at most 16 samples for each pixel, or 2¹⁰ if that is more: training
//! does not take much longer than their render, and the samples of a crop of four pixels are spread evenly.
//!
//! Training only guides estimators, so fewer samples add no bias. Work is counted, not timed: training is the same on
//! every machine.

use super::constants::{ENOUGH_SAMPLES, FIRST_SAMPLES, MOST_OF_PIXEL, MOST_SAMPLES, USUAL_WORK};
use crate::stats::Stats;

/// Returns the number of samples, a power of two, for a film of `pixels` pixels and samples of mean work `work`. Unit
/// of work: as [`work`].
pub(super) fn samples(pixels: u64, work: f64) -> u64 {
    let ratio = USUAL_WORK / work.max(USUAL_WORK);
    let affordable = MOST_SAMPLES as f64 * ratio * ratio;
    let most = pixels.saturating_mul(MOST_OF_PIXEL).max(ENOUGH_SAMPLES);
    1 << (affordable as u64).min(most).max(FIRST_SAMPLES).ilog2()
}

/// Returns the mean work of a sample. Unit: rays and connections.
pub(super) fn work(stats: &Stats) -> f64 {
    (stats.rays.total() + stats.candidates) as f64 / stats.samples as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costly_samples_are_fewer() {
        for (work, expected) in [
            (0.0, MOST_SAMPLES),
            (256.0, MOST_SAMPLES),
            (260.0, MOST_SAMPLES / 2),
            (512.0, MOST_SAMPLES / 4),
            (2048.0, 256),
            (1e9, FIRST_SAMPLES),
            (f64::INFINITY, FIRST_SAMPLES),
        ] {
            assert_eq!(samples(u64::MAX, work), expected, "{work}");
        }
    }

    #[test]
    fn small_films_have_fewer_samples() {
        for (pixels, expected) in [
            (1, ENOUGH_SAMPLES),
            (127, ENOUGH_SAMPLES),
            (128, 2048),
            (1024, MOST_SAMPLES),
        ] {
            assert_eq!(samples(pixels, 0.0), expected, "{pixels}");
        }
    }
}
