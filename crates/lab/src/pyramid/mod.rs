//! Images and numbers of each strategy (s, t), weighted and raw, of a film that keeps them.
//!
//! Weighted images add up to the picture. A raw image is C/π, without the weight: all of one number
//! n = s + t of vertices show the same light, as far as their strategies can make its paths, each with
//! the noise that it would have alone [Veach97, fig. 10.2].

mod figures;

pub use figures::{Figures, ImageFigures};

use crate::image::Pixels;
use bidir::film::{Film, LayerImage, Layers};
use bidir::path::Strategy;
use formats::film::Developed;

/// The most vertices of the paths whose strategies are shown where nobody says it.
pub const VERTICES: u16 = 6;
/// The most pixels of an image from side to side, and from top to bottom, where an experiment shows
/// them as tiles: images that are larger are shown no better.
pub const TILE: usize = 128;

/// The kind of the images of strategies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Each strategy with its weight: they add up to the picture.
    Weighted,
    /// Each strategy alone, without its weight.
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

/// The picture of a film with the images of strategies alone, as layers.
pub fn developed(film: &Film) -> Developed {
    let layers = film.layers();
    let names = layers.part_names().enumerate();
    let images = names.skip(layers.light_groups().len());
    let images = images.map(|(part, name)| LayerImage {
        name,
        channels: &["R", "G", "B"],
        data: film.part_pixels(part).flatten().collect(),
    });
    Developed {
        picture: film.develop(),
        layers: images.collect(),
    }
}

/// The mean luminance of a film's picture.
pub fn mean(film: &Film) -> f64 {
    figures::mean_of(film, film.develop().pixels.into_iter())
}

/// The mean luminance of what paths add that are longer than those with images of their own.
pub fn mean_of_longer(film: &Film) -> f64 {
    longer(film).map_or(0.0, |part| figures::mean(film, part))
}

/// The part of paths that are longer than those with images of their own. None: there are no such images.
fn longer(film: &Film) -> Option<usize> {
    film.layers().part_names().position(|name| name == "longer")
}

/// The image of a strategy, as large as the film. None: the film keeps none.
pub fn strategy_image(film: &Film, kind: Kind, strategy: Strategy) -> Option<Pixels> {
    let part = kind.part(film.layers(), strategy)?;
    let crop = &film.settings().crop;
    let size = [crop.width() as usize, crop.height() as usize];
    let data = film.part_pixels(part).collect();
    Some(Pixels { size, data })
}
