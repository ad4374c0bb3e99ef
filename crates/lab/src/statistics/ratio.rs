//! The ratio of two methods' errors, paired by seed.
//!
//! With the errors a_i and b_i of two methods under seed i, the value is the geometric mean of the ratios,
//! exp(mean ln(a_i / b_i)): the factors 2 and ½ cancel, and so do the scale of the scene and variations
//! that both methods share under a seed.
//!
//! The interval comes from an interval of the mean log-ratio:
//!
//! - with fewer than [`FEWEST`] pairs, or at a confidence beyond the bootstrap's resamples, Student's t
//!   interval, which is exact for any number of normal log-ratios;
//! - otherwise the [expanded percentile bootstrap](super::bootstrap), which adapts to skewed log-ratios.
//!
//! A few values carry little information about their skewness: the means of resamples of three values lie
//! between these values, and plain or expanded percentiles of 95 % contain the expectation in only 3 of 4
//! cases \[Hesterberg15\]. Student's interval suffers less: with log-normal log-ratios of σ = ½, it contains
//! the expectation in 91 of 100 cases, as does the bootstrap of ten.

use super::bootstrap;
use super::{Interval, mean_interval};

/// The smallest number of pairs for a bootstrap interval.
const FEWEST: usize = 10;

/// The description of the method for reports.
pub const RATIOS: &str = "Ratios are geometric means over seeds, paired by seed. Their intervals are \
    Student's, of the logarithms, where there are fewer than ten seeds or resamples do not reach the \
    quantile, and expanded percentile bootstraps of the logarithms elsewhere.";

/// Computes the geometric mean of the ratios `a_i / b_i` with its interval.
///
/// None: there are fewer than two ratios, one is not positive and finite, or `confidence` is not in (0, 1).
pub fn ratio_interval(ratios: &[f64], confidence: f64) -> Option<Interval> {
    let usable = |ratio: &f64| *ratio > 0.0 && ratio.is_finite();
    if !ratios.iter().all(usable) {
        return None;
    }
    let logs: Vec<f64> = ratios.iter().copied().map(libm::log).collect();
    let student = mean_interval(&logs, confidence)?;
    let resampled = (logs.len() >= FEWEST).then(|| bootstrap::bounds(&logs, confidence));
    let [low, high] = resampled.flatten().unwrap_or([student.low, student.high]);
    Some(Interval {
        value: libm::exp(student.value),
        low: libm::exp(low),
        high: libm::exp(high),
    })
}

#[cfg(test)]
mod tests {
    use super::super::simulation::normal;
    use super::*;

    #[test]
    fn a_constant_ratio_is_certain() {
        for count in [3, FEWEST] {
            let interval = ratio_interval(&vec![2.0; count], 0.95).unwrap();
            for bound in [interval.value, interval.low, interval.high] {
                assert!((bound - 2.0).abs() < 1e-12, "{interval:?}");
            }
        }
    }

    #[test]
    fn values_without_ratios_have_no_interval() {
        for ratios in [
            &[1.0][..],
            &[1.0, 0.0],
            &[1.0, -1.0],
            &[1.0, f64::INFINITY],
            &[1.0, f64::NAN],
        ] {
            assert_eq!(ratio_interval(ratios, 0.95), None, "{ratios:?}");
        }
        assert_eq!(ratio_interval(&[1.0; 20], 1.0), None);
    }

    #[test]
    fn exchanging_the_methods_inverts_the_interval() {
        let a = [1.0, 1.3, 0.8, 1.1, 2.0, 0.9, 1.2, 1.0, 1.4, 0.6];
        let b = [0.7, 0.9, 0.9, 0.8, 1.0, 0.7, 1.1, 0.8, 1.3, 0.9];
        for count in [6, a.len()] {
            let ratios: Vec<f64> = a.iter().zip(b).take(count).map(|(a, b)| a / b).collect();
            let inverse: Vec<f64> = ratios.iter().map(|ratio| 1.0 / ratio).collect();
            let forth = ratio_interval(&ratios, 0.9).unwrap();
            let back = ratio_interval(&inverse, 0.9).unwrap();
            assert!((forth.value * back.value - 1.0).abs() < 1e-12);
            assert!((forth.low * back.high - 1.0).abs() < 1e-12);
            assert_eq!(forth, ratio_interval(&ratios, 0.9).unwrap());
        }
    }

    /// Log-ratios ±1 and 0: mean 0, s = 1, t_{0.975}(2) = 4.302652730.
    #[test]
    fn few_seeds_have_students_interval() {
        let ratios = [-1.0, 0.0, 1.0].map(libm::exp);
        let interval = ratio_interval(&ratios, 0.95).unwrap();
        let half = 4.302652730 / 3f64.sqrt();
        assert!(
            (libm::log(interval.high) - half).abs() < 1e-7,
            "{interval:?}"
        );
        assert!(
            (libm::log(interval.low) + half).abs() < 1e-7,
            "{interval:?}"
        );
    }

    /// Beyond the quantiles that resamples reach, Student's interval replaces the most extreme mean.
    #[test]
    fn more_confidence_is_a_wider_interval() {
        let ratios: Vec<f64> = normal(7).take(12).map(|z| libm::exp(0.1 * z)).collect();
        let mut width = 0.0;
        for confidence in [0.5, 0.9, 0.95, 0.99, 0.999, 0.9999, 1.0 - 1e-6] {
            let interval = ratio_interval(&ratios, confidence).unwrap();
            let wider = libm::log(interval.high / interval.low);
            assert!(wider > 1.02 * width, "{confidence}: {interval:?}");
            width = wider;
        }
    }

    /// Returns the fraction of `trials` intervals from `count` log-ratios that contain the expectation,
    /// `center`.
    fn coverage(count: usize, trials: u64, center: f64, of_normal: impl Fn(f64) -> f64) -> f64 {
        let holds = |trial: u64| {
            let logs = normal(trial).take(count).map(&of_normal);
            let ratios: Vec<f64> = logs.map(libm::exp).collect();
            let interval = ratio_interval(&ratios, 0.95).unwrap();
            let expected = libm::exp(center);
            interval.low <= expected && expected <= interval.high
        };
        (0..trials).filter(|&trial| holds(trial)).count() as f64 / trials as f64
    }

    /// Numbers of seeds with their trials; bootstraps take longer.
    const COUNTS: [(usize, u64); 5] = [(3, 4000), (4, 4000), (6, 4000), (10, 1500), (20, 800)];

    /// The tolerance is three standard errors: a level of 0.0027 for each number of seeds.
    #[test]
    fn intervals_have_the_stated_confidence() {
        for (count, trials) in COUNTS {
            let held = coverage(count, trials, 0.3, |z| 0.3 + 0.2 * z);
            let allowed = 3.0 * (0.95 * 0.05 / trials as f64).sqrt();
            assert!((held - 0.95).abs() < allowed, "{count} seeds: {held}");
        }
    }

    /// Log-ratios are log-normal with σ = ½; no interval from few of them has its exact confidence.
    #[test]
    fn intervals_of_skewed_ratios_nearly_have_the_stated_confidence() {
        for (count, trials) in COUNTS {
            let held = coverage(count, trials, libm::exp(0.125), |z| libm::exp(0.5 * z));
            assert!(held > 0.89 && held < 0.95, "{count} seeds: {held}");
        }
    }
}
