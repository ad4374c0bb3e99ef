//! Checks that several images have independent seeds, as their intervals assume.

use crate::scene_io;
use lab::image::{Pixels, identical};
use std::path::{Path, PathBuf};

/// The images so far with their seeds, and the warnings about them.
#[derive(Default)]
pub(super) struct Independence {
    images: Vec<(PathBuf, Pixels, Option<String>)>,
    pub(super) warnings: Vec<String>,
}

impl Independence {
    /// Adds an image, and a warning if an earlier image has the same noise.
    pub(super) fn add(&mut self, path: &Path, pixels: &Pixels) {
        let seed = scene_io::setting_of(path, "seed");
        let name = path.display();
        let likeness = self
            .images
            .iter()
            .find_map(|(other, others_pixels, others_seed)| {
                let both = format!("`{}` and `{name}`", other.display());
                match &seed {
                    _ if other == path => Some(format!("`{name}` is given twice")),
                    _ if identical(pixels, others_pixels) => Some(format!("{both} are identical")),
                    Some(seed) if others_seed.as_ref() == Some(seed) => {
                        Some(format!("{both} have the same seed, {seed}"))
                    }
                    _ => None,
                }
            });
        let warning = |likeness| format!("{likeness}: intervals need images with different seeds");
        self.warnings.extend(likeness.map(warning));
        self.images.push((path.to_owned(), pixels.clone(), seed));
    }
}
