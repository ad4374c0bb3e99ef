//! References: pictures that others are measured against, and why they can be trusted.
//!
//! A reference is rendered by two estimators that could disagree. Each makes [`REPLICATES`]
//! replicates: renders of n passes with seeds of their own. Welch's t-test compares the replicates
//! of both, on the mean of the film and on blocks of pixels, at [`LEVEL`]; a reference whose
//! estimators disagree is written, and refused by [`Reference::load`].
//!
//! The picture is that of the *first* estimator alone: the mean Σ_p X_p / N over all its N =
//! REPLICATES · n passes. Weights that favour the estimator of less variance would be better where
//! they were known, but they would be estimated from the same samples, and such a mean is biased: a
//! pixel that missed a bright path would trust itself most. So the choice is made before, and the
//! second estimator is a witness. The variance of a pixel is Σ_p (X_p - X̄)² / (N (N - 1)), right for
//! the independent sampler, and rather too large for stratified ones. Its passes count as N - 1
//! degrees of freedom.
//!
//! Seeds are far from those that people choose, so that a picture which is measured has no sample
//! in common with its reference.
//!
//! A reference is a folder:
//!
//! | file | what |
//! |---|---|
//! | `picture.exr` | the picture, with the layers `Variance`, `RelativeVariance` and `Samples` |
//! | `against.exr` | the same of the second estimator |
//! | `provenance.json` | [`Provenance`]: how it was made, and whether the estimators agree, with checksums of itself and both images |
//! | `films/*.film` | the film of each replicate, by which [`make()`] goes on |
//!
//! The films are needed to add samples only. As each holds whole passes, a reference that was
//! extended, or stopped and gone on with, has the bits of one that was made at once.

mod agreement;
mod cross_check;
mod make;
mod picture;
mod provenance;
mod replicate;
#[cfg(test)]
mod tests;

pub use agreement::{Agreement, Comparison};
pub use make::{Host, Made, Plan, Subject, clear, files, make};
pub use provenance::{EstimatorRecord, FORMAT, Provenance};

use crate::image::{Pixels, digest};
use crate::statistics::Estimated;
use bidir::driver::SessionError;
use bidir::film::{FilmSettings, MergeError};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Replicates of each estimator.
pub const REPLICATES: u64 = 16;
/// The level of the agreement test: how often estimators that agree are said to disagree.
pub const LEVEL: f64 = 1e-3;

/// The names of the files in the folder of a reference.
const PICTURE: &str = "picture.exr";
const AGAINST: &str = "against.exr";
const PROVENANCE: &str = "provenance.json";
/// The folder of the films in it.
pub const FILMS: &str = "films";

/// Why a reference cannot be made or used.
#[derive(Debug, Error)]
pub enum Error {
    /// A film or an image cannot be read or written.
    #[error(transparent)]
    File(#[from] formats::Error),
    /// The system refused to read or write.
    #[error("{}", formats::cannot("use", path, error))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// The folder is not there, or has no `provenance.json`.
    #[error("{} is not a reference: it has no {PROVENANCE}", .0.display())]
    Missing(PathBuf),
    /// No render can begin.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A file of the reference is not as it was written.
    #[error("{}: damaged: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// It is whole, but not the reference that is wanted.
    #[error("{}: refused: {reason}", folder.display())]
    Refused {
        /// The folder of the reference.
        folder: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Its estimators disagree.
    #[error("{}: refused: its estimators disagree (p = {p:e} at level {LEVEL})", folder.display())]
    Disagree {
        /// The folder of the reference.
        folder: PathBuf,
        /// The probability of a difference at least as large where there is none.
        p: f64,
    },
    /// A film has more passes than are asked for.
    #[error(
        "{} has {found} samples per pixel already, more than the {asked} requested",
        folder.display()
    )]
    TooLong {
        /// The folder of the reference.
        folder: PathBuf,
        /// Samples per pixel of its longest replicate, times their number.
        found: u64,
        /// Samples per pixel that were asked for.
        asked: u64,
    },
    /// The folder has films of another render.
    #[error("{} is the film of another render: {difference}", path.display())]
    OtherRender {
        /// The film file.
        path: PathBuf,
        /// The first difference.
        difference: String,
    },
}

impl Error {
    /// An error of the system with `path`.
    fn io(path: &Path, error: std::io::Error) -> Self {
        let path = path.to_owned();
        Self::Io { path, error }
    }

    fn damaged(path: &Path, reason: impl Into<String>) -> Self {
        Self::Damaged {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }

    fn merge(path: &Path, error: &MergeError) -> Self {
        Self::damaged(path, error.to_string())
    }
}

/// A picture that others are measured against.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Where it is.
    pub folder: PathBuf,
    /// The picture.
    pub picture: Pixels,
    /// The variance of every pixel of it: of the mean, not of single samples.
    pub variance: Pixels,
    /// How it was made.
    pub provenance: Provenance,
}

impl Reference {
    /// Reads the reference in `folder`.
    ///
    /// Errors: a file is missing or damaged; it was made by another version of the estimators; its
    /// estimators disagree. Of which scene it has to be, [`Self::check`] asks.
    pub fn load(folder: &Path) -> Result<Self, Error> {
        let provenance = Provenance::read(folder)?;
        provenance.check_usable(folder)?;
        provenance.check_files(folder)?;
        let file = folder.join(PICTURE);
        let [picture, variance] = picture::read(&file)?;
        if digest(&[&picture, &variance]) != provenance.picture {
            let reason = format!("it is not the image that {PROVENANCE} describes");
            return Err(Error::damaged(&file, reason));
        }
        Ok(Self {
            folder: folder.to_owned(),
            picture,
            variance,
            provenance,
        })
    }

    /// A warning about its files: damage to older ones may go unseen. None: they are fine.
    pub fn warning(&self) -> Option<String> {
        let folder = self.folder.display();
        (self.provenance.format == provenance::UNSEALED).then(|| {
            let lacks = !self.folder.join(AGAINST).is_file();
            let lacks = if lacks {
                ", and it has no against.exr"
            } else {
                ""
            };
            format!("{folder}: of a version without checksums: damage in it may go unseen{lacks}")
        })
    }

    /// Refuses it for another scene than the one with this digest, and for another film.
    pub fn check(&self, digest: &str, film: &FilmSettings) -> Result<(), Error> {
        self.provenance.check(&self.folder, digest, film)
    }

    /// The mean square error that its noise makes: the mean variance of pixels and channels.
    ///
    /// None: it is not a number, or there are no pixels.
    pub fn mse(&self) -> Option<f64> {
        self.variance.mean().filter(|mse| mse.is_finite())
    }

    /// The picture with its variances, to be tested against.
    pub fn estimated(&self) -> Estimated<'_> {
        let passes = self.provenance.estimators[0].spp as f64;
        Estimated {
            mean: &self.picture,
            variance: &self.variance,
            freedom: passes - 1.0,
        }
    }
}

/// True where `folder` has a reference, whole or not.
pub fn is_reference(folder: &Path) -> bool {
    folder.join(PROVENANCE).is_file()
}
