//! Four lanes of `f32`: the one abstraction over instruction sets.
//!
//! Kernels are written once, generic over [`F32x4`].
//! All implementations round alike and treat NaN alike, but kernels do not rely on the first:
//! what they compute only ever discards work conservatively.

use std::ops::{Add, Mul, Sub};

mod scalar;
#[cfg(target_arch = "x86_64")]
mod sse2;

pub(crate) use scalar::Scalar4;
#[cfg(target_arch = "x86_64")]
pub(crate) use sse2::Sse4;

/// Four `f32` with lane-wise arithmetic.
pub(crate) trait F32x4:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// All lanes equal to `value`.
    fn splat(value: f32) -> Self;
    /// Lanes from memory.
    fn load(values: &[f32; 4]) -> Self;
    /// Lanes to memory.
    fn to_array(self) -> [f32; 4];
    /// `self < other ? self : other`: a NaN in either operand selects `other`.
    fn min(self, other: Self) -> Self;
    /// `self > other ? self : other`: a NaN in either operand selects `other`.
    fn max(self, other: Self) -> Self;
    /// Magnitudes.
    fn abs(self) -> Self;
    /// Bit `k` is set where lane `k` has `self < other`; clear at NaN.
    fn lt(self, other: Self) -> u32;
    /// Bit `k` is set where lane `k` has `self <= other`; clear at NaN.
    fn le(self, other: Self) -> u32;
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    const SAMPLES: [f32; 9] = [
        0.0,
        -0.0,
        1.0,
        -2.5,
        1e-45,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];

    #[track_caller]
    fn check_same(scalar: Scalar4, sse: Sse4) {
        for (a, b) in scalar.to_array().into_iter().zip(sse.to_array()) {
            assert!(
                a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()),
                "{a} and {b}"
            );
        }
    }

    #[test]
    fn implementations_agree_on_special_values() {
        for a in SAMPLES {
            for b in SAMPLES {
                let lanes = [a, b, 1.0, a];
                let (p, q) = (Scalar4::load(&lanes), Scalar4::splat(b));
                let (r, s) = (Sse4::load(&lanes), Sse4::splat(b));
                check_same(p + q, r + s);
                check_same(p - q, r - s);
                check_same(p * q, r * s);
                check_same(p.min(q), r.min(s));
                check_same(p.max(q), r.max(s));
                check_same(p.abs(), r.abs());
                assert_eq!((p.lt(q), p.le(q)), (r.lt(s), r.le(s)));
            }
        }
    }

    #[test]
    fn nan_selects_the_second_operand() {
        let (nan, one) = (Sse4::splat(f32::NAN), Sse4::splat(1.0));
        assert_eq!((nan.min(one).lt(one), nan.min(one).le(one)), (0, 0b1111));
        assert_eq!((nan.max(one).lt(one), nan.max(one).le(one)), (0, 0b1111));
        assert!(one.max(nan).to_array()[0].is_nan());
    }
}
