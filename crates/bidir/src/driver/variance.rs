//! The variance of each strategy's weighted contribution.
//!
//! Y is the luminance that a pass adds to a pixel by one strategy, and m its mean. V is the variance of a pass,
//! averaged over pixels: V = mean over pixels of E\[Y²\] - m². The n samples of this session give Σ y²; the
//! strategy's image of all P passes gives m of each pixel.
//!
//! - t ≥ 2: a sample adds y only to its own pixel, so V = Σ y² / n - mean m².
//! - t = 1: a pass has L = N/k light paths, N pixels and k samples for each light path. A path adds
//!   y/N, k being in y already, to one of the pixels. The nL/N paths of the session have the mean
//!   E\[y²\] = k Σ y² / n, of which each pixel has 1/N on average, so
//!   V = L (k Σ y² / (n N³) - mean (m/L)²) = (Σ y² / (n N k) - mean m²) / L.
//!
//! Both are one formula, with N = k = L = 1 for t ≥ 2. The mean m̂ of the image has the variance V/P, which makes m̂²
//! too large by V/P on average, so the result is divided by 1 - 1/(P L). Stratified passes are treated as
//! independent, so V is rather too large than too small.

use super::Session;
use crate::path::Strategy;
use crate::spectrum::luminance;

/// The moments of the values that a strategy adds to the picture in one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrategyMoments {
    /// The strategy.
    pub strategy: Strategy,
    /// The mean luminance of its weighted image, of all passes, with exposure.
    pub mean: f64,
    /// The variance V, with exposure. None: the film has less than two passes, or this session rendered none.
    pub variance: Option<f64>,
}

impl Session<'_> {
    /// Returns the moments of each strategy that the film keeps an image of, in the order of their images.
    pub fn strategy_moments(&self) -> impl Iterator<Item = StrategyMoments> {
        let layers = self.film().layers();
        let parts = layers.kept_strategies();
        parts.filter_map(move |strategy| {
            let part = self.film().layers().weighted_part(strategy)?;
            let pixels = self.film().part_pixels(part);
            let luminances = pixels.map(|pixel| f64::from(luminance(pixel)));
            let (count, sum, squares) = luminances.fold((0.0, 0.0, 0.0), |(n, sum, squares), y| {
                (n + 1.0, sum + y, squares + y * y)
            });
            Some(StrategyMoments {
                strategy,
                mean: sum / count,
                variance: self.variance(strategy, squares / count),
            })
        })
    }

    /// Returns V of a strategy, given the mean square of its image's pixels.
    fn variance(&self, strategy: Strategy, mean_square: f64) -> Option<f64> {
        let (passes, samples) = (self.film().passes().len(), self.stats().samples);
        if passes < 2 || samples == 0 {
            return None;
        }
        let film = self.film().settings();
        let exposure = f64::from(film.exposure);
        let squares = self.stats().strategy_images.get(strategy).squares();
        let of_sample = squares * exposure * exposure / samples as f64;
        let (pixels, paths) = match strategy.t {
            1 => {
                let pixels = film.pixel_count().max(1) as f64;
                (pixels, self.counts().light_subpaths)
            }
            _ => (1.0, 1.0),
        };
        let variance = (of_sample * paths / (pixels * pixels) - mean_square) / paths;
        let of_estimate = 1.0 - 1.0 / (passes as f64 * paths);
        Some((variance / of_estimate).max(0.0))
    }
}
