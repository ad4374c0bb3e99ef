//! Quantities that vary over a surface.
//!
//! A texture is a function of the surface's (u, v); it never depends on how a walk arrived, so the
//! integrand stays one function of the path. Colours are linear Rec. 709; the material that asks
//! says which [`ColorModel`](crate::spectrum::ColorModel) conversion they go through.
//!
//! **Adding one**: a file, a variant in the enums here with an arm in each match, and a mapping in
//! the scene reader.

mod image;

pub use image::{Image, ImageFilter, ImageMap, Wrap};

use crate::math::Vec2;
use crate::spectrum::Rgb;

/// A colour over a surface.
#[derive(Clone, Debug)]
pub enum ColorTexture {
    /// The same everywhere.
    Constant(Rgb),
    /// Looked up in an image of three channels.
    Image(ImageMap<3>),
}

impl ColorTexture {
    /// The colour at `uv`.
    #[inline]
    pub fn eval(&self, uv: Vec2) -> Rgb {
        match self {
            Self::Constant(color) => *color,
            Self::Image(map) => map.eval(uv),
        }
    }
}

/// A number over a surface.
#[derive(Clone, Debug)]
pub enum FloatTexture {
    /// The same everywhere.
    Constant(f32),
    /// Looked up in an image of one channel.
    Image(ImageMap<1>),
}

impl FloatTexture {
    /// The number at `uv`.
    #[inline]
    pub fn eval(&self, uv: Vec2) -> f32 {
        match self {
            Self::Constant(value) => *value,
            Self::Image(map) => map.eval(uv)[0],
        }
    }
}
