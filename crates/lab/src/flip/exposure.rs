//! How light of any strength is brought to a screen, and at which exposures \[Andersson21\].
//!
//! The curve is that of ACES as \[Narkowicz16\] fitted it, with its exposure of 0.6 undone,
//!
//!   T(x) = (k_0 x² + k_1 x + k_2) / (k_3 x² + k_4 x + k_5),
//!
//! for each channel, clamped to [0, 1]. With x_t the light that it shows as T(x_t) = 0.85, the
//! exposures go from the one that shows the reference's brightest pixel so to the one that shows its
//! median so:
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

/// T(x), which the caller clamps.
pub(super) fn tone_map(x: f32) -> f32 {
    // T is flat there, and squares stay finite.
    let x = if x > 1e6 { 1e6 } else { x };
    let [k0, k1, k2, k3, k4, k5] = ACES;
    (k0 * x * x + k1 * x + k2) / (k3 * x * x + k4 * x + k5)
}

/// Exposures, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The first. Unit: stops.
    pub start: f64,
    /// The last. Unit: stops.
    pub stop: f64,
    /// How many; at least 1.
    pub count: usize,
}

impl Exposures {
    /// The exposures that suit a reference.
    ///
    /// A median of 0 counts as 2⁻²⁰ of the maximum, so that there is a last exposure; for a black
    /// reference the exposures are 0 alone, as nothing says any other.
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
        // Of two medians the upper one, as the authors' program takes it.
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

    /// Every exposure. Unit: stops.
    pub(super) fn stops(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / self.count.saturating_sub(1).max(1) as f64;
        (0..self.count).map(move |i| self.start + i as f64 * step)
    }
}

/// The light x of T(x) = t: the positive root of (k_0 - t k_3) x² + (k_1 - t k_4) x + k_2 - t k_5.
fn light_shown_as(t: f64) -> f64 {
    let [k0, k1, k2, k3, k4, k5] = ACES.map(f64::from);
    let (a, b, c) = (k0 - t * k3, k1 - t * k4, k2 - t * k5);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_inverted() {
        let x = light_shown_as(0.85);
        assert!((tone_map(x as f32) - 0.85).abs() < 1e-6, "{x}");
    }

    #[test]
    fn exposures_are_those_of_maximum_and_median() {
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
    fn the_brightest_light_is_shown() {
        for x in [0.0, 1.0, 1e9, f32::MAX, f32::INFINITY] {
            assert!(tone_map(x).is_finite(), "{x}");
        }
    }
}
