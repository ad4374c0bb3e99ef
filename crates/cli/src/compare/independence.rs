//! Checks that several images have independent seeds, as their intervals assume.

use crate::scene_io;
use lab::image::{Pixels, identical};
use std::path::{Path, PathBuf};

/// The images so far, and the warnings about them.
#[derive(Debug, Default)]
pub(super) struct Independence {
    images: Vec<Replicate>,
    pub(super) warnings: Vec<String>,
}

#[derive(Debug)]
struct Replicate {
    path: PathBuf,
    pixels: Pixels,
    /// The seed in the image's attributes. None: it has no such attribute.
    seed: Option<String>,
}

impl Independence {
    /// Adds an image, and a warning if an earlier image has the same noise.
    pub(super) fn add(&mut self, path: &Path, pixels: &Pixels) {
        let image = Replicate {
            path: path.to_owned(),
            pixels: pixels.clone(),
            seed: scene_io::setting_of(path, "seed"),
        };
        let warning = self.images.iter().find_map(|other| image.likeness(other));
        self.warnings.extend(warning);
        self.images.push(image);
    }
}

impl Replicate {
    /// Returns the warning that both images have the same noise. None: they may be independent.
    fn likeness(&self, other: &Self) -> Option<String> {
        let [a, b] = [&other.path, &self.path].map(|path| path.display());
        let needs = "intervals need images with different seeds";
        if self.path == other.path {
            Some(format!("`{a}` is given twice: {needs}"))
        } else if identical(&self.pixels, &other.pixels) {
            Some(format!("`{a}` and `{b}` are identical: {needs}"))
        } else if self.seed.is_some() && self.seed == other.seed {
            let seed = self.seed.as_deref().unwrap_or_default();
            Some(format!(
                "`{a}` and `{b}` have the same seed, {seed}: {needs}"
            ))
        } else {
            None
        }
    }
}
