//! Error metrics of an image against a reference: for every pixel, and as one number.
//!
//! A pixel q has the channels a in the image and b in the reference; ε = 0.01 throughout.
//!
//! | metric | error e_q of a pixel | number |
//! |---|---|---|
//! | `rmse` | √mean_c (a - b)² | √mean_q e_q² |
//! | `relmse` | mean_c (a - b)² / (b² + ε) | mean_q e_q |
//! | `relmse_block` | mean_c (ā - b̄)² / (b̄² + ε), means ā, b̄ over the pixel's block | mean_q e_q |
//! | `mape` | mean_c \|a - b\| / (\|b\| + ε) | mean_q e_q |
//! | `flip`, `flip_hdr` | see [`crate::flip`] | mean_q e_q |
//!
//! `rmse_trim` and `relmse_trim` exclude the *worst pixels*: of n pixels, the ⌈0.001 n⌉ with the largest
//! error of that metric. A single very bright pixel can dominate a mean square; trimmed metrics describe all
//! other pixels. They are biased downwards and complement the full metrics, never replace them.
//!
//! `relmse_block` compares means over *blocks* of 16 × 16 pixels, counted from the top left; blocks at the
//! right and lower border are smaller, and the weight of a block is its number of pixels. Uncorrelated noise
//! of pixels averages out within a block; noise that neighbours share, such as from common light subpaths,
//! remains.
//!
//! A metric is not finite if one of its pixels is not. Such a pixel counts as the worst error, so that trimming
//! excludes it. A metric over no pixels is NaN.

mod map;

pub use map::ErrorMap;

use crate::flip;
use crate::image::Pair;

/// The ε of all relative metrics.
const EPSILON: f64 = 0.01;
/// The side of a block. Unit: pixels.
const BLOCK: usize = 16;

/// An error metric; 0 for equal images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// The root of the mean square error.
    Rmse,
    /// The root of the mean square error without the worst pixels.
    RmseTrimmed,
    /// The mean relative square error.
    Relmse,
    /// The mean relative square error without the worst pixels.
    RelmseTrimmed,
    /// The mean relative square error of means over blocks of pixels.
    RelmseBlock,
    /// The mean absolute relative error.
    Mape,
    /// FLIP on a screen that shows [0, 1].
    Flip,
    /// The largest FLIP over several exposures.
    FlipHdr,
}

/// The pixels included in a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    All,
    WithoutWorst,
}

impl Metric {
    /// Every metric with its name.
    pub const NAMES: [(&'static str, Self); 8] = [
        ("rmse", Self::Rmse),
        ("relmse", Self::Relmse),
        ("rmse_trim", Self::RmseTrimmed),
        ("relmse_trim", Self::RelmseTrimmed),
        ("relmse_block", Self::RelmseBlock),
        ("mape", Self::Mape),
        ("flip", Self::Flip),
        ("flip_hdr", Self::FlipHdr),
    ];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        let mut names = Self::NAMES.iter();
        let found = names.find(|(_, metric)| *metric == self);
        found.map_or("", |(name, _)| name)
    }

    /// Returns the exponent k of the law by which the metric of an unbiased estimate decreases: samples^-k. None:
    /// FLIP, which has no such law.
    pub fn order(self) -> Option<f64> {
        match self {
            Self::Rmse | Self::RmseTrimmed | Self::Mape => Some(0.5),
            Self::Relmse | Self::RelmseTrimmed | Self::RelmseBlock => Some(1.0),
            Self::Flip | Self::FlipHdr => None,
        }
    }

    /// Returns true for all metrics except FLIP, which filters images and takes longer.
    pub fn is_fast(self) -> bool {
        !matches!(self, Self::Flip | Self::FlipHdr)
    }

    /// Computes the error of every pixel, including those that trimmed metrics exclude.
    pub fn errors(self, pair: &Pair<'_>) -> ErrorMap {
        let of = |error: fn(f64, f64) -> f64| ErrorMap::of_channels(pair, error);
        match self {
            Self::Rmse | Self::RmseTrimmed => of(|a, b| (a - b) * (a - b)).map(f64::sqrt),
            Self::Relmse | Self::RelmseTrimmed => of(relative_square),
            Self::RelmseBlock => ErrorMap::of_blocks(pair, BLOCK, relative_square),
            Self::Mape => of(|a, b| (a - b).abs() / (b.abs() + EPSILON)),
            Self::Flip => flip::ldr(pair, flip::PIXELS_PER_DEGREE),
            Self::FlipHdr => {
                let exposures = flip::Exposures::of(pair.reference());
                flip::hdr(pair, flip::PIXELS_PER_DEGREE, exposures)
            }
        }
    }

