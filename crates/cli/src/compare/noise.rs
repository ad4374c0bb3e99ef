//! Tests whether a difference of images with variances is more than noise.

use crate::exit::Failure;
use crate::scene_io;
use lab::image::{Pixels, identical};
use lab::reference::{PICTURE, Provenance};
use lab::statistics::{Difference, Estimated, z_test};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Approximate number of blocks along the longer side of an image.
const BLOCKS: usize = 16;

/// An image with the variances of its pixels, if it has them.
#[derive(Debug)]
pub(super) struct Noisy {
    pub(super) path: PathBuf,
    pub(super) pixels: Pixels,
    /// The variance of every pixel's mean.
    variance: Option<Pixels>,
    /// The degrees of freedom of the variances; 0 if they are unknown.
    freedom: f64,
    /// The integrator of the render. None: the image has no such attribute.
    integrator: Option<String>,
    /// The seed of the render. None: the image has no such attribute.
    seed: Option<String>,
}

impl Noisy {
    /// Reads an image.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let read = formats::image::read_layers(path).ok();
        let layers = read.as_ref();
        let setting = |name: &str| layers?.text(&format!("bidir/{name}"));
        let samples = layers.and_then(|layers| layers.channel("Samples"));
        let fewest = samples.map(|all| all.into_iter().fold(f32::INFINITY, f32::min));
        Ok(Self {
            path: path.to_owned(),
            pixels: scene_io::read_image(path)?,
            variance: layers.and_then(|layers| Pixels::layer(layers, "Variance.")),
            freedom: fewest.map_or(0.0, |fewest| f64::from(fewest) - 1.0),
            integrator: setting("integrator"),
            seed: setting("seed"),
        })
    }

    /// Reads an image, or the folder of a reference.
    pub(super) fn reference(path: &Path) -> Result<Self, Failure> {
        if !path.is_dir() {
            return Self::read(path);
        }
        Provenance::load(path)?;
        Ok(Self {
            path: path.to_owned(),
            ..Self::read(&path.join(PICTURE))?
        })
    }

    /// Returns the warning that intervals are wrong for this image and one of `others`. None: they are independent.
    pub(super) fn likeness(&self, others: &[Self]) -> Option<String> {
        let name = self.path.display();
        let likeness = others.iter().find_map(|other| {
            let both = format!("`{}` and `{name}`", other.path.display());
            match &self.seed {
                _ if other.path == self.path => Some(format!("`{name}` is given twice")),
                _ if identical(&self.pixels, &other.pixels) => {
                    Some(format!("{both} are identical"))
                }
                Some(seed) if other.seed == self.seed => {
                    Some(format!("{both} have the same seed, {seed}"))
                }
                _ => None,
            }
        })?;
        Some(format!(
            "{likeness}: intervals need images with different seeds"
        ))
    }

    /// Returns the warning that the noise of this image's pixels is correlated, which the test of blocks ignores.
    /// None: the noise is independent, or the integrator is unknown.
    pub(super) fn correlation(&self) -> Option<String> {
        let integrator = self.integrator.as_deref()?;
        if !["lvc", "auto"].contains(&integrator) {
            return None;
        }
        let name = self.path.display();
        Some(format!(
            "z_blocks assumes independent pixels, but those of `{name}` share light subpaths by \
             `{integrator}`: its p may be too small; compare several seeds with --reference instead"
        ))
    }

    fn estimated(&self) -> Option<Estimated<'_>> {
        Some(Estimated {
            mean: &self.pixels,
            variance: self.variance.as_ref()?,
            freedom: self.freedom,
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
