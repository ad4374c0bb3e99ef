//! Where contributions add up, exactly.
//!
//! Two layers, as bidirectional estimators need them: **camera samples**, normalised per pixel and
//! pass, and the **light image**, whose splats may land anywhere and are normalised by the number of
//! light paths. Sums are fixed-point integers ([`fixed`]), so adding is associative and
//! commutative: the film has the same bits for any number of threads, any order, and any split of
//! the passes.
//!
//! A pixel's value is ∫ h(x - q) L(x) dx with ∫ h = 1 ([`Filter`]). Camera samples are drawn by |h|;
//! a splat goes to one pixel drawn by |h|, so that neighbouring pixels stay uncorrelated and
//! filters may be negative.
//!
//! A [`Film`] collects whole passes and knows which ([`PassSet`]), so that films of different passes
//! can be merged; the running one is in a [`PassBuffer`], shared by all threads without locks.
//! Squares of each pass's pixel totals, both layers together, give the variance.

mod filter;
pub mod fixed;
mod pass;
mod passes;
mod settings;

pub use filter::{Filter, FilterKind};
pub use pass::PassBuffer;
pub use passes::{ParsePassSetError, PassSet};
pub use settings::{FilmError, FilmSettings, PixelRect};

use crate::spectrum::{Rgb, luminance};
use fixed::{MOMENT_SCALE, VALUE_SCALE};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use thiserror::Error;

/// The exact sums of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelSums {
    /// Camera samples, in [`fixed::VALUE_SCALE`].
    pub camera: [i128; 3],
    /// Splats, in [`fixed::VALUE_SCALE`].
    pub light: [i128; 3],
    /// Squares of pass totals, in [`fixed::MOMENT_SCALE`].
    pub moment: [i128; 3],
}

impl PixelSums {
    /// How many sums a pixel has.
    pub const NUMBERS: usize = 9;

    /// All sums: camera, light, moment; red, green, blue.
    pub fn to_array(self) -> [i128; Self::NUMBERS] {
        let [a, b, c] = self.camera;
        let [d, e, f] = self.light;
        let [g, h, i] = self.moment;
        [a, b, c, d, e, f, g, h, i]
    }

    /// The inverse of [`Self::to_array`].
    pub fn from_array([a, b, c, d, e, f, g, h, i]: [i128; Self::NUMBERS]) -> Self {
        Self {
            camera: [a, b, c],
            light: [d, e, f],
            moment: [g, h, i],
        }
    }
}

/// Adds what other passes summed. Squares are positive, so that stopping at the top depends on no
/// order.
impl std::ops::AddAssign for PixelSums {
    fn add_assign(&mut self, other: Self) {
        for channel in 0..3 {
            self.camera[channel] += other.camera[channel];
            self.light[channel] += other.light[channel];
            self.moment[channel] = self.moment[channel].saturating_add(other.moment[channel]);
        }
    }
}

/// Why two films cannot become one.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MergeError {
    /// Both hold the same passes.
    #[error("both have the passes {0}")]
    Overlap(PassSet),
    /// They show different pixels.
    #[error("their resolutions or crops differ")]
    Geometry,
}

/// The sums of all passes so far.
#[derive(Clone, Debug)]
pub struct Film {
    settings: FilmSettings,
    passes: PassSet,
    pixels: Vec<PixelSums>,
}

/// A developed film: one colour and its variance per pixel, row by row from the top left of the
/// crop.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear Rec. 709. Shape: `width · height`.
    pub pixels: Vec<Rgb>,
    /// The estimated variance of each pixel's mean; zero after a single pass.
    /// Shape: `width · height`.
    pub variance: Vec<Rgb>,
}

