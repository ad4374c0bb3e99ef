//! Textures: quantities that vary over a surface.
//!
//! A texture is a function of the point, its normal, its parameters, and the width of a pixel there for the camera
//! ([`TexturePoint`]). It never depends on the walk that reached the point, so that the integrand stays a function of
//! the path. Colours are linear Rec. 709; the material chooses the [`Lanes`](crate::spectrum::Lanes) conversion.
//!
//! Numbers and colours share one implementation over [`Value`]. Evaluation allocates nothing, and
//! takes time in proportion to [`Texture::size`].
//!
//! **Adding one**: a file, a variant in [`Texture`] with an arm in each match, and a mapping in the
//! scene reader.

mod image;
mod map;
mod mapping;
mod noise;
mod pattern;
mod point;
mod range;

/// Converts a texture's number to α: clamps it to 0 to 1, and NaN to 1.
#[inline]
pub(crate) fn clamped_alpha(alpha: f32) -> f32 {
    if alpha < 1.0 { alpha.max(0.0) } else { 1.0 }
}

#[cfg(test)]
mod tests;

pub use image::Image;
pub use map::{Beyond, Change, ImageFilter, ImageMap, Wrap};
pub use mapping::{Mapping, TextureSpace};
pub use noise::{Marble, Noise, NoiseKind, fractal_noise};
pub use pattern::{Bilerp, Cells, Checkerboard, Dots};
pub use point::{Footprint, Handedness, TexturePoint};
pub use range::Range;

use crate::math::Vec3;
use crate::spectrum::Rgb;
use std::fmt::Debug;
use std::sync::Arc;

/// A value of a texture: a number or a colour.
pub trait Value: Copy + Debug {
    /// An image of such values.
    type Map: Clone + Debug;

    /// Returns (1 - `t`)·self + `t`·`other`.
    #[must_use]
    fn lerp(self, other: Self, t: f32) -> Self;

    /// Returns the product of the value and `factor`.
    #[must_use]
    fn scaled(self, factor: f32) -> Self;

    /// Returns the value of an image.
    fn look_up(map: &Self::Map, at: &TexturePoint) -> Self;

    /// Returns the inputs that a look-up needs besides the parameters.
    fn needs(map: &Self::Map) -> RequiredInputs;

    /// Converts a colour to this type; to a number by the mean of its channels.
    fn of_color(color: Rgb) -> Self;
}

impl Value for f32 {
    type Map = ImageMap<1>;

    #[inline]
    fn lerp(self, other: Self, t: f32) -> Self {
        self * (1.0 - t) + other * t
    }

    #[inline]
    fn scaled(self, factor: f32) -> Self {
        self * factor
    }

    #[inline]
    fn look_up(map: &ImageMap<1>, at: &TexturePoint) -> Self {
        map.eval(at)[0]
    }

    fn needs(map: &ImageMap<1>) -> RequiredInputs {
        map.needs()
    }

    #[inline]
    fn of_color([r, g, b]: Rgb) -> Self {
        (r + g + b) / 3.0
    }
}

impl Value for Rgb {
    type Map = ImageMap<3>;

    #[inline]
    fn lerp(self, other: Self, t: f32) -> Self {
        std::array::from_fn(|channel| self[channel].lerp(other[channel], t))
    }

    #[inline]
    fn scaled(self, factor: f32) -> Self {
        self.map(|channel| channel * factor)
    }

    #[inline]
    fn look_up(map: &ImageMap<3>, at: &TexturePoint) -> Self {
        map.eval(at)
    }

    fn needs(map: &ImageMap<3>) -> RequiredInputs {
        map.needs()
    }

    #[inline]
    fn of_color(color: Rgb) -> Self {
        color
    }
}

/// A colour over a surface.
pub type ColorTexture = Texture<Rgb>;
/// A number over a surface.
pub type FloatTexture = Texture<f32>;

/// A value over a surface.
#[derive(Clone, Debug)]
pub enum Texture<T: Value> {
    /// The same everywhere.
    Constant(T),
    /// The values of an image.
    Image(Arc<T::Map>),
    /// A texture times a number.
    Scale(Arc<Scale<T>>),
    /// A mixture of two textures.
    Mix(Arc<Mix<T>>),
    /// A mixture that depends on the direction of the normal.
    DirectionMix(Arc<DirectionMix<T>>),
    /// Interpolation between four corners.
    Bilerp(Arc<Bilerp<T>>),
    /// Two textures in alternating cells.
    Checkerboard(Arc<Checkerboard<T>>),
    /// Dots in some cells of a grid.
    Dots(Arc<Dots<T>>),
    /// Noise, the same in every channel.
    Noise(Arc<Noise>),
    /// Veins.
    Marble(Arc<Marble>),
}

/// `texture` times `factor`.
#[derive(Clone, Debug)]
pub struct Scale<T: Value> {
    /// The texture to be scaled.
    pub texture: Texture<T>,
    /// Its factor.
    pub factor: FloatTexture,
}

