//! Vectors, frames, warps and distributions.
//!
//! Vectors are [`glam`]'s. Transcendental functions come from the `libm` crate, so that the same
//! scene gives the same bits on every machine; the standard library's are forbidden by lint.

mod distribution;
pub mod fixed;
mod frame;
pub(crate) mod lanes;
mod octahedral;
pub mod warp;

pub use distribution::{Distribution1d, Distribution2d, Distribution3d};
pub use frame::Frame;
pub use glam::{Affine2, Affine3A, DAffine3, DVec3, Mat3, Vec2, Vec3, Vec3A};
pub use octahedral::{direction_to_square, square_to_direction};

/// π.
pub const PI: f32 = std::f32::consts::PI;
/// 1/π.
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
/// The largest `f32` below 1: the upper bound of every random number.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// Returns the sine and cosine of `x` in radians.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    (libm::sinf(x), libm::cosf(x))
}

/// Returns the square.
#[inline]
pub fn sqr(x: f32) -> f32 {
    x * x
}

/// Returns the square root, or zero for negative arguments, which come from rounding.
#[inline]
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}
