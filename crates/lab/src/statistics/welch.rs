//! Welch's t-test that two renders have the same expectation, on means over blocks of pixels.
//!
//! With the means m, their variances v and the degrees of freedom ν of those variances
//! \[Press07, §14.2.1\]:
//!
//!   t = (m_a - m_b) / √(v_a + v_b),   ν = (v_a + v_b)² / (v_a² / ν_a + v_b² / ν_b).
//!
//! The smallest p-value of n tests is corrected to 1 - (1 - p)ⁿ \[Sidak67\], which is exact for independent
//! tests, and conservative for the correlated channels of one block. Larger blocks detect smaller
//! differences, and their means are closer to normal if pixels have heavy tails; small blocks detect local
//! differences. Callers that test several sizes have to share the level among them.
//!
//! Variances come from replicates ([`welch_test`]), or with the images themselves ([`z_test`]). The latter
//! adds the variances of a block's pixels, so pixels have to be uncorrelated, as with the independent sampler.
//! If few samples with heavy tails have too small a mean, their variance is too small, too; then replicates
//! are the better test.

use super::interval::mean_and_variance;
use super::students_t;
use crate::blocks::{Blocks, Tally};
use crate::image::Pixels;
use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize};
use statrs::distribution::ContinuousCDF;

/// The size of a block that covers any image.
pub const WHOLE: usize = usize::MAX;

/// Above this number of degrees of freedom, Student's t is approximated by a normal distribution.
const NORMAL_FREEDOM: f64 = 1e5;

/// An image with the variances of its pixels.
#[derive(Clone, Copy, Debug)]
pub struct Estimated<'a> {
    /// The estimates.
    pub mean: &'a Pixels,
    /// The variance of each estimate: of the mean, not of single samples.
    pub variance: &'a Pixels,
    /// The degrees of freedom of each variance: passes - 1, or infinite if it is known exactly.
    pub freedom: f64,
}

/// The most significant difference of two images. In JSON, which lacks such numbers, infinities and NaN are
/// null.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// The number of tests: three channels of every block.
    #[serde(default)]
    pub tests: usize,
    /// The p-value, corrected for the number of tests.
    pub p: f64,
    /// Left, top, right and bottom (exclusive) of the block. Unit: pixels.
    pub block: [usize; 4],
    /// Red, green or blue: 0, 1 or 2.
    pub channel: usize,
    /// The means of both images over the block.
    #[serde(deserialize_with = "numbers")]
    pub means: [f64; 2],
    /// The difference of the means. Unit: standard errors.
    #[serde(deserialize_with = "number")]
    pub deviations: f64,
}

impl Difference {
    /// Describes the place, such as `red of the pixels 0,0 to 8,8`.
    pub fn place(&self) -> String {
        let channel = ["red", "green", "blue"][self.channel % 3];
        let [left, top, right, bottom] = self.block;
        format!("{channel} of the pixels {left},{top} to {right},{bottom}")
    }
}

/// Reads a number; null is NaN.
fn number<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

/// Reads two numbers; null is NaN.
fn numbers<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 2], D::Error> {
    let numbers = <[Option<f64>; 2]>::deserialize(from)?;
    Ok(numbers.map(|number| number.unwrap_or(f64::NAN)))
}

/// Compares images with variances, in blocks of `block` × `block` pixels.
///
/// None: the four sizes are not the same, there are no pixels, or a variance has no freedom.
pub fn z_test(a: &Estimated<'_>, b: &Estimated<'_>, block: usize) -> Option<Difference> {
    let size = a.mean.size;
    let all = [a.mean, a.variance, b.mean, b.variance];
    let sizes_differ = all.iter().any(|pixels| pixels.size != size);
    if sizes_differ || a.freedom <= 0.0 || b.freedom <= 0.0 {
        return None;
    }
    let blocks = Blocks::new(size, block);
    worst(blocks, &a.moments(blocks), &b.moments(blocks))
}

/// Compares the replicates of two estimators: independent renders with the same number of samples.
///
/// None: an estimator has fewer than two replicates, sizes differ, or there are no pixels.
pub fn welch_test(a: &[Pixels], b: &[Pixels], block: usize) -> Option<Difference> {
    let size = a.first()?.size;
    let differ = a.iter().chain(b).any(|pixels| pixels.size != size);
    if differ || a.len() < 2 || b.len() < 2 {
        return None;
    }
    let blocks = Blocks::new(size, block);
    let moments = |replicates| moments_of_replicates(blocks, replicates);
    worst(blocks, &moments(a), &moments(b))
}

