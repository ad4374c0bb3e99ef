//! The picture of a render after a pass.

use bidir::film::{Film, FilmSettings};
use bidir::spectrum::Rgb;

/// A picture between two passes: camera samples plus light image. Any number of clients share it.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The film's geometry: the picture is its crop.
    pub film: FilmSettings,
    /// The number of passes in the picture.
    pub passes: u64,
    /// Linear Rec. 709, row by row from the top left of the crop.
    pub pixels: Vec<Rgb>,
    /// The estimated variance of each pixel's mean; zero after a single pass.
    pub variance: Vec<Rgb>,
    /// The remaining noise, by [`Picture::relative_error`](bidir::film::Picture::relative_error).
    pub relative_error: f64,
}

impl Frame {
    /// Returns the picture of `film`.
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
