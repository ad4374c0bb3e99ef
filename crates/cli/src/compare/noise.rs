//! Tests whether a difference of images with variances is more than noise.

use crate::exit::Failure;
use crate::scene_io::{self, Variance};
use lab::image::Pixels;
use lab::reference::{PICTURE, Provenance};
use lab::statistics::{Difference, Estimated, z_test};
use serde::Serialize;
use std::path::Path;

/// Approximate number of blocks along the longer side of an image.
const BLOCKS: usize = 16;

/// An image with the variances of its pixels, if it has them.
#[derive(Debug)]
pub(super) struct Noisy {
    pub(super) pixels: Pixels,
    variance: Option<Variance>,
    /// The integrator of the render. None: the image has no such attribute.
    integrator: Option<String>,
}

impl Noisy {
    /// Reads an image.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        Ok(Self {
            pixels: scene_io::read_image(path)?,
            variance: scene_io::read_variance(path),
            integrator: scene_io::setting_of(path, "integrator"),
        })
    }

    /// Reads an image, or the folder of a reference.
    pub(super) fn reference(path: &Path) -> Result<Self, Failure> {
        if !path.is_dir() {
            return Self::read(path);
        }
        Provenance::load(path)?;
        Self::read(&path.join(PICTURE))
    }

    /// Returns the warning that the noise of this image's pixels is correlated, which the test of blocks
    /// ignores; `path` names the image. None: the noise is independent, or the integrator is unknown.
    pub(super) fn correlation(&self, path: &Path) -> Option<String> {
        let integrator = self.integrator.as_deref()?;
        if !["lvc", "auto"].contains(&integrator) {
            return None;
        }
        let name = path.display();
        Some(format!(
            "z_blocks assumes independent pixels, but those of `{name}` share light subpaths by \
             `{integrator}`: its p may be too small; compare several seeds with --reference instead"
        ))
    }

    fn estimated(&self) -> Option<Estimated<'_>> {
        let variance = self.variance.as_ref()?;
        Some(Estimated {
            mean: &self.pixels,
            variance: &variance.pixels,
            freedom: variance.freedom,
        })
    }
}

/// The results of the tests of a difference.
#[derive(Debug, Serialize)]
pub(super) struct Significance {
    /// The side of a block. Unit: pixels.
    block: usize,
    /// The test of single pixels.
    pub(super) pixels: Difference,
    /// The test of blocks.
    pub(super) blocks: Difference,
}

impl Significance {
    /// Tests the difference of two images. None: an image has no variances, or the sizes differ.
    pub(super) fn of(a: &Noisy, b: &Noisy) -> Option<Self> {
        let [a, b] = [a.estimated()?, b.estimated()?];
        let [width, height] = a.mean.size;
        let block = width.max(height).div_ceil(BLOCKS);
        Some(Self {
            block,
            pixels: z_test(&a, &b, 1)?,
            blocks: z_test(&a, &b, block)?,
        })
    }
}

/// Returns the result of a test in one line.
pub(super) fn text(found: &Difference) -> String {
    let Difference { p, tests, .. } = found;
    let (place, deviations) = (found.place(), found.deviations.abs());
    format!("p {p:.3e} of {tests} tests; most in {place}, {deviations:.2} standard errors")
}
