//! Four lanes of light.
//!
//! All light along a path is a [`Spectrum`]: four `f32` lanes, multiplied and added lane by lane. [`Lanes`] gives
//! their meaning, which all samples of a group share. Only emission, texture look-up and film development convert.
//! Other code asks only which lanes carry light: for means, and for the lane by which a walk draws its distance.
//!
//! A scene has colours in linear Rec. 709, and quantities that keep their [`Curve`]: [`Illuminant`], [`Metal`] and
//! [`RefractiveIndex`].

mod colorimetry;
mod curve;
mod four;
mod named;
mod quantity;
mod table;
#[cfg(test)]
mod tests;

#[cfg(test)]
pub(crate) mod permuted;

pub use colorimetry::{
    LUMINANCE_OF_ONE, Primaries, adapted, black_body, daylight_white, planckian_white, reflectance,
    rgb_from_rgb,
};
pub use curve::{Beyond, Curve, CurveError};
pub(crate) use four::FourSpectra;
pub use named::{named, names};
pub use quantity::{Illuminant, Metal, RefractiveIndex};

use glam::Vec4;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Sub};

/// Four lanes of radiance, importance, reflectance or throughput.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct Spectrum(pub [f32; 4]);

impl Spectrum {
    /// No light.
    pub const ZERO: Self = Self([0.0; 4]);
    /// One in every lane.
    pub const ONE: Self = Self([1.0; 4]);

    /// Returns a spectrum with `value` in every lane.
    #[inline]
    pub const fn splat(value: f32) -> Self {
        Self([value; 4])
    }

    /// Returns the lanes in one register.
    #[inline]
    fn lanes(self) -> Vec4 {
        Vec4::from_array(self.0)
    }

    /// Applies `f` lane by lane.
    #[inline]
    #[must_use]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    /// Combines two spectra lane by lane.
    #[inline]
    #[must_use]
    pub fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    /// Returns the largest lane.
    #[inline]
    pub fn max_lane(self) -> f32 {
        self.0[0].max(self.0[1]).max(self.0[2].max(self.0[3]))
    }

    /// Returns the smallest lane.
    #[inline]
    pub fn min_lane(self) -> f32 {
        self.lanes().min_element()
    }

    /// Returns true where every lane is exactly zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.lanes().cmpeq(Vec4::ZERO).all()
    }

    /// Returns true if no lane is NaN, or larger than `limit` in absolute value.
    #[inline]
    pub fn is_within(self, limit: f32) -> bool {
        self.lanes().abs().cmple(Vec4::splat(limit)).all()
    }

    /// Returns true where no lane is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.iter().all(|lane| lane.is_finite())
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    #[inline]
    fn index(&self, lane: usize) -> &f32 {
        &self.0[lane]
    }
}

impl Add for Spectrum {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self((self.lanes() + other.lanes()).to_array())
    }
}

impl AddAssign for Spectrum {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Spectrum {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self((self.lanes() - other.lanes()).to_array())
    }
}

impl Mul for Spectrum {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self((self.lanes() * other.lanes()).to_array())
    }
}

impl MulAssign for Spectrum {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Mul<f32> for Spectrum {
    type Output = Self;
    #[inline]
    fn mul(self, scale: f32) -> Self {
        Self((self.lanes() * scale).to_array())
    }
}

impl MulAssign<f32> for Spectrum {
    #[inline]
    fn mul_assign(&mut self, scale: f32) {
        *self = *self * scale;
    }
}

impl Div<f32> for Spectrum {
    type Output = Self;
    #[inline]
    fn div(self, divisor: f32) -> Self {
        self * (1.0 / divisor)
    }
}

/// A colour in linear Rec. 709 primaries: the colours of scene descriptions and of developed films.
pub type Rgb = [f32; 3];

/// Returns the luminance Y of a linear Rec. 709 colour, or of several at once.
#[inline]
pub fn luminance<T: Add<Output = T>>([r, g, b]: [T; 3]) -> T
where
    f32: Mul<T, Output = T>,
{
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// The meaning of the four lanes of a [`Spectrum`]. All samples of a group share it, so that their walks can be joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lanes {
    /// Linear Rec. 709 red, green and blue; the fourth lane is zero in all light.
    Rgb,
    /// The same lanes in another order; the empty one repeats red, but in light.
    #[cfg(test)]
    Permuted(permuted::Order),
}

impl Lanes {
    /// Returns the lanes of a reflectance or transmittance.
    #[inline]
    pub fn albedo(self, [r, g, b]: Rgb) -> Spectrum {
        match self {
            Self::Rgb => Spectrum([r, g, b, 0.0]),
            #[cfg(test)]
            Self::Permuted(order) => order.of_rgb(Spectrum([r, g, b, r])),
        }
    }

