//! The images of a reference.

use super::Error;
use crate::image::Pixels;
use bidir::film::Picture;
use formats::image::read_layers;
use std::path::Path;

/// Returns the image and the variances of a developed film.
pub(super) fn of(picture: Picture) -> [Pixels; 2] {
    let size = [picture.width, picture.height];
    [picture.pixels, picture.variance].map(|data| Pixels { size, data })
}

/// Reads an image and its variances.
pub(super) fn read(path: &Path) -> Result<[Pixels; 2], Error> {
    let layers = read_layers(path)?;
    let size = layers.size();
    let image = |names: [&str; 3]| {
        let data = layers.triples(names).ok_or_else(|| {
            let names = names.join(", ");
            Error::damaged(path, format!("it lacks one of the channels {names}"))
        });
        data.map(|data| Pixels { size, data })
    };
    Ok([
        image(["R", "G", "B"])?,
        image(["Variance.R", "Variance.G", "Variance.B"])?,
    ])
}