/// (1 - `amount`) of the first and `amount` of the second.
#[derive(Clone, Debug)]
pub struct Mix<T: Value> {
    /// The textures to be mixed.
    pub textures: [Texture<T>; 2],
    /// The weight of the second.
    pub amount: FloatTexture,
}

/// |n·d| of the first and 1 - |n·d| of the second, with n the shading normal before any relief.
#[derive(Clone, Debug)]
pub struct DirectionMix<T: Value> {
    /// The textures to be mixed.
    pub textures: [Texture<T>; 2],
    /// The unit direction d. Space: world.
    pub direction: Vec3,
}

impl<T: Value> Texture<T> {
    /// Returns the value at a point.
    #[inline]
    pub fn eval(&self, at: &TexturePoint) -> T {
        match self {
            Self::Constant(value) => *value,
            _ => self.eval_varying(at),
        }
    }

    /// Evaluates a texture that varies. Outlined: most textures are constant.
    #[inline(never)]
    fn eval_varying(&self, at: &TexturePoint) -> T {
        match self {
            Self::Constant(value) => *value,
            Self::Image(map) => T::look_up(map, at),
            Self::Scale(scale) => scale.texture.eval(at).scaled(scale.factor.eval(at)),
            Self::Mix(mix) => mix.eval(at),
            Self::DirectionMix(mix) => mix.eval(at),
            Self::Bilerp(bilerp) => bilerp.eval(at),
            Self::Checkerboard(board) => board.cell(at).eval(at),
            Self::Dots(dots) => dots.cell(at).eval(at),
            Self::Noise(noise) => T::of_color([noise.eval(at); 3]),
            Self::Marble(marble) => T::of_color(marble.eval(at)),
        }
    }

    /// Returns the inputs that its values need besides the parameters (u, v).
    pub fn needs(&self) -> RequiredInputs {
        let own = match self {
            Self::Image(map) => T::needs(map),
            Self::Bilerp(bilerp) => bilerp.mapping.needs(),
            Self::Checkerboard(board) => board.cells.needs(),
            Self::Dots(dots) => dots.mapping.needs(),
            Self::DirectionMix(_) => RequiredInputs::SURFACE,
            Self::Noise(_) | Self::Marble(_) => RequiredInputs::ALL,
            Self::Constant(_) | Self::Scale(_) | Self::Mix(_) => RequiredInputs::NOTHING,
        };
        let parts = self.parts().iter().map(Self::needs);
        let all = parts.fold(own, RequiredInputs::and);
        self.number().map_or(all, |number| all.and(number.needs()))
    }

    /// Returns the number of textures that it is made of, including itself; one that is used twice counts twice.
    pub fn size(&self) -> usize {
        let parts: usize = self.parts().iter().map(Self::size).sum();
        1 + parts + self.number().map_or(0, Texture::size)
    }

    /// Returns the textures that it chooses or mixes its values from.
    fn parts(&self) -> &[Self] {
        match self {
            Self::Scale(scale) => std::slice::from_ref(&scale.texture),
            Self::Mix(mix) => &mix.textures,
            Self::DirectionMix(mix) => &mix.textures,
            Self::Checkerboard(board) => &board.textures,
            Self::Dots(dots) => &dots.textures,
            Self::Constant(_)
            | Self::Image(_)
            | Self::Bilerp(_)
            | Self::Noise(_)
            | Self::Marble(_) => &[],
        }
    }

    /// Returns the number that it multiplies or mixes by.
    fn number(&self) -> Option<&FloatTexture> {
        match self {
            Self::Scale(scale) => Some(&scale.factor),
            Self::Mix(mix) => Some(&mix.amount),
            _ => None,
        }
    }
}

impl<T: Value> Mix<T> {
    fn eval(&self, at: &TexturePoint) -> T {
        let amount = self.amount.eval(at);
        let [first, second] = &self.textures;
        // Textures of weight 0 are not looked up: this saves time, and excludes values that are not finite.
        if amount == 0.0 {
            first.eval(at)
        } else if 1.0 - amount == 0.0 {
            second.eval(at)
        } else {
            first.eval(at).lerp(second.eval(at), amount)
        }
    }
}

impl<T: Value> DirectionMix<T> {
    fn eval(&self, at: &TexturePoint) -> T {
        let along = at.normal.dot(self.direction).abs();
        let [first, second] = &self.textures;
        second.eval(at).lerp(first.eval(at), along)
    }
}

/// The inputs that a texture needs besides the parameters (u, v).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RequiredInputs {
    /// True if it needs the point or the normal.
    pub surface: bool,
    /// True if it needs the width of a pixel, or the directions of the parameters.
    pub footprint: bool,
}

impl RequiredInputs {
    /// Only the parameters.
    pub const NOTHING: Self = Self {
        surface: false,
        footprint: false,
    };
    /// The point or the normal.
    pub const SURFACE: Self = Self {
        surface: true,
        footprint: false,
    };
    /// Everything.
    pub const ALL: Self = Self {
        surface: true,
        footprint: true,
    };

    /// Returns the inputs that either needs.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            surface: self.surface || other.surface,
            footprint: self.footprint || other.footprint,
        }
    }
}
