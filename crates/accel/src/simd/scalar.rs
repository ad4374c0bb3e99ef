//! Lanes without intrinsics, and eight lanes as two times four.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

use super::{F32x4, F32x8};
use crate::node::WIDTH;

/// Four lanes as an array.
#[derive(Clone, Copy)]
pub(crate) struct Scalar4([f32; 4]);

impl Scalar4 {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(from_fn(|k| f(self.0[k], other.0[k])))
    }

    #[inline(always)]
    fn compare(self, other: Self, holds: impl Fn(f32, f32) -> bool) -> u32 {
        (0..4).fold(0, |mask, k| {
            mask | u32::from(holds(self.0[k], other.0[k])) << k
        })
    }
}

impl Add for Scalar4 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Scalar4 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Scalar4 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl F32x4 for Scalar4 {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn load(values: &[f32; 4]) -> Self {
        Self(*values)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 4] {
        self.0
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        self * factor - term
    }

    #[inline(always)]
    fn sub_from(self, factor: Self, term: Self) -> Self {
        term - self * factor
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.compare(other, |a, b| a <= b)
    }
}

/// Eight lanes: the first four, and the last four.
#[derive(Clone, Copy)]
pub(crate) struct Pair<V>(V, V);

impl<V: F32x4> F32x8 for Pair<V> {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(V::splat(value), V::splat(value))
    }

    #[inline(always)]
    fn load([a, b, c, d, e, f, g, h]: &[f32; WIDTH]) -> Self {
        Self(V::load(&[*a, *b, *c, *d]), V::load(&[*e, *f, *g, *h]))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        let first = self.0.mul_sub(factor.0, term.0);
        Self(first, self.1.mul_sub(factor.1, term.1))
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        self.0.le(other.0) | self.1.le(other.1) << 4
    }

    #[inline(always)]
    fn over(self, low: &[u32; WIDTH]) -> [u64; WIDTH] {
        let (first, second) = (self.0.to_array(), self.1.to_array());
        let lane = |k: usize| if k < 4 { first[k] } else { second[k - 4] };
        from_fn(|k| u64::from(lane(k).to_bits()) << 32 | u64::from(low[k]))
    }
}
