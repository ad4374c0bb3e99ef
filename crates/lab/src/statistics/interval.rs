//! The mean of independent values, with its confidence interval.

use super::t_quantile;
use serde::{Deserialize, Serialize};

/// A value between two bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The estimate.
    pub value: f64,
    /// The lower bound.
    pub low: f64,
    /// The upper bound.
    pub high: f64,
}

/// Computes the mean x̄ ± t s / √n of n independent values with standard deviation s, where t is the quantile
/// of Student's t distribution with n - 1 degrees of freedom \[Press07, §14.2\].
///
/// The interval is exact for normal values, and nearly so for means over whole images, even if pixels have
/// heavy tails. None: there are fewer than two values, or `confidence` is not in (0, 1).
pub fn mean_interval(values: &[f64], confidence: f64) -> Option<Interval> {
    let t = t_quantile(values.len(), confidence)?;
    let (mean, variance) = mean_and_variance(values.iter().copied());
    let half = t * (variance / values.len() as f64).sqrt();
    Some(Interval {
        value: mean,
        low: mean - half,
        high: mean + half,
    })
}

/// Computes the mean of values, and the unbiased estimate of their variance.
pub(super) fn mean_and_variance(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares = values.map(|value| (value - mean) * (value - mean));
    (mean, squares.sum::<f64>() / (n - 1.0))
}

#[cfg(test)]
mod tests {
    use super::super::simulation::normal;
    use super::*;

    #[test]
    fn an_interval_is_as_computed_by_hand() {
        // Mean 3, s = √2.5, t_{0.975}(4) = 2.776445105.
        let interval = mean_interval(&[1.0, 2.0, 3.0, 4.0, 5.0], 0.95).unwrap();
        let half = 2.776445105 * (2.5f64 / 5.0).sqrt();
        assert!((interval.value - 3.0).abs() < 1e-12);
        assert!((interval.high - 3.0 - half).abs() < 1e-7, "{interval:?}");
        assert!((interval.low - 3.0 + half).abs() < 1e-7, "{interval:?}");
    }

    #[test]
    fn too_few_values_have_no_interval() {
        assert_eq!(mean_interval(&[], 0.95), None);
        assert_eq!(mean_interval(&[1.0], 0.95), None);
        assert_eq!(mean_interval(&[1.0, 2.0], 1.0), None);
        assert!(mean_interval(&[1.0, f64::NAN], 0.95).unwrap().low.is_nan());
    }

    /// Of 4000 intervals from five normal values each, 95 % ± 1 % (three standard errors) contain 0.
    #[test]
    fn intervals_have_the_stated_confidence() {
        let holds = |trial: u64| {
            let values: Vec<f64> = normal(trial).take(5).collect();
            let interval = mean_interval(&values, 0.95).unwrap();
            interval.low <= 0.0 && 0.0 <= interval.high
        };
        let held = (0..4000).filter(|&trial| holds(trial)).count() as f64 / 4000.0;
        assert!((held - 0.95).abs() < 0.0104, "{held}");
    }
}
