//! Lanes of another order, for tests: nothing but an edge of light transport may know which lane is which.
//!
//! Where a scene knows a curve, a lane has its value at one wavelength.

use super::{Curve, Illuminant, Lanes, RefractiveIndex, Spectrum};

/// The wavelength of each lane of [`Lanes::Rgb`], the empty one included. Unit: nm.
const WAVELENGTHS: [f64; 4] = [610.0, 550.0, 465.0, 500.0];

/// An order of the four lanes of [`Lanes::Rgb`](super::Lanes::Rgb), the empty one among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order(pub(crate) [usize; 4]);

impl Order {
    /// Orders the lanes of `Lanes::Rgb`.
    pub(super) fn of_rgb(self, rgb: Spectrum) -> Spectrum {
        Spectrum(self.0.map(|lane| rgb[lane]))
    }

    /// Returns the values of a curve at the wavelengths of the lanes.
    pub(crate) fn curve(self, curve: &Curve) -> Spectrum {
        self.of_rgb(Spectrum(WAVELENGTHS.map(|nm| curve.at(nm) as f32)))
    }

    /// Returns the lanes of light; the empty one is zero.
    pub(super) fn light(self, light: &Illuminant) -> Spectrum {
        let carrying = self.of_rgb(Lanes::Rgb.illuminant([1.0; 3]));
        light.hue().map_or_else(
            || self.of_rgb(Lanes::Rgb.light(light)),
            |hue| self.curve(hue) * carrying * light.luminance(),
        )
    }

    /// Returns an index at the wavelength of the first lane.
    pub(super) fn index(self, index: &RefractiveIndex) -> f32 {
        let curve = index.curve().map(|curve| self.curve(curve)[0]);
        curve.unwrap_or(index.at_d_line())
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
