//! The settings of a film, fixed before rendering: pixels, crop, filter and exposure. Lengths are
//! in pixels, (0, 0) the top left one of the whole film, whatever the crop.

use super::{Filter, Sensor};
use crate::math::Vec2;
use thiserror::Error;

/// A rectangle of pixels: `min` inclusive, `max` exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// Left and top.
    pub min: [u32; 2],
    /// Right and bottom, exclusive.
    pub max: [u32; 2],
}

impl PixelRect {
    /// Pixels per row.
    pub fn width(&self) -> u32 {
        self.max[0].saturating_sub(self.min[0])
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.max[1].saturating_sub(self.min[1])
    }

    /// Returns the number of pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// Returns the position of a pixel in row order. None: it is outside.
    #[inline]
    pub fn index(&self, x: i64, y: i64) -> Option<usize> {
        let (dx, dy) = (x - i64::from(self.min[0]), y - i64::from(self.min[1]));
        let inside = (0..i64::from(self.width())).contains(&dx)
            && (0..i64::from(self.height())).contains(&dy);
        inside.then(|| dy as usize * self.width() as usize + dx as usize)
    }

    /// Returns the pixel at position `i` of row order.
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
    /// The factor on developed values.
    pub exposure: f32,
    /// The response to light before it is summed.
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

    /// Returns the pixel that a splat goes to, drawn by the filter: its position in row order of the crop, and
    /// what its value is multiplied by. None: it is outside.
    #[inline]
    pub fn pick_pixel(&self, place: SplatPlace) -> Option<(usize, f32)> {
        let (x, y, weight) = self.filter.pick_pixel(place.raster, place.u)?;
        Some((self.crop.index(x, y)?, weight))
    }

    /// Returns the number of light subpaths of a pass in which each sample has its own: one for each pixel that is
    /// rendered. If k samples share a subpath, weights and the light image count 1/k of this number.
    pub fn light_paths(&self) -> u64 {
        self.crop.area()
    }
}

/// The place of a contribution to the light image.
#[derive(Clone, Copy, Debug)]
pub struct SplatPlace {
    /// The point on the film. Unit: pixels.
    pub raster: Vec2,
    /// The numbers by which the filter draws a pixel.
    pub u: Vec2,
}

/// Why a film cannot be made.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum FilmError {
    /// It would need too much memory.
    #[error("the film needs {} GiB of memory, more than the limit of {} GiB", needed >> 30, limit >> 30)]
    TooLarge {
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The system refused the memory.
    #[error("the system does not have the {bytes} bytes of memory that it needs")]
    NoMemory {
        /// Bytes that were asked for.
        bytes: u64,
    },
}
