//! The running pass: written by all threads at once, without locks, and added to the film when it
//! is whole.
//!
//! Each pixel's camera sample is stored by the one thread that renders it; splats are summed in
//! fixed point, whose order cannot matter. Nothing is normalised here.

use super::FilmSettings;
use super::fixed::{self, FixedSum, VALUE_SCALE};
use crate::math::Vec2;
use crate::spectrum::Rgb;
use std::sync::atomic::{AtomicU32, Ordering};

/// One pass while it is rendered: one camera sample per pixel, and splats anywhere. All threads
/// write to it at once.
#[derive(Debug)]
pub struct PassBuffer {
    /// The camera sample of each pixel: the bits of three `f32`.
    camera: Vec<[AtomicU32; 3]>,
    /// The sum of splats in each pixel.
    light: Vec<[FixedSum; 3]>,
}

impl PassBuffer {
    pub(super) const BYTES_PER_PIXEL: usize =
        size_of::<[AtomicU32; 3]>() + size_of::<[FixedSum; 3]>();

    /// An empty pass of a film.
    pub fn new(settings: &FilmSettings) -> Self {
        let pixels = settings.crop.area() as usize;
        Self {
            camera: std::iter::repeat_with(Default::default)
                .take(pixels)
                .collect(),
            light: std::iter::repeat_with(Default::default)
                .take(pixels)
                .collect(),
        }
    }

    /// Empties the buffer for the next pass.
    pub fn clear(&self) {
        for (camera, light) in self.camera.iter().zip(&self.light) {
            for bits in camera {
                bits.store(0, Ordering::Relaxed);
            }
            for sum in light {
                sum.clear();
            }
        }
    }

    /// Stores the camera sample of pixel `i` (row order of the crop). Finite, at most
    /// [`fixed::LARGEST_CONTRIBUTION`] times the number of strategies.
    #[inline]
    pub fn set_camera_sample(&self, i: usize, value: Rgb) {
        for (cell, channel) in self.camera[i].iter().zip(value) {
            cell.store(channel.to_bits(), Ordering::Relaxed);
        }
    }

    /// Adds a light-image contribution at `raster`, to one pixel drawn by the filter with `u`.
    /// Nothing happens where that pixel is outside the crop.
    #[inline]
    pub fn splat(&self, settings: &FilmSettings, raster: Vec2, value: Rgb, u: Vec2) {
        let Some((i, weight)) = settings.pick_pixel(raster, u) else {
            return;
        };
        for (cell, channel) in self.light[i].iter().zip(value) {
            cell.add(fixed::from_f64(
                f64::from(channel) * f64::from(weight),
                VALUE_SCALE,
            ));
        }
    }

    /// The camera sample and the sum of splats of pixel `i`, in [`fixed::VALUE_SCALE`].
    #[inline]
    pub(super) fn pixel(&self, i: usize) -> ([i128; 3], [i128; 3]) {
        let camera = std::array::from_fn(|channel| {
            let bits = self.camera[i][channel].load(Ordering::Relaxed);
            fixed::from_f64(f64::from(f32::from_bits(bits)), VALUE_SCALE)
        });
        (
            camera,
            std::array::from_fn(|channel| self.light[i][channel].get()),
        )
    }
}
