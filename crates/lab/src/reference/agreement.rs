//! The test that the two estimators of a reference have the same expectation.

use super::LEVEL;
use crate::image::Pixels;
use crate::statistics::{Difference, WHOLE, smallest_bias, welch_test};
use serde::{Deserialize, Serialize};

/// The approximate number of blocks along the longer side of the film.
const BLOCKS: usize = 8;
/// The smallest side of a block: means of few pixels have heavy tails. Unit: pixels.
const SMALLEST_BLOCK: usize = 8;

/// The result of the agreement test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// True if p ≥ level.
    pub agree: bool,
    /// The p-value: the smaller one of both parts, corrected for their number.
    pub p: f64,
    /// The level of the test.
    pub level: f64,
    /// A description of the test.
    pub test: String,
    /// Replicates of each estimator.
    pub replicates: usize,
    /// Comparisons in all: three channels of the film, and of every block.
    pub comparisons: usize,
    /// The side of a block. Unit: pixels.
    pub block: usize,
    /// The channel whose film means differ most.
    pub film: Difference,
    /// The block and channel whose means differ most.
    pub blocks: Difference,
    /// The relative bias of the film's mean, in any channel, that the test detects with probability 1/2.
    /// None: the film is black, or its variance is unknown.
    pub smallest_bias: Option<f64>,
}

/// Compares the replicates of two estimators. None: there are too few, or no pixels.
pub(super) fn agreement(a: &[Pixels], b: &[Pixels]) -> Option<Agreement> {
    let size = a.first()?.size;
    let block = size[0].max(size[1]).div_ceil(BLOCKS).max(SMALLEST_BLOCK);
    let film = welch_test(a, b, WHOLE)?;
    let blocks = welch_test(a, b, block)?;
    // 1 - (1 - p)² [Sidak67], exact for small p too.
    let p = film.p.min(blocks.p);
    let p = p * (2.0 - p);
    // The level of the film's part alone.
    let level = LEVEL / (1.0 + (1.0 - LEVEL).sqrt());
    Some(Agreement {
        agree: p >= LEVEL,
        p,
        level: LEVEL,
        test:
            "Welch's t-test over replicates, of the means of the film and of blocks, with Šidák's \
               correction"
                .to_owned(),
        replicates: a.len(),
        comparisons: film.tests + blocks.tests,
        block,
        film,
        blocks,
        smallest_bias: smallest_bias(a, b, level),
    })
}
