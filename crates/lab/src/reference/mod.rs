//! References: images that errors are measured against, with evidence that they are right.
//!
//! Two different estimators render a reference. Each makes [`REPLICATES`] replicates: renders of n passes
//! with different seeds. Welch's t-test compares the replicates of the two estimators, on the mean of the film
//! and on blocks of pixels, at [`LEVEL`]. A reference whose estimators disagree is written, but
//! [`Reference::load`] refuses it.
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
//! | `films/*.film` | the film of each replicate, from which [`make()`] continues |
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
pub use make::{Host, clear, files, make};
pub use plan::Plan;
pub use provenance::{EstimatorRecord, FORMAT, Provenance};

use crate::image::{Pixels, digest};
use crate::statistics::Estimated;
use bidir::driver::SessionError;
use bidir::film::{FilmSettings, MergeError, Picture};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Number of replicates of each estimator.
pub const REPLICATES: u64 = 16;
/// The level of the agreement test: the rate of false alarms.
pub const LEVEL: f64 = 1e-3;

/// The names of the files in the folder of a reference.
const PICTURE: &str = "picture.exr";
const AGAINST: &str = "against.exr";
const PROVENANCE: &str = "provenance.json";
/// The name of the folder of films in the folder of a reference.
pub const FILMS: &str = "films";

/// An error of making or using a reference.
#[derive(Debug, Error)]
pub enum Error {
    /// A film or an image cannot be read or written.
    #[error(transparent)]
    File(#[from] formats::Error),
    /// The system cannot read or write a file.
    #[error("{}", formats::cannot("use", path, error))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        error: std::io::Error,
    },
    /// The folder does not exist, or has no `provenance.json`.
    #[error("{} is not a reference: it has no {PROVENANCE}", .0.display())]
    Missing(PathBuf),
    /// A render cannot start.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A file of the reference is damaged.
    #[error("{}: damaged: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The kind of damage.
        reason: String,
    },
    /// The reference is intact, but another one is needed.
    #[error("{}: refused: {reason}", folder.display())]
    Refused {
        /// The folder of the reference.
        folder: PathBuf,
        /// The cause.
        reason: String,
    },
    /// The estimators of the reference disagree.
    #[error("{}: refused: its estimators disagree (p = {p:e} at level {LEVEL})", folder.display())]
    Disagree {
        /// The folder of the reference.
        folder: PathBuf,
        /// The p-value of the difference.
        p: f64,
    },
    /// A film has more passes than requested.
    #[error(
        "{} has {found} samples per pixel already, more than the {requested} requested",
        folder.display()
    )]
    TooLong {
        /// The folder of the reference.
        folder: PathBuf,
        /// Samples per pixel of the longest replicate, times the number of replicates.
        found: u64,
        /// Requested samples per pixel.
        requested: u64,
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
    /// Makes an error of the system about `path`.
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

/// A reference image with its provenance.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Its folder.
    pub folder: PathBuf,
    /// The image.
    pub picture: Pixels,
    /// The variance of each pixel's mean.
    pub variance: Pixels,
    /// Its provenance.
    pub provenance: Provenance,
}

impl Reference {
    /// Reads the reference in `folder`.
    ///
    /// Errors: a file is missing or damaged; another version of the estimators made it; its estimators
    /// disagree. [`Self::check`] compares it with a scene.
    pub fn load(folder: &Path) -> Result<Self, Error> {
        let provenance = Provenance::read(folder)?;
        provenance.check_usable(folder)?;
        provenance.check_files(folder)?;
        let file = folder.join(PICTURE);
        let [picture, variance] = read_images(&file)?;
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

    /// Refuses the reference unless it belongs to the scene with this digest and to this film.
    pub fn check(&self, digest: &str, film: &FilmSettings) -> Result<(), Error> {
        self.provenance.check(&self.folder, digest, film)
    }

    /// Computes the mean square error of the reference: the mean variance of pixels and channels.
    ///
    /// None: the error is not finite, or there are no pixels.
    pub fn mse(&self) -> Option<f64> {
        self.variance.mean().filter(|mse| mse.is_finite())
    }

    /// Returns the image with its variances, for a z-test against it.
    pub fn estimated(&self) -> Estimated<'_> {
        let passes = self.provenance.estimators[0].spp as f64;
        Estimated {
            mean: &self.picture,
            variance: &self.variance,
            freedom: passes - 1.0,
        }
    }
}

/// Returns the image and the variances of a developed film.
fn images(picture: Picture) -> [Pixels; 2] {
    let size = [picture.width, picture.height];
    [picture.pixels, picture.variance].map(|data| Pixels { size, data })
}

/// Reads an image and its variances.
fn read_images(path: &Path) -> Result<[Pixels; 2], Error> {
    let layers = formats::image::read_layers(path)?;
    let layer = |prefix: &str| {
        let lacks = || format!("it lacks one of the channels {prefix}R, {prefix}G, {prefix}B");
        Pixels::layer(&layers, prefix).ok_or_else(|| Error::damaged(path, lacks()))
    };
    Ok([layer("")?, layer("Variance.")?])
}

/// Returns true if `folder` has a reference, intact or not.
pub fn is_reference(folder: &Path) -> bool {
    folder.join(PROVENANCE).is_file()
}
