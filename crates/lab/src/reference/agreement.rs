//! The test that the two estimators of a reference have the same expectation.

use super::LEVEL;
use crate::blocks::Blocks;
use crate::image::Pixels;
use crate::statistics::{Difference, WHOLE, smallest_bias, welch_test};
use serde::{Deserialize, Serialize};

/// The approximate number of blocks along the longer side of the film.
const BLOCKS: usize = 8;
/// The smallest side of a block: means of few pixels have heavy tails. Unit: pixels.
const SMALLEST_BLOCK: usize = 8;
/// The least number of effective samples of a mean that is compared. With fewer, a mean that misses rare bright
/// samples is too small, and so is its variance.
const ENOUGH: f64 = 64.0;

/// The description of the test.
const TEST: &str = "Welch's t-test over replicates, of the means of the film and of blocks, with Šidák's correction";

/// The result of the agreement test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// True if p ≥ level.
    pub agree: bool,
    /// The p-value: the smaller one of the two parts (film and blocks), corrected for their number.
    pub p: f64,
    /// The level of the test.
    pub level: f64,
    /// A description of the test.
    pub test: String,
    /// Number of replicates of each estimator.
    pub replicates: usize,
    /// Number of comparisons: three channels of the film, and of every block.
    pub comparisons: usize,
    /// The side of a block. Unit: pixels.
    pub block: usize,
    /// Number of effective samples of a block's mean, for the estimator that has fewer. None: the film is black.
    #[serde(default)]
    pub effective: Option<f64>,
    /// False if even the mean of the film has too few effective samples for a verdict.
    #[serde(default = "yes")]
    pub decided: bool,
    /// The channel whose film means differ most.
    pub film: Difference,
    /// The block and channel whose means differ most.
    pub blocks: Difference,
    /// The relative bias of the film's mean, in any channel, that the test detects with probability 1/2.
    /// None: the film is black, or its variance is unknown.
    pub smallest_bias: Option<f64>,
}

/// The renders of an estimator.
pub(super) struct Renders {
    /// An image of each replicate.
    pub(super) replicates: Vec<Pixels>,
    /// The image of all passes, and the variance of its pixels.
    pub(super) whole: [Pixels; 2],
    /// The number of all passes.
    pub(super) passes: u64,
}

const fn yes() -> bool {
    true
}

impl Renders {
    /// Returns the effective number of samples of a mean over `block` × `block` pixels, for the channel that has the
    /// fewest. N samples have N E\[x\]² / E\[x²\]; E\[x²\] / E\[x\]² is averaged over blocks, as some blocks miss
    /// rare samples.
    fn effective(&self, block: usize) -> f64 {
        let [mean, variance] = &self.whole;
        let blocks = Blocks::new(mean.size, block);
        let passes = self.passes as f64;
        // Per channel: blocks with light, their pixels, and the sum of E[x²] / E[x]².
        let mut channels = [[0.0; 3]; 3];
        let variances = blocks.sums(variance);
        let both = blocks.sums(mean).into_iter().zip(variances);
        for (i, (mean, variance)) in both.enumerate() {
            let square = mean.mean() * mean.mean();
            if square > 0.0 {
                let second = (mean.squares + passes * variance.sum) / mean.count;
                let of_block = [1.0, mean.count, second / square];
                let sums = &mut channels[i % 3];
                *sums = std::array::from_fn(|k| sums[k] + of_block[k]);
            }
        }
        let lit = channels.iter().filter(|[count, ..]| *count > 0.0);
        let effective = lit.map(|[_, pixels, ratios]| passes * pixels / ratios);
        effective.fold(f64::INFINITY, f64::min)
    }
}

impl Agreement {
    /// Compares the renders of two estimators. None: there are too few replicates, or no pixels.
    pub(super) fn of(renders: [&Renders; 2]) -> Option<Self> {
        let [a, b] = renders.map(|renders| &renders.replicates[..]);
        let longest = *a.first()?.size.iter().max()?;
        let effective = |block| {
            let [a, b] = renders.map(|renders| renders.effective(block));
            a.min(b)
        };
        let mut block = longest.div_ceil(BLOCKS).max(SMALLEST_BLOCK);
        while block < longest && effective(block) < ENOUGH {
            block *= 2;
        }
        let film = welch_test(a, b, WHOLE)?;
        let blocks = welch_test(a, b, block)?;
        let effective = effective(block);
        let decided = effective >= ENOUGH;
        // 1 - (1 - p)² [Sidak67], exact for small p too.
        let smallest = film.p.min(blocks.p);
        let p = if decided {
            smallest * (2.0 - smallest)
        } else {
            1.0
        };
        // The level of the film's part alone.
        let level = LEVEL / (1.0 + (1.0 - LEVEL).sqrt());
        Some(Self {
            agree: p >= LEVEL,
            p,
            level: LEVEL,
            test: TEST.to_owned(),
            replicates: a.len(),
            comparisons: film.tests + blocks.tests,
            block,
            effective: effective.is_finite().then_some(effective),
            decided,
            film,
            blocks,
            smallest_bias: smallest_bias(a, b, level),
        })
    }

    /// Returns the more significant difference: that of the film, or that of a block.
    pub fn worst(&self) -> &Difference {
        if self.film.p < self.blocks.p {
            &self.film
        } else {
            &self.blocks
        }
    }
}

#[cfg(test)]
mod tests;
