//! Lanes of `f32`: the one abstraction over instruction sets.
//!
//! Kernels are written once, generic over [`Simd`]: triangles come four at a time ([`F32x4`]), boxes
//! eight ([`F32x8`]). Implementations may round differently (some fuse a product and a sum), so
//! kernels do not rely on it: they only ever discard work conservatively, or accept hits that are
//! certain with the same error bound.

use std::mem::MaybeUninit;
use std::ops::{Add, Mul, Sub};

#[cfg(target_arch = "x86_64")]
mod avx;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod sse;

pub(crate) use scalar::{Pair, Scalar4};

use crate::node::WIDTH;

/// Four `f32` with lane-wise arithmetic.
pub(crate) trait F32x4:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// Returns all lanes equal to `value`.
    fn splat(value: f32) -> Self;
    /// Reads the lanes from memory.
    fn load(values: &[f32; 4]) -> Self;
    /// Writes the lanes to memory.
    fn to_array(self) -> [f32; 4];
    /// Returns `self < other ? self : other`: a NaN in either operand selects `other`.
    fn min(self, other: Self) -> Self;
    /// Returns `self > other ? self : other`: a NaN in either operand selects `other`.
    fn max(self, other: Self) -> Self;
    /// Returns the absolute values.
    fn abs(self) -> Self;
    /// Returns `self·factor + term`, the product rounded or not.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// Returns `self·factor - term`, the product rounded or not.
    fn mul_sub(self, factor: Self, term: Self) -> Self;
    /// Returns `term - self·factor`, the product rounded or not.
    fn sub_from(self, factor: Self, term: Self) -> Self;
    /// Bit `k` is set where lane `k` has `self < other`; clear at NaN.
    fn lt(self, other: Self) -> u32;
    /// Bit `k` is set where lane `k` has `self <= other`; clear at NaN.
    fn le(self, other: Self) -> u32;
}

/// Eight `f32` with lane-wise arithmetic. Implementations may compare the bits as integers, which takes a quarter of
/// the time, and is right except for negative numbers.
pub(crate) trait F32x8: Copy {
    /// True if [`pack`](Self::pack) takes only a few instructions.
    const PACKS_FAST: bool = false;

    /// Returns all lanes equal to `value`.
    fn splat(value: f32) -> Self;
    /// Reads the lanes from memory.
    fn load(values: &[f32; WIDTH]) -> Self;
    /// Returns the smaller number; if both are negative, either. Not for NaN.
    fn min(self, other: Self) -> Self;
    /// Returns the larger number; if both are negative, either. Not for NaN.
    fn max(self, other: Self) -> Self;
    /// Returns `self·factor - term`, like [`F32x4::mul_sub`].
    fn mul_sub(self, factor: Self, term: Self) -> Self;
    /// Bit `k` is set where lane `k` has `self <= other`; if both are negative it may be set or clear. A zero in
    /// `other` must be positive. Not for NaN.
    fn le(self, other: Self) -> u32;
    /// Returns words with lane `k` in the upper half and `low[k]` in the lower.
    fn over(self, low: &[u32; WIDTH]) -> [u64; WIDTH];

    /// Bit `k` is set where either of the upper two bits of `words[k]` is set.
    #[inline(always)]
    fn upper_two(words: &[u32; WIDTH]) -> u32 {
        let mut mask = 0;
        for (k, word) in words.iter().enumerate() {
            mask |= u32::from(word >> 30 != 0) << k;
        }
        mask
    }

    /// Writes the words whose bit in `mask` is set to the front of `to`, in their order, and arbitrary words behind
    /// them. Only the lowest eight bits of `mask` may be set.
    #[inline(always)]
    fn pack(mask: u32, words: &[u32; WIDTH], to: &mut [MaybeUninit<u32>; WIDTH]) {
        let mut len = 0;
        for (k, word) in words.iter().enumerate() {
            to[len % WIDTH].write(*word);
            len += (mask >> k & 1) as usize;
        }
    }
}

/// A set of vector instructions.
pub(crate) trait Simd: Sized {
    type Four: F32x4;
    type Eight: F32x8;

    /// Runs a kernel compiled for the set, out of line.
    ///
    /// # Safety
    ///
    /// The machine must have the instructions.
    unsafe fn call<K: Kernel>(kernel: K) -> K::Output;
}

/// Code that is compiled for each set. Everything that it calls must be inlined, so that it is compiled for the set,
/// too.
pub(crate) trait Kernel {
    type Output;

    fn run<S: Simd>(self) -> Self::Output;
}

/// The set of portable code, without intrinsics.
pub(crate) struct Portable;

impl Simd for Portable {
    type Four = Scalar4;
    type Eight = Pair<Scalar4>;

    #[inline(never)]
    unsafe fn call<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Self>()
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::avx::Avx8;
    use super::sse::Sse4;
    use super::{Kernel, Pair, Simd};

    /// Declares a set: its name, its lanes and the features it is compiled with.
    macro_rules! declare {
        ($(#[$doc:meta])* $name:ident, $four:ty, $eight:ty, $features:literal) => {
            $(#[$doc])*
            pub(crate) struct $name;

            impl Simd for $name {
                type Four = $four;
                type Eight = $eight;

                #[inline(always)]
                unsafe fn call<K: Kernel>(kernel: K) -> K::Output {
                    #[target_feature(enable = $features)]
                    #[inline(never)]
                    fn compiled<K: Kernel>(kernel: K) -> K::Output {
                        kernel.run::<$name>()
                    }
                    // SAFETY: the caller promises that the machine has these instructions.
                    unsafe { compiled(kernel) }
                }
            }
        };
    }

    declare!(
        /// The instructions that every x86-64 machine has.
        Sse2, Sse4<false>, Pair<Sse4<false>>, "sse2"
    );
    declare!(
        /// 256-bit vectors and fused products, as in machines since 2013.
        Avx2, Sse4<true>, Avx8<false>, "avx2,fma,bmi1,bmi2,lzcnt,popcnt"
    );
    declare!(
        /// AVX-512 on 256-bit vectors, with masks and compression.
        Avx512, Sse4<true>, Avx8<true>,
        "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt"
    );
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86::{Avx2, Avx512, Sse2};

#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
