//! Confidence intervals and tests.
//!
//! - [`mean_interval`]: the mean of a metric over independent seeds.
//! - [`ratio_interval`]: the ratio of the errors of two methods, paired by seed.
//! - [`welch_test`], [`z_test`]: tests that two renders have the same expectation, in every block of pixels.
//!
//! An interval of confidence 0.95 contains the true value in 95 of 100 repetitions of the whole experiment.
//! A p-value is the probability of a difference at least as large under equal expectations. Random numbers
//! come from [`bidir::sampler`] with a fixed seed, so that the same input gives the same output.

mod bootstrap;
mod interval;
mod ratio;
mod welch;

pub use interval::{Interval, mean_interval};
pub use ratio::{RATIOS, ratio_interval};
pub use welch::{Difference, Estimated, WHOLE, smallest_bias, welch_test, z_test};

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Makes Student's t distribution. None: `freedom` is not positive.
fn students_t(freedom: f64) -> Option<impl ContinuousCDF<f64, f64>> {
    StudentsT::new(0.0, 1.0, freedom).ok()
}

/// Computes the quantile of Student's t that t exceeds with probability (1 - confidence) / 2.
///
/// None: there are fewer than two values, or `confidence` is not in (0, 1).
fn t_quantile(count: usize, confidence: f64) -> Option<f64> {
    let possible = count >= 2 && confidence > 0.0 && confidence < 1.0;
    let distribution = students_t(count.checked_sub(1)? as f64).filter(|_| possible)?;
    Some(distribution.inverse_cdf(0.5 + 0.5 * confidence))
}

/// Random numbers for simulations.
#[cfg(test)]
mod simulation {
    use bidir::sampler::{Dimension, Domain, Purpose, Sampler, SamplerKind};

    /// Generates independent standard normal numbers; different streams are independent.
    pub(super) fn normal(stream: u64) -> impl Iterator<Item = f64> {
        let sampler = Sampler::new(SamplerKind::Independent, 1);
        (0..).map(move |index| {
            let point = sampler.stream(Domain::Camera, stream, index);
            let uv = point.get_2d(Dimension::at(0, Purpose::Scatter));
            let [u, v] = [uv.x, uv.y].map(f64::from);
            // Box and Muller's transform, with 1 - u > 0.
            (-2.0 * libm::log(1.0 - u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
        })
    }
}
