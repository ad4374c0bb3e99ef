//! The running pass. All threads write to it at once, without locks; the film adds it when it is complete.
//!
//! The one thread that renders a pixel stores its camera sample, features and parts. All threads add splats, in fixed
//! point, so that their order does not matter. Nothing is normalised here.

use super::layers::PART_SUMS;
use super::memory::filled;
use super::{FilmError, FilmSettings, Layers, SplatPlace};
use crate::math::fixed::{self, FixedSum, LARGEST_CONTRIBUTION, VALUE_SCALE};
use crate::spectrum::Rgb;
use rayon::prelude::{ParallelIterator, ParallelSliceMut};
use std::sync::atomic::{AtomicU32, Ordering};

/// A pass while it is rendered: one camera sample per pixel, and splats anywhere.
#[derive(Debug)]
pub struct PassBuffer {
    /// The camera sample of each pixel: the bits of three `f32`.
    camera: Vec<[AtomicU32; 3]>,
    /// The sum of splats in each pixel.
    light: Vec<[FixedSum; 3]>,
    /// The features of camera samples: for each pixel, the bits of one `f32` for each feature.
    features: Vec<AtomicU32>,
    /// The camera sample of each part: the bits of three `f32` for each part of each pixel.
    part_camera: Vec<[AtomicU32; 3]>,
    /// The sum of splats of each part of each pixel.
    part_light: Vec<[FixedSum; 3]>,
    /// The numbers of features and parts of a pixel.
    layers: [usize; 2],
}

/// Clamps a value to the range that a sum has room for; NaN becomes 0.
fn bounded(value: f32) -> f32 {
    if value.is_nan() {
        0.0
    } else {
        value.clamp(-LARGEST_CONTRIBUTION, LARGEST_CONTRIBUTION)
    }
}

fn store(cells: &[AtomicU32; 3], value: Rgb) {
    for (cell, channel) in cells.iter().zip(value) {
        cell.store(channel.to_bits(), Ordering::Relaxed);
    }
}

fn load(cell: &AtomicU32) -> f32 {
    f32::from_bits(cell.load(Ordering::Relaxed))
}

/// Adds a splat of `value` times the filter's `weight` to each of `sums`.
#[inline]
fn add<'a>(sums: impl Iterator<Item = &'a [FixedSum; 3]>, value: Rgb, weight: f32) {
    let value = value.map(|channel| {
        let weighted = f64::from(channel) * f64::from(weight);
        fixed::from_f64(weighted, VALUE_SCALE)
    });
    for cells in sums {
        for (cell, channel) in cells.iter().zip(value) {
            cell.add(channel);
        }
    }
}

/// Calls `change` for each of `cells`, in parallel runs of many cells.
fn each<T: Send>(cells: &mut [T], change: impl Fn(&mut T) + Sync) {
    let runs = cells.par_chunks_mut(1 << 16);
    runs.for_each(|run| run.iter_mut().for_each(&change));
}

fn to_fixed(value: f32) -> i128 {
    fixed::from_f64(f64::from(value), VALUE_SCALE)
}

impl PassBuffer {
    pub(super) fn bytes_per_pixel(layers: &Layers) -> usize {
        let of_picture = size_of::<[AtomicU32; 3]>() + size_of::<[FixedSum; 3]>();
        of_picture * (1 + layers.parts()) + size_of::<AtomicU32>() * layers.features()
    }

    /// Makes an empty pass of a film.
    ///
    /// Errors: the system does not have the memory.
    pub fn new(settings: &FilmSettings, layers: &Layers) -> Result<Self, FilmError> {
        let pixels = settings.crop.area() as usize;
        let [features, parts] = [layers.features(), layers.parts()];
        Ok(Self {
            camera: filled(pixels, Default::default)?,
            light: filled(pixels, Default::default)?,
            features: filled(pixels * features, Default::default)?,
            part_camera: filled(pixels * parts, Default::default)?,
            part_light: filled(pixels * parts, Default::default)?,
            layers: [features, parts],
        })
    }

