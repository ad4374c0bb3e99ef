//! The image files of a reference.

use super::Error;
use crate::image::Pixels;
use bidir::film::{Film, Picture};
use formats::film::FilmHeader;
use formats::image::{ExrImage, ExrLayer, read_layers, write_exr};
use std::path::Path;

/// Returns the image and the variances of a developed film.
pub(super) fn of(picture: Picture) -> [Pixels; 2] {
    let size = [picture.width, picture.height];
    [picture.pixels, picture.variance].map(|data| Pixels { size, data })
}

/// Writes a film as EXR with its layers.
pub(super) fn write(path: &Path, header: &FilmHeader, film: &Film) -> Result<(), Error> {
    let (picture, others) = (film.develop(), film.develop_layers());
    let layers = others.iter().map(|layer| ExrLayer {
        name: &layer.name,
        channels: layer.channels,
        data: &layer.data,
    });
    let picture = ExrLayer {
        name: "",
        channels: &["R", "G", "B"],
        data: picture.pixels.as_flattened(),
    };
    let (settings, layers) = (film.settings(), layers.collect::<Vec<_>>());
    let ([left, top], [right, bottom]) = (settings.crop.min, settings.crop.max);
    let image = ExrImage {
        resolution: settings.resolution.map(|side| side as usize),
        crop: [left, top, right, bottom].map(|edge| edge as usize),
        layers: &[&[picture], &layers[..]].concat(),
        metadata: &formats::film::metadata(header),
    };
    Ok(write_exr(path, &image)?)
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
