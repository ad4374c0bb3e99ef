//! The number of samples of training: 2¹⁴ where a sample costs no more than it usually does, and
//! fewer where subpaths are long. With w the mean work of a sample and w₀ the usual one, it is the
//! largest power of two that is at most
//!
//! 2¹⁴ (w₀ / w)²,
//!
//! and at least the first samples, which measure that work. So training takes less time where subpaths are longer.
//! Films of fewer than 2¹⁰ pixels get no more than 16 samples for each pixel, but no fewer than 2¹⁰ for that
//! reason: training does not take much longer than their render, and a crop of four pixels is spread evenly.
//!
//! Training only estimates what estimators choose by, so fewer samples add no bias. Work is counted and
//! not timed: a scene is trained alike on every machine.

use super::constants::{ENOUGH_SAMPLES, FIRST_SAMPLES, MOST_OF_PIXEL, MOST_SAMPLES, USUAL_WORK};
use crate::stats::Stats;

/// Returns the number of samples by the pixels and the work of a sample: a power of two. Unit of work: as
/// [`work`].
pub(super) fn samples(pixels: u64, work: f64) -> u64 {
    let ratio = USUAL_WORK / work.max(USUAL_WORK);
    let affordable = MOST_SAMPLES as f64 * ratio * ratio;
    let most = pixels.saturating_mul(MOST_OF_PIXEL).max(ENOUGH_SAMPLES);
    1 << (affordable as u64).min(most).max(FIRST_SAMPLES).ilog2()
}

/// Returns the mean cost of a sample. Unit: rays and connections.
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