impl Picture {
    /// The noise that is left: the root mean square of the pixels' standard errors, divided by the
    /// mean of the picture, both of luminance. Infinite for a black picture.
    ///
    /// Errors of a pixel's channels are taken as fully correlated, and stratified passes as
    /// independent, so it is rather too large than too small.
    pub fn relative_error(&self) -> f64 {
        let n = self.pixels.len().max(1) as f64;
        let mean = self.pixels.iter().map(|rgb| f64::from(luminance(*rgb)));
        let mean = mean.sum::<f64>() / n;
        let squares = self.variance.iter().map(|variance| {
            let error = f64::from(luminance(variance.map(f32::sqrt)));
            error * error
        });
        let error = libm::sqrt(squares.sum::<f64>() / n);
        if mean > 0.0 {
            error / mean
        } else {
            f64::INFINITY
        }
    }
}

impl Film {
    /// An empty film.
    ///
    /// Errors: the film would need more memory than `memory_limit` bytes.
    pub fn new(settings: FilmSettings, memory_limit: u64) -> Result<Self, FilmError> {
        let needed = u128::from(settings.crop.area()) * u128::from(Self::BYTES_PER_PIXEL);
        if needed > u128::from(memory_limit) {
            return Err(FilmError::TooLarge {
                needed,
                limit: memory_limit,
            });
        }
        let pixels = vec![PixelSums::default(); settings.crop.area() as usize];
        Ok(Self {
            settings,
            passes: PassSet::default(),
            pixels,
        })
    }

    /// A film as it was stored.
    ///
    /// Errors: there are not as many `pixels` as the crop has.
    pub fn restore(
        settings: FilmSettings,
        passes: PassSet,
        pixels: Vec<PixelSums>,
    ) -> Result<Self, MergeError> {
        if pixels.len() as u64 != settings.crop.area() {
            return Err(MergeError::Geometry);
        }
        Ok(Self {
            settings,
            passes,
            pixels,
        })
    }

    /// What one pixel costs, the running pass included.
    pub const BYTES_PER_PIXEL: u64 = (size_of::<PixelSums>() + PassBuffer::BYTES_PER_PIXEL) as u64;

    /// The film's geometry and filter.
    pub fn settings(&self) -> &FilmSettings {
        &self.settings
    }

    /// The passes that were added.
    pub fn passes(&self) -> &PassSet {
        &self.passes
    }

    /// The exact sums, row by row from the top left of the crop.
    pub fn pixels(&self) -> &[PixelSums] {
        &self.pixels
    }

    /// Adds the passes of another film of the same render.
    ///
    /// Errors: some passes are in both, or the geometries differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        let (a, b) = (&self.settings, &other.settings);
        if a.resolution != b.resolution || a.crop != b.crop {
            return Err(MergeError::Geometry);
        }
        let both = self.passes.intersection(&other.passes);
        if !both.is_empty() {
            return Err(MergeError::Overlap(both));
        }
        self.passes = self.passes.union(&other.passes);
        for (sums, added) in self.pixels.iter_mut().zip(&other.pixels) {
            *sums += *added;
        }
        Ok(())
    }

    /// Adds finished pass number `index`, which must not be there yet.
    pub fn add_pass(&mut self, index: u64, pass: &PassBuffer) {
        debug_assert!(
            !self.passes.contains(index),
            "pass {index} was added before"
        );
        let per_light_path = 1.0 / self.settings.light_paths().max(1) as f64;
        self.pixels
            .par_iter_mut()
            .enumerate()
            .with_min_len(4096)
            .for_each(|(i, sums)| {
                let (camera, light) = pass.pixel(i);
                let moment = std::array::from_fn(|channel| {
                    let total = fixed::to_f64(camera[channel], VALUE_SCALE)
                        + fixed::to_f64(light[channel], VALUE_SCALE) * per_light_path;
                    fixed::from_f64(total * total, MOMENT_SCALE)
                });
                *sums += PixelSums {
                    camera,
                    light,
                    moment,
                };
            });
        self.passes.insert(index..index + 1);
    }

    /// The mean of all passes with the variance of that mean, exposed.
    pub fn develop(&self) -> Picture {
        let developed = self.pixels.iter().map(|sums| self.develop_pixel(sums));
        let (pixels, variance) = developed.unzip();
        Picture {
            width: self.settings.crop.width() as usize,
            height: self.settings.crop.height() as usize,
            pixels,
            variance,
        }
    }

    fn develop_pixel(&self, sums: &PixelSums) -> (Rgb, Rgb) {
        let passes = self.passes.len().max(1) as f64;
        let light_paths = passes * self.settings.light_paths().max(1) as f64;
        let exposure = f64::from(self.settings.exposure);
        let (mut value, mut variance) = ([0.0; 3], [0.0; 3]);
        for channel in 0..3 {
            let mean = fixed::to_f64(sums.camera[channel], VALUE_SCALE) / passes
                + fixed::to_f64(sums.light[channel], VALUE_SCALE) / light_paths;
            let square = fixed::to_f64(sums.moment[channel], MOMENT_SCALE) / passes;
            value[channel] = (mean * exposure) as f32;
            let of_mean = (square - mean * mean).max(0.0) / (passes - 1.0).max(1.0);
            variance[channel] = (of_mean * exposure * exposure) as f32;
        }
        (value, variance)
    }
}

