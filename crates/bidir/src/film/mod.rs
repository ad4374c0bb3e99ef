//! The film: exact sums of contributions.
//!
//! A film has two layers, as bidirectional estimators need: **camera samples**, normalised per pixel and pass, and
//! the **light image**, whose splats may be anywhere and are divided by the number of pixels; where samples share
//! light subpaths, splats are scaled up beforehand. Sums are fixed-point integers ([`fixed`]), so that addition is
//! associative and commutative: the film has the same bits for any number of threads, any order, and any split of
//! the passes.
//!
//! A pixel's value is ∫ h(x - q) L(x) dx with ∫ h = 1 ([`Filter`]). Camera samples are drawn by |h|, up to the steps
//! of tables. A splat goes to one pixel drawn by |h|, so that neighbouring pixels stay uncorrelated and filters may
//! be negative.
//!
//! A [`Film`] holds whole passes and their numbers ([`PassSet`]), so that films of different passes can be merged.
//! The running pass is in a [`PassBuffer`], which all threads share without locks. The variance comes from the
//! squares of the pixel totals of each pass, both layers together.
//!
//! A film keeps images beside the picture if they are asked for ([`Layers`]).

mod develop;
mod filter;
mod layers;
mod memory;
mod pass;
mod passes;
mod sensor;
mod settings;

pub use develop::{LayerImage, Picture};
pub use filter::{Filter, FilterKind};
pub use layers::{Aov, AovKind, Channels, Layers, StrategyImages};
pub use memory::filled;
pub use pass::PassBuffer;
pub use passes::{ParsePassSetError, PassSet};
pub use sensor::Sensor;
pub use settings::{FilmError, FilmSettings, PixelRect, SplatPlace};

use crate::math::fixed::{self, MOMENT_SCALE, VALUE_SCALE};
use layers::PICTURE_SUMS;
use rayon::prelude::{IndexedParallelIterator, ParallelIterator, ParallelSliceMut};
use std::slice::ChunksExact;
use thiserror::Error;

/// The index of the first sum of camera samples in a pixel. Unit: [`fixed::VALUE_SCALE`].
const CAMERA: usize = 0;
/// The index of the first sum of splats. Unit: [`fixed::VALUE_SCALE`].
const LIGHT: usize = 3;
/// The index of the first sum of squares of pass totals. Unit: [`fixed::MOMENT_SCALE`].
const MOMENT: usize = 6;

/// Why two films cannot become one.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum MergeError {
    /// Both films hold these passes.
    #[error("both have the passes {0}")]
    Overlap(PassSet),
    /// The films show different pixels.
    #[error("their resolutions or crops differ")]
    Geometry,
    /// The films keep different images.
    #[error("their layers differ")]
    Layers,
}

/// The sums of all passes so far.
#[derive(Clone, Debug)]
pub struct Film {
    settings: FilmSettings,
    layers: Layers,
    passes: PassSet,
    /// The sums, pixel by pixel: of the picture, of features, of parts ([`Layers`]).
    sums: Vec<i128>,
}

impl Film {
    /// Makes an empty film of the picture only.
    ///
    /// Errors: as [`Self::with_layers`].
    pub fn new(settings: FilmSettings, memory_limit: u64) -> Result<Self, FilmError> {
        Self::with_layers(settings, Layers::default(), memory_limit)
    }

    /// Makes an empty film of a picture with `layers`.
    ///
    /// Errors: the film would need more memory than `memory_limit` bytes, or than the system has.
    pub fn with_layers(
        settings: FilmSettings,
        layers: Layers,
        memory_limit: u64,
    ) -> Result<Self, FilmError> {
        let needed = Self::memory(&settings, &layers);
        if needed > memory_limit {
            return Err(FilmError::TooLarge {
                needed,
                limit: memory_limit,
            });
        }
        let sums = filled(settings.crop.area() as usize * layers.sums(), || 0)?;
        Ok(Self {
            settings,
            layers,
            passes: PassSet::default(),
            sums,
        })
    }

    /// Makes a film as it was stored, with `sums` in the form of [`Self::sums`].
    ///
    /// Errors: the number of sums does not match the crop and the layers.
    pub fn restore(
        settings: FilmSettings,
        layers: Layers,
        passes: PassSet,
        sums: Vec<i128>,
    ) -> Result<Self, MergeError> {
        if sums.len() as u64 != settings.crop.area() * layers.sums() as u64 {
            return Err(MergeError::Geometry);
        }
        Ok(Self {
            settings,
            layers,
            passes,
            sums,
        })
    }

    /// Makes a film without passes, of the same geometry and layers.
    ///
    /// Errors: the system does not have the memory.
    pub fn emptied(&self) -> Result<Self, FilmError> {
        let (settings, layers) = (self.settings.clone(), self.layers.clone());
        Self::with_layers(settings, layers, u64::MAX)
    }

    /// Makes a copy of the film.
    ///
    /// Errors: the system does not have the memory.
    pub fn try_clone(&self) -> Result<Self, FilmError> {
        let mut copy = self.emptied()?;
        copy.passes = self.passes.clone();
        copy.sums.copy_from_slice(&self.sums);
        Ok(copy)
    }