    /// Returns the lanes of a quantity without an upper bound, such as an index of refraction.
    #[inline]
    pub fn unbounded(self, [r, g, b]: Rgb) -> Spectrum {
        match self {
            // The unused lane must stay harmless under division: it repeats blue.
            Self::Rgb => Spectrum([r, g, b, b]),
            #[cfg(test)]
            Self::Permuted(order) => order.of_rgb(Spectrum([r, g, b, r])),
        }
    }

    /// Returns the lanes of an emitted radiance or intensity.
    #[inline]
    pub fn illuminant(self, [r, g, b]: Rgb) -> Spectrum {
        match self {
            Self::Rgb => Spectrum([r, g, b, 0.0]),
            #[cfg(test)]
            Self::Permuted(order) => order.of_rgb(Self::Rgb.illuminant([r, g, b])),
        }
    }

    /// Returns the lanes of emitted light.
    #[inline]
    pub fn light(self, light: &Illuminant) -> Spectrum {
        match self {
            Self::Rgb => self.illuminant(light.color()),
            #[cfg(test)]
            Self::Permuted(order) => order.light(light),
        }
    }

    /// Returns the lanes of η and k of a metal.
    #[inline]
    pub fn metal(self, metal: &Metal) -> [Spectrum; 2] {
        match self {
            Self::Rgb => metal.channels().map(|rgb| self.unbounded(rgb)),
            #[cfg(test)]
            Self::Permuted(order) => metal.curves().each_ref().map(|curve| order.curve(curve)),
        }
    }

    /// Returns the index by which a dielectric refracts all lanes.
    #[inline]
    pub fn index(self, index: &RefractiveIndex) -> f32 {
        match self {
            Self::Rgb => index.at_d_line(),
            #[cfg(test)]
            Self::Permuted(order) => order.index(index),
        }
    }

    /// Returns the mean over the lanes that carry light. For contributions it is the score of candidates.
    #[inline]
    pub fn mean(self, spectrum: Spectrum) -> f32 {
        match self {
            Self::Rgb => (spectrum[0] + spectrum[1] + spectrum[2]) * (1.0 / 3.0),
            #[cfg(test)]
            Self::Permuted(order) => Self::Rgb.mean(order.to_rgb(spectrum)),
        }
    }

    /// Lists the lanes that carry light.
    #[inline]
    pub fn carrying(self) -> impl ExactSizeIterator<Item = usize> + Clone {
        let rgb = [0, 1, 2];
        let lanes = match self {
            Self::Rgb => rgb,
            #[cfg(test)]
            Self::Permuted(order) => rgb.map(|lane| order.lane(lane)),
        };
        lanes.into_iter()
    }

    /// Chooses a lane that carries light, all equally likely, by `u` in `[0, 1)`.
    #[inline]
    pub fn pick_lane(self, u: f32) -> usize {
        match self {
            Self::Rgb => (u * 3.0) as usize,
            #[cfg(test)]
            Self::Permuted(order) => order.lane(Self::Rgb.pick_lane(u)),
        }
    }

    /// Returns the colour that light adds to the film.
    #[inline]
    pub fn to_rgb(self, light: Spectrum) -> Rgb {
        match self {
            Self::Rgb => [light[0], light[1], light[2]],
            #[cfg(test)]
            Self::Permuted(order) => Self::Rgb.to_rgb(order.to_rgb(light)),
        }
    }

    /// Returns the luminance of light.
    #[inline]
    pub fn luminance(self, light: Spectrum) -> f32 {
        luminance(self.to_rgb(light))
    }
}
