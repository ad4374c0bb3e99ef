//! Lanes of another order, for tests: nothing but an edge of light transport may know which lane is which.

use super::Spectrum;

/// An order of the four lanes of [`Lanes::Rgb`](super::Lanes::Rgb), the empty one among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order(pub(crate) [usize; 4]);

impl Order {
    /// Orders the lanes of `Lanes::Rgb`.
    pub(super) fn of_rgb(self, rgb: Spectrum) -> Spectrum {
        Spectrum(self.0.map(|lane| rgb[lane]))
    }

    /// Returns the lanes of `Lanes::Rgb`.
    pub(super) fn to_rgb(self, ordered: Spectrum) -> Spectrum {
        let mut rgb = Spectrum::ZERO;
        for (value, lane) in ordered.0.into_iter().zip(self.0) {
            rgb.0[lane] = value;
        }
        rgb
    }

    /// Finds the lane that has the meaning of lane number `rgb` of `Lanes::Rgb`.
    pub(super) fn lane(self, rgb: usize) -> usize {
        let place = self.0.iter().position(|&lane| lane == rgb);
        place.expect("every lane has a place")
    }
}
