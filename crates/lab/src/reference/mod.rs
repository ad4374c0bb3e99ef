//! References: images that errors are measured against, with evidence that they are right.
//!
//! Two different estimators render a reference. Each makes [`REPLICATES`] replicates: renders of n passes
//! with different seeds. Welch's t-test compares the replicates of the two estimators, on the mean of the film
//! and on blocks of pixels, at [`LEVEL`]. A reference whose estimators disagree is written, but
//! [`Provenance::load`] refuses it.
//!
//! The image is the mean Σ_p X_p / N over all N = REPLICATES · n passes of the *first* estimator; the second
//! is only a cross-check. A mean of both, weighted by inverse variance, would have less variance, but its
//! weights would be estimated from the same samples, which causes a bias: a pixel that missed a bright path
//! would get the largest weight. The variance of a pixel is Σ_p (X_p - X̄)² / (N (N - 1)): exact for the
//! independent sampler, somewhat too large for stratified ones. It has N - 1 degrees of freedom.
//!
//! Seeds are far from the seeds that people choose, so that a measured image shares no sample with its
//! reference.
//!
//! A reference is a folder:
//!
//! | file | content |
//! |---|---|
//! | `picture.exr` | the image, with the layers `Variance`, `RelativeVariance` and `Samples` |
//! | `against.exr` | the image of the second estimator, with the same layers |
//! | `provenance.json` | [`Provenance`]: settings, agreement of the estimators, checksums of itself and both images |
//! | `films/*.film` | the film of each replicate, from which [`Job::make`] continues |
//!
//! The films are needed only to add samples. They hold whole passes, so an extended or resumed reference has
//! the same bits as one made in a single run.

mod agreement;
mod make;
mod plan;
mod provenance;
mod replicate;
#[cfg(test)]
mod tests;

pub use agreement::Agreement;
pub use make::{Job, clear, files};
pub use plan::Plan;
pub use provenance::{EstimatorRecord, FORMAT, Provenance};

use bidir::driver::SessionError;
use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Number of replicates of each estimator.
pub const REPLICATES: u64 = 16;
/// The level of the agreement test: the rate of false alarms.
pub const LEVEL: f64 = 1e-3;

/// The name of the image in the folder of a reference.
pub const PICTURE: &str = "picture.exr";
/// The names of the other files there.
const AGAINST: &str = "against.exr";
const PROVENANCE: &str = "provenance.json";
/// The name of the folder of films in the folder of a reference.
pub const FILMS: &str = "films";

/// An error of making or using a reference.
#[derive(Debug, Error)]
pub enum Error {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] formats::Error),
    /// A render cannot start.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The estimators of the reference disagree.
    #[error("{}: refused: its estimators disagree (p = {p:e} at level {LEVEL})", folder.display())]
    Disagree {
        /// The folder of the reference.
        folder: PathBuf,
        /// The p-value of the difference.
        p: f64,
    },
    /// A file or folder cannot be used.
    #[error("{text}")]
    Unusable {
        /// The fault.
        fault: Fault,
        /// The file or folder, and the fault in words.
        text: String,
    },
}

/// The fault of a folder or file that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The folder does not exist, or has no `provenance.json`.
    Missing,
    /// A file of the reference is damaged.
    Damaged,
    /// The reference is intact, but another one is needed.
    Refused,
    /// There are this many samples per pixel already, more than requested.
    TooLong(u64),
    /// A film, or the whole reference, is of another render.
    OtherRender,
}

impl Fault {
    /// Returns the error of a file or folder with this fault.
    fn of(self, path: &Path, reason: impl fmt::Display) -> Error {
        let between = match self {
            Self::Damaged => ": damaged:",
            Self::Refused => ": refused:",
            Self::Missing | Self::TooLong(_) | Self::OtherRender => "",
        };
        Error::Unusable {
            fault: self,
            text: format!("{}{between} {reason}", path.display()),
        }
    }
}

/// Returns true if `folder` has a reference, intact or not.
pub fn is_reference(folder: &Path) -> bool {
    folder.join(PROVENANCE).is_file()
}
