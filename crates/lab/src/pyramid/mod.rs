//! Images and numbers of each strategy (s, t), weighted and raw, of a film that keeps them.
//!
//! Weighted images add up to the picture. A raw image is C/π, without the weight. All raw images with the same
//! number n = s + t of vertices show the same light, except for paths that a strategy cannot make, each with
//! the noise of its strategy alone [Veach97, fig. 10.2].

mod figures;

pub use figures::{Figures, ImageFigures};

use crate::image::Pixels;
use bidir::film::{Film, LayerImage, Layers};
use bidir::path::Strategy;
use formats::film::Developed;
use serde::Deserialize;

/// The default maximum number of vertices of paths whose strategies have images.
pub const VERTICES: u16 = 6;
/// Maximum width and height of an image that an experiment shows as a tile. Larger ones would not look
/// better. Unit: pixels.
pub const TILE: usize = 128;

/// The kind of an image of a strategy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// With MIS weights: these images add up to the picture.
    Weighted,
    /// Without MIS weights: each image is the estimate of its strategy alone.
    Raw,
}

impl Kind {
    fn part(self, layers: &Layers, strategy: Strategy) -> Option<usize> {
        match self {
            Self::Weighted => layers.weighted_part(strategy),
            Self::Raw => layers.raw_part(strategy),
        }
    }
}

/// Develops a film, with only the images of strategies as layers.
pub fn developed(film: &Film) -> Developed {
    let layers = film.layers();
    let names = layers.part_names().enumerate();
    let kept = names.skip(layers.light_groups().len());
    let images = kept.map(|(part, name)| LayerImage {
        name,
        channels: &["R", "G", "B"],
        data: film.part_pixels(part).flatten().collect(),
    });
    Developed {
        picture: film.develop(),
        layers: images.collect(),
    }
}

/// Returns the mean luminance of a film's picture.
pub fn mean(film: &Film) -> f64 {
    figures::mean_of(film, film.develop().pixels.into_iter())
}

/// Returns the mean luminance that longer paths add, whose strategies have no images.
pub fn mean_of_longer(film: &Film) -> f64 {
    longer(film).map_or(0.0, |part| figures::mean(film, part))
}

/// Returns the index of the film's part for longer paths, whose strategies have no images. None: no strategy has one.
fn longer(film: &Film) -> Option<usize> {
    film.layers().part_names().position(|name| name == "longer")
}

/// Returns the image of a strategy, in the size of the film's crop. None: the film keeps no such image.
pub fn strategy_image(film: &Film, kind: Kind, strategy: Strategy) -> Option<Pixels> {
    let part = kind.part(film.layers(), strategy)?;
    let crop = &film.settings().crop;
    let size = [crop.width() as usize, crop.height() as usize];
    let data = film.part_pixels(part).collect();
    Some(Pixels { size, data })
}
