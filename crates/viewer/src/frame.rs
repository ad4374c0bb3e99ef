//! What a render looks like after a pass.

use bidir::film::{Film, FilmSettings};
use bidir::spectrum::Rgb;

/// A picture between two passes, both film layers composed, which any number of watchers share.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The film's geometry: the picture is its crop.
    pub film: FilmSettings,
    /// The passes that are in it.
    pub passes: u64,
    /// Linear Rec. 709, row by row from the top left of the crop.
    pub pixels: Vec<Rgb>,
    /// The estimated variance of each pixel's mean; zero after a single pass.
    pub variance: Vec<Rgb>,
    /// The noise that is left, as [`Picture::relative_error`](bidir::film::Picture::relative_error)
    /// has it.
    pub relative_error: f64,
}

impl Frame {
    /// What `film` shows now.
    pub fn new(film: &Film) -> Self {
        let picture = film.develop();
        Self {
            film: film.settings().clone(),
            passes: film.passes().len(),
            relative_error: picture.relative_error(),
            pixels: picture.pixels,
            variance: picture.variance,
        }
    }
}
