//! The order in which a pass takes its samples.

use super::super::spread;
use crate::film::PixelRect;
use crate::integrator::Method;

/// The pixel of each slot, where slots number the samples of a pass in the order of rendering.
///
/// Samples at neighbouring slots share light subpaths if the method shares any, and so part of their error. If they
/// were neighbours on the film, too, their common error would show as streaks: their pixels are spread over the film.
pub(super) enum Order {
    /// Row order of the crop.
    Rows,
    /// The pixel of each slot, by its index in row order.
    Spread(Vec<u32>),
}

impl Order {
    /// Returns the order of a crop for a method. Crops of 2³² pixels or more have row order.
    pub(super) fn new(crop: PixelRect, method: &Method) -> Self {
        let fits = u32::try_from(crop.area()).is_ok();
        if fits && method.shares_light() {
            Self::Spread(spread::permutation(&crop))
        } else {
            Self::Rows
        }
    }

    /// Returns the index in row order of the pixel at `slot`.
    #[inline]
    pub(super) fn pixel(&self, slot: u64) -> usize {
        match self {
            Self::Rows => slot as usize,
            Self::Spread(pixels) => pixels[slot as usize] as usize,
        }
    }

    /// Returns the slot of a pixel by its index in row order. Takes a linear search.
    pub(super) fn slot(&self, pixel: usize) -> u64 {
        let slot = match self {
            Self::Rows => Some(pixel),
            Self::Spread(pixels) => pixels.iter().position(|&other| other as usize == pixel),
        };
        slot.unwrap_or(pixel) as u64
    }
}