    /// Clears the buffer for the next pass, on the threads of the current pool.
    pub fn clear(&mut self) {
        let clear_bits = |bits: &mut AtomicU32| *bits.get_mut() = 0;
        for cells in [&mut self.camera, &mut self.part_camera] {
            each(cells, |cell| cell.iter_mut().for_each(clear_bits));
        }
        each(&mut self.features, clear_bits);
        for sums in [&mut self.light, &mut self.part_light] {
            each(sums, |cell| cell.iter_mut().for_each(FixedSum::clear));
        }
    }

    /// Stores the camera sample of pixel `i`, in row order of the crop. `value` is finite, and at most
    /// [`fixed::LARGEST_CONTRIBUTION`] times the number of strategies.
    #[inline]
    pub fn set_camera_sample(&self, i: usize, value: Rgb) {
        store(&self.camera[i], value);
    }

    /// Stores the features of the camera sample of pixel `i`, in the order of [`Layers::aovs`]. Values are clamped to
    /// [`fixed::LARGEST_CONTRIBUTION`]; NaN becomes 0.
    pub fn set_features(&self, i: usize, values: impl Iterator<Item = f32>) {
        let features = self.layers[0];
        let cells = &self.features[i * features..(i + 1) * features];
        for (cell, value) in cells.iter().zip(values) {
            cell.store(bounded(value).to_bits(), Ordering::Relaxed);
        }
    }

    /// Adds `value` to the camera sample of a part of pixel `i`.
    pub fn add_to_part(&self, i: usize, part: usize, value: Rgb) {
        let cells = &self.part_camera[i * self.layers[1] + part];
        // One thread renders a pixel: no other thread writes between load and store.
        let sum = std::array::from_fn(|channel| load(&cells[channel]) + value[channel]);
        store(cells, sum);
    }

    /// Adds a splat to one pixel, drawn at `place`, and to `parts` of this pixel. Outside the crop it adds nothing.
    #[inline]
    pub fn splat(
        &self,
        settings: &FilmSettings,
        place: SplatPlace,
        value: Rgb,
        parts: impl Iterator<Item = usize>,
    ) {
        let Some((i, weight)) = settings.pick_pixel(place) else {
            return;
        };
        let parts = parts.map(|part| &self.part_light[i * self.layers[1] + part]);
        add(std::iter::once(&self.light[i]).chain(parts), value, weight);
    }

    /// Adds a splat of `value` times the filter's `weight` only to one part of pixel `i`.
    pub fn splat_to_part(&self, i: usize, part: usize, value: Rgb, weight: f32) {
        let cells = &self.part_light[i * self.layers[1] + part];
        add(std::iter::once(cells), value, weight);
    }

    /// Returns the camera sample and the sum of splats of pixel `i`. Unit: [`fixed::VALUE_SCALE`].
    #[inline]
    pub(super) fn pixel(&self, i: usize) -> ([i128; 3], [i128; 3]) {
        (
            std::array::from_fn(|channel| to_fixed(load(&self.camera[i][channel]))),
            std::array::from_fn(|channel| self.light[i][channel].get()),
        )
    }

    /// Adds the features and parts of pixel `i` to `sums`, the film's sums of that pixel.
    #[inline]
    pub(super) fn add_layers(&self, i: usize, sums: &mut [i128]) {
        let [features, parts] = self.layers;
        let (feature_sums, part_sums) = sums.split_at_mut(features);
        let values = self.features.iter().skip(i * features);
        for (sum, value) in feature_sums.iter_mut().zip(values) {
            *sum += to_fixed(load(value));
        }
        for (part, sums) in part_sums.chunks_exact_mut(PART_SUMS).enumerate() {
            let at = i * parts + part;
            for channel in 0..3 {
                sums[channel] += to_fixed(load(&self.part_camera[at][channel]));
                sums[3 + channel] += self.part_light[at][channel].get();
            }
        }
    }
}
