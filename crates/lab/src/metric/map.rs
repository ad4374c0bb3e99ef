//! Maps of the errors of all pixels, and false-colour images of them.

use super::Kept;
use crate::blocks::{Blocks, Tally};
use crate::image::{Pair, Pixels};
use formats::image::Encoding;

/// The error of every pixel, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    /// Width and height.
    pub size: [usize; 2],
    /// Errors. Shape: `width · height`. Range: not negative, or not finite.
    pub data: Vec<f64>,
}

impl ErrorMap {
    /// Computes the mean of `error(image, reference)` over the channels of each pixel.
    pub(super) fn of_channels(pair: &Pair<'_>, error: impl Fn(f64, f64) -> f64) -> Self {
        let pixel = |(a, b): (&[f32; 3], &[f32; 3])| {
            let channels = a.iter().zip(b);
            let errors = channels.map(|(&a, &b)| error(f64::from(a), f64::from(b)));
            errors.sum::<f64>() / 3.0
        };
        let pixels = pair.image().data.iter().zip(&pair.reference().data);
        Self {
            size: pair.size(),
            data: pixels.map(pixel).collect(),
        }
    }

    /// Computes the mean over channels of `error(image, reference)`, of means over blocks of `block` × `block`
    /// pixels; every pixel gets the error of its block.
    pub(super) fn of_blocks(
        pair: &Pair<'_>,
        block: usize,
        error: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let blocks = Blocks::new(pair.size(), block);
        let image = blocks.sums(pair.image());
        let reference = blocks.sums(pair.reference());
        let of = |(a, b): (&[Tally], &[Tally])| {
            let channels = a.iter().zip(b);
            channels
                .map(|(a, b)| error(a.mean(), b.mean()))
                .sum::<f64>()
                / 3.0
        };
        let each = image.chunks(3).zip(reference.chunks(3)).map(of);
        let errors: Vec<f64> = each.collect();
        let pixels = pair.image().data.len();
        Self {
            size: pair.size(),
            data: (0..pixels).map(|pixel| errors[blocks.of(pixel)]).collect(),
        }
    }

    pub(super) fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self {
            data: self.data.into_iter().map(change).collect(),
            ..self
        }
    }

    /// Computes the mean of `value(error)` over the included pixels; NaN if there are none.
    pub(super) fn mean_of(&self, kept: Kept, value: impl Fn(f64) -> f64) -> f64 {
        let mean = |errors: &[f64]| {
            let sum: f64 = errors.iter().map(|&error| value(error)).sum();
            sum / errors.len() as f64
        };
        match kept {
            Kept::All => mean(&self.data),
            Kept::WithoutWorst => mean(&self.without_worst()),
        }
    }

    /// Returns all but the ⌈0.001 n⌉ largest errors, unordered; NaN counts as the largest.
    fn without_worst(&self) -> Vec<f64> {
        let mut errors = self.data.clone();
        let kept = errors.len() - errors.len().div_ceil(1000);
        if kept > 0 {
            // The sign of a NaN is arbitrary.
            errors.select_nth_unstable_by(kept, |a, b| a.abs().total_cmp(&b.abs()));
        }
        errors.truncate(kept);
        errors
    }

    /// Makes a false-colour image in linear light: black is 0, pale yellow `full` and above, green NaN.
    ///
    /// The colours become brighter monotonically, as in the papers on FLIP.
    pub fn false_color(&self, full: f64) -> Pixels {
        let color = |&error: &f64| {
            if error.is_nan() {
                return [0.0, 1.0, 0.0];
            }
            magma((error / full).clamp(0.0, 1.0)).map(|stored| Encoding::Srgb.decode(stored) as f32)
        };
        Pixels {
            size: self.size,
            data: self.data.iter().map(color).collect(),
        }
    }
}

/// Evaluates the colour map magma \[SmithWalt15\] in sRGB. Range: `t` in `[0, 1]`.
///
/// Polynomials of degree 6 are fitted to its table of 256 colours by least squares; the largest deviation of
/// a channel is 0.024.
fn magma(t: f64) -> [f64; 3] {
    const FIT: [[f64; 7]; 3] = [
        [-0.0021, 0.2505, 8.3459, -27.667, 52.1707, -50.7586, 18.6643],
        [-0.0007, 0.6945, -3.596, 14.2539, -27.9446, 29.0539, -11.49],
        [-0.0095, 2.4953, 0.3291, -13.6466, 12.8811, 4.2699, -5.5708],
    ];
    // Horner's rule, from the highest power.
    let value = |fit: [f64; 7]| fit.iter().rev().fold(0.0, |sum, c| sum * t + c);
    FIT.map(|fit| value(fit).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magma_goes_from_black_to_pale_yellow() {
        // Entries 0, 128 and 255 of the table.
        for (t, expected) in [
            (0.0, [0.0015, 0.0005, 0.0139]),
            (128.0 / 255.0, [0.7164, 0.2150, 0.4753]),
            (1.0, [0.9871, 0.9914, 0.7495]),
        ] {
            for (value, expected) in magma(t).into_iter().zip(expected) {
                assert!((value - expected).abs() < 0.024, "{t}: {value} {expected}");
            }
        }
        // Luminance increases.
        let luminance = |t| {
            let [r, g, b] = magma(t).map(|stored| Encoding::Srgb.decode(stored));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for step in 4..100 {
            let t = f64::from(step) / 100.0;
            assert!(luminance(t + 0.01) > luminance(t), "{t}");
        }
    }

    #[test]
    fn errors_above_the_maximum_have_its_color_and_nan_is_green() {
        let map = ErrorMap {
            size: [4, 1],
            data: vec![0.5, 0.7, f64::INFINITY, f64::NAN],
        };
        let colors = map.false_color(0.5).data;
        let colors: Vec<_> = colors.iter().map(|color| color.map(f32::to_bits)).collect();
        assert_eq!(colors[0], colors[1]);
        assert_eq!(colors[0], colors[2]);
        assert_eq!(colors[3], [0.0, 1.0f32, 0.0].map(f32::to_bits));
    }
}
