//! The settings of a film, fixed before rendering: pixels, crop, filter and exposure. Lengths are in pixels; (0, 0)
//! is the top left pixel of the whole film, not of the crop.

use super::{Filter, Sensor};
use crate::math::Vec2;
use thiserror::Error;

/// A rectangle of pixels: `min` inclusive, `max` exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// The left and top pixel.
    pub min: [u32; 2],
    /// The right and bottom pixel, exclusive.
    pub max: [u32; 2],
}

impl PixelRect {
    /// Returns the number of pixels in a row.
    pub fn width(&self) -> u32 {
        self.max[0].saturating_sub(self.min[0])
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u32 {
        self.max[1].saturating_sub(self.min[1])
    }

    /// Returns the number of pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// Returns the index of a pixel in row order. None: it is outside.
    #[inline]
    pub fn index(&self, x: i64, y: i64) -> Option<usize> {
        let (dx, dy) = (x - i64::from(self.min[0]), y - i64::from(self.min[1]));
        let inside = (0..i64::from(self.width())).contains(&dx)
            && (0..i64::from(self.height())).contains(&dy);
        inside.then(|| dy as usize * self.width() as usize + dx as usize)
    }

    /// Returns the pixel with index `i` in row order.
    #[inline]
    pub fn pixel(&self, i: usize) -> [u32; 2] {
        let width = self.width() as usize;
        [
            self.min[0] + (i % width) as u32,
            self.min[1] + (i / width) as u32,
        ]
    }
}

/// The film's geometry, filter and exposure.
#[derive(Clone, Debug)]
pub struct FilmSettings {
    /// Width and height of the whole film. Unit: pixels.
    pub resolution: [u32; 2],
    /// The part that is rendered.
    pub crop: PixelRect,
    /// The pixel filter.
    pub filter: Filter,
    /// The factor of developed values.
    pub exposure: f32,
    /// The response of the sensor to light before the film sums it.
    pub sensor: Sensor,
}

impl FilmSettings {
    /// Makes an uncropped film with exposure 1.
    pub fn new(resolution: [u32; 2], filter: Filter) -> Self {
        let crop = PixelRect {
            min: [0, 0],
            max: resolution,
        };
        Self {
            resolution,
            crop,
            filter,
            exposure: 1.0,
            sensor: Sensor::default(),
        }
    }

    /// Draws the pixel of a splat by the filter. Returns its index in row order of the crop, and the factor of the
    /// splat's value. None: the pixel is outside.
    #[inline]
    pub fn pick_pixel(&self, place: SplatPlace) -> Option<(usize, f32)> {
        let (x, y, weight) = self.filter.pick_pixel(place.raster, place.u)?;
        Some((self.crop.index(x, y)?, weight))
    }

    /// Returns the number of pixels of the crop, which is that of samples of a pass.
    pub fn pixel_count(&self) -> u64 {
        self.crop.area()
    }
}

/// The position of a splat on the film, and the numbers that draw its pixel.
#[derive(Clone, Copy, Debug)]
pub struct SplatPlace {
    /// The point on the film. Unit: pixels.
    pub raster: Vec2,
    /// The random numbers by which the filter draws a pixel.
    pub u: Vec2,
}

/// Why a film cannot be made.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum FilmError {
    /// The film needs more memory than the limit.
    #[error("the film needs {} GiB of memory, more than the limit of {} GiB", needed >> 30, limit >> 30)]
    TooLarge {
        /// The memory that the film needs. Unit: bytes.
        needed: u64,
        /// The limit. Unit: bytes.
        limit: u64,
    },
    /// The system refused the memory.
    #[error("the system does not have the {bytes} bytes of memory that it needs")]
    NoMemory {
        /// The memory that was asked for. Unit: bytes.
        bytes: u64,
    },
}