/// Computes the relative bias of one of two estimators, in the mean of any channel over the whole film,
/// that [`welch_test`] with [`WHOLE`] detects with a probability of at least 1/2 at `level`.
///
/// With ν of the test, and the level α of one of its three comparisons, the bias is
/// max_c t_{1 - α/2}(ν) √(v_a + v_b) / ½ (m_a + m_b).
///
/// None: the test is impossible, all channels are black, or a number is not finite.
pub fn smallest_bias(a: &[Pixels], b: &[Pixels], level: f64) -> Option<f64> {
    let tests = welch_test(a, b, WHOLE)?.tests as f64;
    // The level of each comparison, 1 - (1 - level)^(1/n) [Sidak67].
    let alpha = -libm::expm1(libm::log1p(-level) / tests);
    let blocks = Blocks::new(a.first()?.size, WHOLE);
    let moments = [a, b].map(|replicates| moments_of_replicates(blocks, replicates));
    let [a, b] = &moments;
    let lit = a.iter().zip(b).filter(|(a, b)| a.mean + b.mean != 0.0);
    let each = lit.map(|(a, b)| {
        let (variance, freedom) = sum_of_variances(*a, *b);
        let t = students_t(freedom).map_or(0.0, |distribution| {
            distribution.inverse_cdf(1.0 - 0.5 * alpha)
        });
        t * variance.sqrt() / (0.5 * (a.mean + b.mean)).abs()
    });
    let biases: Vec<f64> = each.collect();
    let largest = biases.iter().copied().max_by(f64::total_cmp)?;
    largest.is_finite().then_some(largest)
}

/// Computes the variance of a difference, and its degrees of freedom; NaN if the variance is zero.
fn sum_of_variances(a: Moments, b: Moments) -> (f64, f64) {
    let variance = a.variance + b.variance;
    let share = |moments: Moments| moments.variance * moments.variance / moments.freedom;
    // An estimate without variance contributes no degrees of freedom.
    let shares: f64 = [a, b]
        .into_iter()
        .filter(|m| m.variance > 0.0)
        .map(share)
        .sum();
    (variance, variance * variance / shares)
}

/// An estimate of the mean over a block.
#[derive(Clone, Copy, Debug)]
struct Moments {
    mean: f64,
    /// The variance of the mean.
    variance: f64,
    /// The degrees of freedom of the variance.
    freedom: f64,
}

impl Estimated<'_> {
    fn moments(&self, blocks: Blocks) -> Vec<Moments> {
        let means = blocks.sums(self.mean).into_iter();
        let of = |(mean, variance): (Tally, Tally)| Moments {
            mean: mean.mean(),
            variance: variance.sum / (variance.count * variance.count),
            // A sum of variances of ν degrees of freedom each has ν (Σ v)² / Σ v².
            freedom: self.freedom * variance.sum * variance.sum / variance.squares,
        };
        means.zip(blocks.sums(self.variance)).map(of).collect()
    }
}

fn moments_of_replicates(blocks: Blocks, replicates: &[Pixels]) -> Vec<Moments> {
    let sums: Vec<_> = replicates
        .iter()
        .map(|pixels| blocks.sums(pixels))
        .collect();
    let count = replicates.len() as f64;
    let of = |i: usize| {
        let (mean, variance) = mean_and_variance(sums.iter().map(|sums| sums[i].mean()));
        Moments {
            mean,
            variance: variance / count,
            freedom: count - 1.0,
        }
    };
    (0..sums[0].len()).map(of).collect()
}

/// Finds the most significant difference of two images.
fn worst(blocks: Blocks, a: &[Moments], b: &[Moments]) -> Option<Difference> {
    let each = a.par_iter().zip(b).map(|(a, b)| welch(*a, *b));
    let tests: Vec<(f64, f64)> = each.collect();
    let smallest = tests.iter().enumerate();
    let (index, &(p, deviations)) = smallest.min_by(|x, y| x.1.0.total_cmp(&y.1.0))?;
    Some(Difference {
        tests: tests.len(),
        p: corrected(p, tests.len()),
        block: blocks.place(index),
        channel: index % 3,
        means: [a[index].mean, b[index].mean],
        deviations,
    })
}

/// Computes the two-sided p-value of Welch's test, and the difference in standard errors.
///
/// Numbers that are not finite have p = 0.
fn welch(a: Moments, b: Moments) -> (f64, f64) {
    let (variance, freedom) = sum_of_variances(a, b);
    let difference = a.mean - b.mean;
    let scale = a.mean.abs() + b.mean.abs();
    // Estimates without variance must agree to rounding.
    if variance.sqrt() <= 1e-6 * scale || variance <= 0.0 {
        let agree = difference.abs() <= 1e-5 * scale;
        return (f64::from(agree), if agree { 0.0 } else { f64::INFINITY });
    }
    let t = difference / variance.sqrt();
    let p = tail(t.abs(), freedom);
    if p.is_finite() { (p, t) } else { (0.0, t) }
}

/// Computes the probability that Student's t lies beyond ±`t`; NaN if an argument is NaN.
fn tail(t: f64, freedom: f64) -> f64 {
    if t.is_nan() || freedom.is_nan() {
        return f64::NAN;
    }
    if freedom > NORMAL_FREEDOM {
        return libm::erfc(t * std::f64::consts::FRAC_1_SQRT_2);
    }
    students_t(freedom).map_or(f64::NAN, |distribution| 2.0 * distribution.cdf(-t))
}

/// Computes 1 - (1 - p)ⁿ, accurately also for small p \[Sidak67\].
fn corrected(p: f64, n: usize) -> f64 {
    -libm::expm1(n as f64 * libm::log1p(-p))
}

#[cfg(test)]
mod tests;
