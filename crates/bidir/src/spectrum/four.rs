//! Four spectra at once: a register holds one lane of each.

use super::{Lanes, Spectrum};
use crate::math::lanes::transpose;
use glam::{BVec4A, Vec4};
use std::ops::Mul;

/// Four spectra. Operations give the same bits as those of [`Spectrum`] on each of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FourSpectra([Vec4; 4]);

impl FourSpectra {
    /// Packs four spectra.
    #[inline]
    pub(crate) fn of(spectra: [Spectrum; 4]) -> Self {
        Self(transpose(spectra.map(Spectrum::lanes)))
    }

    /// Returns the four spectra.
    #[inline]
    pub(crate) fn each(self) -> [Spectrum; 4] {
        transpose(self.0).map(|lanes| Spectrum(lanes.to_array()))
    }

    /// Returns true for each spectrum that is exactly zero.
    #[inline]
    pub(crate) fn are_black(self) -> BVec4A {
        self.all(|lanes| lanes.cmpeq(Vec4::ZERO))
    }

    /// Returns true for each spectrum with no lane that is NaN, or larger than `limit` in absolute value.
    #[inline]
    pub(crate) fn are_within(self, limit: f32) -> BVec4A {
        self.all(|lanes| lanes.abs().cmple(Vec4::splat(limit)))
    }

    /// Returns true for each spectrum in which `is` holds for every lane.
    #[inline]
    fn all(self, is: impl Fn(Vec4) -> BVec4A) -> BVec4A {
        let [a, b, c, d] = self.0.map(is);
        (a & b) & (c & d)
    }

    /// Returns the mean of absolute values of each spectrum, over the lanes that carry light.
    #[inline]
    pub(crate) fn abs_means(self, lanes: Lanes) -> Vec4 {
        match lanes {
            Lanes::Rgb => {
                let [r, g, b, _] = self.0.map(Vec4::abs);
                (r + g + b) * (1.0 / 3.0)
            }
            #[cfg(test)]
            Lanes::Permuted(_) => {
                let means = self
                    .each()
                    .map(|spectrum| lanes.mean(spectrum.map(f32::abs)));
                Vec4::from_array(means)
            }
        }
    }
}

/// Multiplies each spectrum by the same one.
impl Mul<Spectrum> for FourSpectra {
    type Output = Self;
    #[inline]
    fn mul(self, Spectrum([a, b, c, d]): Spectrum) -> Self {
        let [of_a, of_b, of_c, of_d] = self.0;
        Self([of_a * a, of_b * b, of_c * c, of_d * d])
    }
}

/// Multiplies each spectrum by its own number.
impl Mul<Vec4> for FourSpectra {
    type Output = Self;
    #[inline]
    fn mul(self, scales: Vec4) -> Self {
        Self(self.0.map(|lanes| lanes * scales))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_are_as_each_alone() {
        let spectra = [
            Spectrum([0.1, -0.2, 0.3, 0.0]),
            Spectrum([0.0, 0.0, -0.0, 0.0]),
            Spectrum([7e20, 1e-20, 2.0, 0.0]),
            Spectrum([f32::NAN, 0.0, 0.0, 0.0]),
        ];
        let (by, scales) = (Spectrum([0.3, 0.7, 0.9, 1.0]), [3.0, 0.5, 1e20, 1.0]);
        let four = FourSpectra::of(spectra) * by * Vec4::from_array(scales);
        let lanes = Lanes::Rgb;
        let means = four.abs_means(lanes);
        for i in 0..4 {
            let alone = spectra[i] * by * scales[i];
            assert_eq!(
                four.each()[i].0.map(f32::to_bits),
                alone.0.map(f32::to_bits)
            );
            assert_eq!(four.are_black().test(i), alone.is_black());
            assert_eq!(four.are_within(1e20).test(i), alone.is_within(1e20));
            let mean = lanes.mean(alone.map(f32::abs));
            assert_eq!(means[i].to_bits(), mean.to_bits());
        }
    }
}
