//! Is a difference noise? Tests of images that know their variances.

use crate::console::Console;
use crate::exit::Failure;
use crate::reference;
use crate::scene_io::{self, Variance};
use lab::image::Pixels;
use lab::reference::{Comparison, Reference};
use lab::statistics::{Estimated, z_test};
use serde::Serialize;
use std::path::Path;

/// The image is cut into about so many blocks along its longer side.
const BLOCKS: usize = 16;

/// An image that may know how sure it is.
#[derive(Debug)]
pub(super) struct Noisy {
    pub(super) pixels: Pixels,
    variance: Option<Variance>,
    /// That of the render. None: the image does not say.
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
    pub(super) fn reference(path: &Path, console: Console) -> Result<Self, Failure> {
        if !path.is_dir() {
            return Self::read(path);
        }
        let reference = Reference::load(path).map_err(reference::failure)?;
        if let Some(warning) = reference.warning() {
            console.warning(warning);
        }
        let freedom = reference.estimated().freedom;
        let estimator = &reference.provenance.estimators[0];
        let integrator = estimator.settings.get("integrator").cloned();
        let pixels = reference.variance;
        Ok(Self {
            pixels: reference.picture,
            variance: Some(Variance { pixels, freedom }),
            integrator,
        })
    }

    /// The warning that pixels of this image, read from `path`, share noise, which the test of blocks
    /// does not know. None: they are independent, or the image does not say.
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

/// What tests say of a difference.
#[derive(Debug, Serialize)]
pub(super) struct Significance {
    /// The side of a block. Unit: pixels.
    block: usize,
    /// Of all pixels, the one that differs most.
    pub(super) pixels: Verdict,
    /// Of all blocks.
    pub(super) blocks: Verdict,
}

/// What a test found.
#[derive(Debug, Serialize)]
pub(super) struct Verdict {
    tests: usize,
    #[serde(flatten)]
    worst: Comparison,
}

impl Significance {
    /// None: an image does not know its variances, or the sizes differ.
    pub(super) fn of(a: &Noisy, b: &Noisy) -> Option<Self> {
        let [a, b] = [a.estimated()?, b.estimated()?];
        let [width, height] = a.mean.size;
        let block = width.max(height).div_ceil(BLOCKS);
        let test = |block| {
            let found = z_test(&a, &b, block)?;
            let (tests, worst) = (found.tests, Comparison::from(&found));
            Some(Verdict { tests, worst })
        };
        Some(Self {
            block,
            pixels: test(1)?,
            blocks: test(block)?,
        })
    }
}

impl Verdict {
    /// In a line.
    pub(super) fn text(&self) -> String {
        let Comparison {
            p,
            block: [left, top, right, bottom],
            channel,
            deviations,
            ..
        } = &self.worst;
        let channel = ["red", "green", "blue"][channel % 3];
        let deviations = deviations.unwrap_or(f64::INFINITY).abs();
        format!(
            "p {p:.3e} of {} tests; most at {left},{top} to {right},{bottom} in {channel}, \
             {deviations:.2} standard errors",
            self.tests
        )
    }
}
