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
//! A [`Film`] collects whole passes; the running one is in a [`PassBuffer`], shared by all threads
//! without locks. Squares of each pass's pixel totals, both layers together, give the variance.

mod filter;
pub mod fixed;
mod pass;
mod settings;

pub use filter::{Filter, FilterKind};
pub use pass::PassBuffer;
pub use settings::{FilmError, FilmSettings, PixelRect};

use crate::spectrum::Rgb;
use fixed::{MOMENT_SCALE, VALUE_SCALE};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

/// The exact sums of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct PixelSums {
    /// Camera samples, in [`fixed::VALUE_SCALE`].
    camera: [i128; 3],
    /// Splats, in [`fixed::VALUE_SCALE`].
    light: [i128; 3],
    /// Squares of pass totals, in [`fixed::MOMENT_SCALE`].
    moment: [i128; 3],
}

/// The sums of all passes so far.
#[derive(Clone, Debug)]
pub struct Film {
    settings: FilmSettings,
    passes: u64,
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
            passes: 0,
            pixels,
        })
    }

    /// What one pixel costs, the running pass included.
    pub const BYTES_PER_PIXEL: u64 = (size_of::<PixelSums>() + PassBuffer::BYTES_PER_PIXEL) as u64;

    /// The film's geometry and filter.
    pub fn settings(&self) -> &FilmSettings {
        &self.settings
    }

    /// The number of passes added.
    pub fn passes(&self) -> u64 {
        self.passes
    }

    /// Adds a finished pass.
    pub fn add_pass(&mut self, pass: &PassBuffer) {
        let per_light_path = 1.0 / self.settings.light_paths().max(1) as f64;
        self.pixels
            .par_iter_mut()
            .enumerate()
            .with_min_len(4096)
            .for_each(|(i, sums)| {
                let (camera, light) = pass.pixel(i);
                for channel in 0..3 {
                    sums.camera[channel] += camera[channel];
                    sums.light[channel] += light[channel];
                    let total = fixed::to_f64(camera[channel], VALUE_SCALE)
                        + fixed::to_f64(light[channel], VALUE_SCALE) * per_light_path;
                    let square = fixed::from_f64(total * total, MOMENT_SCALE);
                    // Squares are positive, so that stopping at the top depends on no order.
                    sums.moment[channel] = sums.moment[channel].saturating_add(square);
                }
            });
        self.passes += 1;
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
        let passes = self.passes.max(1) as f64;
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
        for pass in 0..2 {
            let buffer = PassBuffer::new(film.settings());
            buffer.set_camera_sample(3, [1.0, pass as f32, 0.0]);
            buffer.splat(
                film.settings(),
                Vec2::new(1.5, 1.5),
                [4.0, 0.0, 8.0],
                Vec2::splat(0.5),
            );
            film.add_pass(&buffer);
        }
        let picture = film.develop();
        let bits = |rgb: Rgb| rgb.map(f32::to_bits);
        assert_eq!(bits(picture.pixels[3]), bits([2.0, 0.5, 2.0]));
        assert_eq!(bits(picture.variance[3]), bits([0.0, 0.25, 0.0]));
        assert_eq!(bits(picture.pixels[0]), bits([0.0; 3]));
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
            film.add_pass(&buffer);
            film
        };
        assert!(add([0, 1, 2]) == add([2, 0, 1]));
    }
}