    /// Pools the errors from [`Self::errors`] into one number.
    pub fn pool(self, errors: &ErrorMap) -> f64 {
        let kept = match self {
            Self::RmseTrimmed | Self::RelmseTrimmed => Kept::WithoutWorst,
            _ => Kept::All,
        };
        match self {
            Self::Rmse | Self::RmseTrimmed => errors.mean_of(kept, |error| error * error).sqrt(),
            _ => errors.mean_of(kept, |error| error),
        }
    }

    /// Computes the metric of an image and its reference.
    pub fn value(self, pair: &Pair<'_>) -> f64 {
        self.pool(&self.errors(pair))
    }
}

/// Computes (a - b)² / (b² + ε).
fn relative_square(a: f64, b: f64) -> f64 {
    (a - b) * (a - b) / (b * b + EPSILON)
}

/// Computes the mean of the image divided by the mean of the reference; 1 if both are black.
///
/// Both means have the same expectation if the estimator is unbiased.
pub fn mean_ratio(pair: &Pair<'_>) -> f64 {
    let mean = |pixels: &crate::image::Pixels| pixels.mean().unwrap_or(f64::NAN);
    let (a, b) = (mean(pair.image()), mean(pair.reference()));
    if a == 0.0 && b == 0.0 { 1.0 } else { a / b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Pixels;
    use crate::image::tests::image;

    #[track_caller]
    fn check(computed: f64, expected: f64) {
        assert!(
            (computed - expected).abs() < 1e-9,
            "{computed} is not {expected}"
        );
    }

    #[test]
    fn errors_are_as_defined() {
        let a = image(&[[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]]);
        let b = image(&[[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]);
        let pair = Pair::new(&a, &b).unwrap();
        check(Metric::Rmse.value(&pair), (5.0f64 / 6.0).sqrt());
        check(Metric::Relmse.value(&pair), 5.0 / 1.01 / 6.0);
        check(Metric::Mape.value(&pair), 3.0 / 1.01 / 6.0);
        check(Metric::Rmse.errors(&pair).data[0], (5.0f64 / 3.0).sqrt());
        check(mean_ratio(&pair), 2.0);
        let black = image(&[[0.0; 3]]);
        check(mean_ratio(&Pair::new(&black, &black).unwrap()), 1.0);
    }

    /// Blocks of 16 × 2 and of 1 × 2 pixels: differences within a block average out.
    #[test]
    fn block_errors_keep_only_the_common_error_of_their_pixels() {
        let picture = |value: fn(usize) -> f32| Pixels {
            size: [17, 2],
            data: (0..34).map(|i| [value(i); 3]).collect(),
        };
        let b = picture(|_| 1.0);
        let a = picture(|i| match i % 17 {
            16 => 3.0,
            x if x % 2 == 0 => 2.0,
            _ => 0.0,
        });
        let pair = Pair::new(&a, &b).unwrap();
        check(Metric::RelmseBlock.value(&pair), 2.0 * 4.0 / 1.01 / 34.0);
        check(Metric::RelmseBlock.errors(&pair).data[33], 4.0 / 1.01);
        check(Metric::RelmseBlock.errors(&pair).data[3], 0.0);
        let a = picture(|_| 1.5);
        let pair = Pair::new(&a, &b).unwrap();
        check(Metric::RelmseBlock.value(&pair), 0.25 / 1.01);
        check(Metric::Relmse.value(&pair), 0.25 / 1.01);
    }

    #[test]
    fn equal_images_have_no_error() {
        let a = image(&[[0.1, 0.5, 9.0], [0.0, 1e9, 0.3]]);
        for (name, metric) in Metric::NAMES {
            let value = metric.value(&Pair::new(&a, &a).unwrap());
            assert_eq!(value.to_bits(), 0, "{name} {value}");
        }
    }

    /// 1001 pixels of error 1, of which two are worse.
    #[test]
    fn trimmed_metrics_exclude_the_worst_thousandth_rounded_up() {
        let b = image(&[[1.0; 3]; 1001]);
        let mut a = image(&[[2.0; 3]; 1001]);
        a.data[17] = [101.0; 3];
        a.data[900] = [f32::NAN; 3];
        let value = |metric: Metric, a: &Pixels| metric.value(&Pair::new(a, &b).unwrap());
        check(value(Metric::RmseTrimmed, &a), 1.0);
        check(value(Metric::RelmseTrimmed, &a), 1.0 / 1.01);
        assert!(value(Metric::Rmse, &a).is_nan() && value(Metric::Relmse, &a).is_nan());
        a.data[3] = [31.0; 3];
        check(
            value(Metric::RmseTrimmed, &a),
            ((998.0 + 900.0) / 999.0f64).sqrt(),
        );
    }

    #[test]
    fn metrics_over_no_pixels_are_nan() {
        let one = image(&[[1.0; 3]]);
        let none = image(&[]);
        assert!(
            Metric::RmseTrimmed
                .value(&Pair::new(&one, &one).unwrap())
                .is_nan()
        );
        assert!(
            Metric::Rmse
                .value(&Pair::new(&none, &none).unwrap())
                .is_nan()
        );
    }
}