/// The same passes, geometry and sums, bit for bit.
impl PartialEq for Film {
    fn eq(&self, other: &Self) -> bool {
        self.passes == other.passes
            && self.settings.resolution == other.settings.resolution
            && self.settings.crop == other.settings.crop
            && self.pixels == other.pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;

    fn film(width: u32, height: u32, filter: Filter) -> Film {
        let settings = FilmSettings::new([width, height], filter);
        Film::new(settings, u64::MAX).unwrap()
    }

    #[test]
    fn both_layers_add_up_with_their_own_counts() {
        let mut film = film(2, 2, Filter::default());
        for pass in 0..2u8 {
            let buffer = PassBuffer::new(film.settings());
            buffer.set_camera_sample(3, [1.0, f32::from(pass), 0.0]);
            buffer.splat(
                film.settings(),
                Vec2::new(1.5, 1.5),
                [4.0, 0.0, 8.0],
                Vec2::splat(0.5),
            );
            film.add_pass(pass.into(), &buffer);
        }
        let picture = film.develop();
        let bits = |rgb: Rgb| rgb.map(f32::to_bits);
        assert_eq!(bits(picture.pixels[3]), bits([2.0, 0.5, 2.0]));
        assert_eq!(bits(picture.variance[3]), bits([0.0, 0.25, 0.0]));
        assert_eq!(bits(picture.pixels[0]), bits([0.0; 3]));
        // The green of one pixel in four has standard error ½; luminance is 0.2126 R + 0.7152 G + 0.0722 B.
        let mean = (0.2126 * 2.0 + 0.7152 * 0.5 + 0.0722 * 2.0) / 4.0;
        let error = 0.7152 * 0.5 / 2.0;
        assert!((picture.relative_error() - error / mean).abs() < 1e-3);
    }

    #[test]
    fn a_film_beyond_the_limit_is_refused() {
        let settings = FilmSettings::new([1_000_000, 1_000_000], Filter::default());
        let error = Film::new(settings, 1 << 33).unwrap_err();
        assert!(matches!(error, FilmError::TooLarge { .. }));
    }

    #[test]
    fn order_does_not_change_a_bit() {
        let values = [[1e-7, 3.0, 1e9], [0.1, 1e-9, 5.0], [7e5, 0.3, 2e-5]];
        let add = |order: [usize; 3]| {
            let mut film = film(1, 1, Filter::default());
            let buffer = PassBuffer::new(film.settings());
            for i in order {
                buffer.splat(
                    film.settings(),
                    Vec2::splat(0.5),
                    values[i],
                    Vec2::splat(0.5),
                );
            }
            film.add_pass(0, &buffer);
            film
        };
        assert!(add([0, 1, 2]) == add([2, 0, 1]));
    }
}
