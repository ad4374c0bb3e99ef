//! Student's t-tests: do the means of two estimators, each over its replicates, differ by chance alone?

use statrs::distribution::{ContinuousCDF, StudentsT};

/// The random numbers of two estimators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RandomNumbers {
    /// Unrelated ones, or ones whose relation is not used: Welch's test.
    Own,
    /// The same in replicates of the same number: the paired test, whose variance is that of the
    /// differences. It holds whatever the correlation, and the larger that is the more it sees.
    Common,
}

/// An estimate of a mean.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moments {
    pub(super) mean: f64,
    /// Of the mean, not of the values.
    pub(super) variance: f64,
}

impl Moments {
    pub(super) fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let n = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / n;
        let square = values.map(|value| (value - mean) * (value - mean));
        Self {
            mean,
            variance: square.sum::<f64>() / (n - 1.0) / n,
        }
    }
}

/// The two-sided p-value of two estimators, given the values of their replicates, and both means.
pub(super) fn p_value(a: &[f64], b: &[f64], numbers: RandomNumbers) -> (f64, [f64; 2]) {
    let [x, y] = [a, b].map(|values| Moments::of(values.iter().copied()));
    let freedom = a.len() as f64 - 1.0;
    let (variance, freedom) = match numbers {
        RandomNumbers::Own => {
            let squares = x.variance * x.variance + y.variance * y.variance;
            let variance = x.variance + y.variance;
            (variance, variance * variance / squares * freedom)
        }
        RandomNumbers::Common => {
            let differences = a.iter().zip(b).map(|(a, b)| a - b);
            (Moments::of(differences).variance, freedom)
        }
    };
    let (difference, scale) = (x.mean - y.mean, x.mean.abs() + y.mean.abs());
    (
        two_sided(difference, variance.sqrt(), freedom, scale),
        [x.mean, y.mean],
    )
}

/// The probability of a mean at least as far from zero, by chance. Means that vary by less than rounding
/// does, compared with `scale`, have to be zero but for rounding.
fn two_sided(mean: f64, deviation: f64, freedom: f64, scale: f64) -> f64 {
    if deviation <= 1e-6 * scale {
        return f64::from(mean.abs() <= 1e-5 * scale);
    }
    let distribution = StudentsT::new(0.0, 1.0, freedom).expect("freedom is positive");
    2.0 * distribution.cdf(-(mean / deviation).abs())
}

/// 1 - (1 - p)ⁿ, exact for small p too [Sidak67].
pub(super) fn corrected(p: f64, n: usize) -> f64 {
    -libm::expm1(n as f64 * libm::log1p(-p))
}