    /// Returns the memory of a film and its running pass. Unit: bytes.
    pub fn memory(settings: &FilmSettings, layers: &Layers) -> u64 {
        let of_pixel = layers.sums() * size_of::<i128>() + PassBuffer::bytes_per_pixel(layers);
        settings.crop.area().saturating_mul(of_pixel as u64)
    }

    /// Returns the settings of the film.
    pub fn settings(&self) -> &FilmSettings {
        &self.settings
    }

    /// Returns the images kept beside the picture.
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// Returns the set of passes that were added.
    pub fn passes(&self) -> &PassSet {
        &self.passes
    }

    /// Returns the exact sums, row by row from the top left of the crop. Each pixel has, in this order: camera
    /// samples, splats, and squares of pass totals, each of red, green and blue; the sums of [`Layers::aovs`]; and,
    /// for each part, camera samples and splats.
    pub fn sums(&self) -> &[i128] {
        &self.sums
    }

    /// Returns the sums of each pixel.
    fn pixels(&self) -> ChunksExact<'_, i128> {
        self.sums.chunks_exact(self.layers.sums())
    }

    /// Numbers the passes anew, from `first` on, so that films of different seeds can be merged.
    #[must_use]
    pub fn numbered_from(self, first: u64) -> Self {
        let passes = PassSet::from(first..first + self.passes.len());
        Self { passes, ..self }
    }

    /// Adds the passes of another film of the same render.
    ///
    /// Errors: some passes are in both films, or the geometries or layers differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        self.check_mergeable(other)?;
        self.passes = self.passes.union(&other.passes);
        for (sum, &added) in self.sums.iter_mut().zip(&other.sums) {
            // Only squares can reach the largest number. They are positive, so that saturation does not depend on the
            // order.
            *sum = sum.saturating_add(added);
        }
        Ok(())
    }

    /// Merges like [`Self::merge`], but takes the sums of `other` without a copy if no pass was added yet.
    pub fn adopt(&mut self, other: Self) -> Result<(), MergeError> {
        if !self.passes.is_empty() {
            return self.merge(&other);
        }
        self.check_mergeable(&other)?;
        (self.passes, self.sums) = (other.passes, other.sums);
        Ok(())
    }

    fn check_mergeable(&self, other: &Self) -> Result<(), MergeError> {
        let (a, b) = (&self.settings, &other.settings);
        if a.resolution != b.resolution || a.crop != b.crop {
            return Err(MergeError::Geometry);
        }
        if self.layers != other.layers {
            return Err(MergeError::Layers);
        }
        let both = self.passes.intersection(&other.passes);
        if both.is_empty() {
            Ok(())
        } else {
            Err(MergeError::Overlap(both))
        }
    }

    /// Adds the finished pass number `index`, which the film must not hold yet.
    pub fn add_pass(&mut self, index: u64, pass: &PassBuffer) {
        debug_assert!(
            !self.passes.contains(index),
            "pass {index} was added before"
        );
        let per_pixel = 1.0 / self.settings.pixel_count().max(1) as f64;
        self.sums
            .par_chunks_exact_mut(self.layers.sums())
            .enumerate()
            .with_min_len(4096)
            .for_each(|(i, sums)| {
                let (picture, layers) = sums.split_at_mut(PICTURE_SUMS);
                let (camera, light) = pass.pixel(i);
                for channel in 0..3 {
                    picture[CAMERA + channel] += camera[channel];
                    picture[LIGHT + channel] += light[channel];
                    let total = fixed::to_f64(camera[channel], VALUE_SCALE)
                        + fixed::to_f64(light[channel], VALUE_SCALE) * per_pixel;
                    let square = fixed::from_f64(total * total, MOMENT_SCALE);
                    let moment = &mut picture[MOMENT + channel];
                    *moment = moment.saturating_add(square);
                }
                pass.add_layers(i, layers);
            });
        self.passes.insert(index..index + 1);
    }
}

/// Compares passes, resolution, crop, layers and sums, bit for bit.
impl PartialEq for Film {
    fn eq(&self, other: &Self) -> bool {
        self.passes == other.passes
            && self.settings.resolution == other.settings.resolution
            && self.settings.crop == other.settings.crop
            && self.layers == other.layers
            && self.sums == other.sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::spectrum::Rgb;
    use std::iter;

    #[test]
    fn both_layers_add_up_with_their_own_counts() {
        let settings = FilmSettings::new([2, 2], Filter::default());
        let mut film = Film::new(settings, u64::MAX).unwrap();
        for pass in 0..2u8 {
            let buffer = PassBuffer::new(film.settings(), film.layers()).unwrap();
            buffer.set_camera_sample(3, [1.0, f32::from(pass), 0.0]);
            let place = SplatPlace {
                raster: Vec2::new(1.5, 1.5),
                u: Vec2::splat(0.5),
            };
            buffer.splat(film.settings(), place, [4.0, 0.0, 8.0], iter::empty());
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
}
