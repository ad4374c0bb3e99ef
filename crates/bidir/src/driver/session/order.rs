//! The order in which a pass takes its samples.

use super::super::spread;
use crate::film::PixelRect;
use crate::integrator::Method;

/// Which pixel the sample at each place of a pass belongs to.
///
/// Samples at places that follow each other share light subpaths where a method shares any, and so
/// part of their error. Neighbours with a common error would be seen as streaks: such places are spread over
/// the film.
pub(super) enum Order {
    /// Row order of the crop.
    Rows,
    /// For each place the position of its pixel in row order.
    Spread(Vec<u32>),
}

impl Order {
    /// Returns the order of a crop for a method. Crops of 2³² pixels or more keep the order of rows.
    pub(super) fn new(crop: PixelRect, method: &Method) -> Self {
        let fits = u32::try_from(crop.area()).is_ok();
        if fits && method.shares_light() {
            Self::Spread(spread::permutation(&crop))
        } else {
            Self::Rows
        }
    }

    /// Returns the position in row order of the pixel at `place`.
    #[inline]
    pub(super) fn pixel(&self, place: u64) -> usize {
        match self {
            Self::Rows => place as usize,
            Self::Spread(pixels) => pixels[place as usize] as usize,
        }
    }

    /// Returns the place of the pixel at a position in row order. It is searched for.
    pub(super) fn place(&self, pixel: usize) -> u64 {
        let place = match self {
            Self::Rows => Some(pixel),
            Self::Spread(pixels) => pixels.iter().position(|&other| other as usize == pixel),
        };
        place.unwrap_or(pixel) as u64
    }
}
