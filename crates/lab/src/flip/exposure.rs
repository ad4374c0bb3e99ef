//! Tone mapping of HDR images, and the exposures of HDR-FLIP \[Andersson21\].
//!
//! The tone curve is the fit of ACES by \[Narkowicz16\], without its exposure of 0.6,
//!
//!   T(x) = (k_0 x² + k_1 x + k_2) / (k_3 x² + k_4 x + k_5),
//!
//! for each channel, clamped to [0, 1]. Let x_t be the light with T(x_t) = 0.85. The first exposure maps the
//! reference's brightest pixel to x_t, the last one the reference's median:
//!
//!   start = log2(x_t / max Y),   stop = log2(x_t / median Y),   count = max(2, ⌈stop - start⌉).

use super::color::luminance;
use crate::image::Pixels;

/// The coefficients k of T.
const ACES: [f32; 6] = [
    0.6 * 0.6 * 2.51,
    0.6 * 0.03,
    0.0,
    0.6 * 0.6 * 2.43,
    0.6 * 0.59,
    0.14,
];

/// Evaluates T(x); the caller clamps it.
pub(super) fn tone_map(x: f32) -> f32 {
    // T is flat beyond, and squares stay finite.
    let x = if x > 1e6 { 1e6 } else { x };
    let [k0, k1, k2, k3, k4, k5] = ACES;
    (k0 * x * x + k1 * x + k2) / (k3 * x * x + k4 * x + k5)
}

/// Evenly spaced exposures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The first. Unit: stops.
    pub start: f64,
    /// The last. Unit: stops.
    pub stop: f64,
    /// The number of exposures, at least 1.
    pub count: usize,
}

impl Exposures {
    /// Computes the exposures for a reference.
    ///
    /// A median of 0 counts as 2⁻²⁰ of the maximum, so that the last exposure is finite. A black reference
    /// has the single exposure 0.
    pub fn of(reference: &Pixels) -> Self {
        let y = |rgb: &[f32; 3]| luminance(rgb.map(|channel| channel.clamp(0.0, f32::MAX)));
        let mut luminances: Vec<f32> = reference.data.iter().map(y).collect();
        let middle = luminances.len() / 2;
        let largest = luminances.iter().copied().fold(0.0, f32::max);
        if largest <= 0.0 {
            return Self {
                start: 0.0,
                stop: 0.0,
                count: 1,
            };
        }
        // Of two medians, the authors' program takes the upper one.
        let (_, median, _) = luminances.select_nth_unstable_by(middle, f32::total_cmp);
        let [largest, median] = [largest, *median].map(f64::from);
        let median = median.max(largest * libm::exp2(-20.0));
        let shown = light_shown_as(0.85);
        let [start, stop] = [largest, median].map(|y| libm::log2(shown / y));
        Self {
            start,
            stop,
            count: (libm::ceil(stop - start) as usize).max(2),
        }
    }

    /// Iterates over the exposures. Unit: stops.
    pub(super) fn stops(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / self.count.saturating_sub(1).max(1) as f64;
        (0..self.count).map(move |i| self.start + i as f64 * step)
    }
}

/// Solves T(x) = t: the positive root of (k_0 - t k_3) x² + (k_1 - t k_4) x + k_2 - t k_5.
fn light_shown_as(t: f64) -> f64 {
    let [k0, k1, k2, k3, k4, k5] = ACES.map(f64::from);
    let (a, b, c) = (k0 - t * k3, k1 - t * k4, k2 - t * k5);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_the_tone_curve_is_exact() {
        let x = light_shown_as(0.85);
        assert!((tone_map(x as f32) - 0.85).abs() < 1e-6, "{x}");
    }

    #[test]
    fn exposures_reach_from_the_maximum_to_the_median() {
        let grey = |values: &[f32]| Pixels {
            size: [values.len(), 1],
            data: values.iter().map(|&value| [value; 3]).collect(),
        };
        let exposures = Exposures::of(&grey(&[16.0, 0.5, 0.0, 1.0, 0.25]));
        let brightest = libm::log2(light_shown_as(0.85) / 16.0);
        assert!((exposures.start - brightest).abs() < 1e-6);
        assert!((exposures.stop - brightest - 5.0).abs() < 1e-6);
        let stops: Vec<f64> = exposures.stops().collect();
        assert_eq!(stops.len(), exposures.count);
        assert!((stops[stops.len() - 1] - exposures.stop).abs() < 1e-9);
        let dark = Exposures::of(&grey(&[1.0, 0.0, 0.0]));
        assert!((dark.stop - dark.start - 20.0).abs() < 1e-6);
        assert_eq!(Exposures::of(&grey(&[0.0])).count, 1);
        assert_eq!(Exposures::of(&grey(&[])).count, 1);
    }

    #[test]
    fn the_tone_curve_is_finite_for_any_light() {
        for x in [0.0, 1.0, 1e9, f32::MAX, f32::INFINITY] {
            assert!(tone_map(x).is_finite(), "{x}");
        }
    }
}
