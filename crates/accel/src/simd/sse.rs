//! Four lanes in one register.

use std::arch::x86_64::{
    __m128, _mm_add_ps, _mm_andnot_ps, _mm_cmple_ps, _mm_cmplt_ps, _mm_fmadd_ps, _mm_fmsub_ps,
    _mm_fnmadd_ps, _mm_loadu_ps, _mm_max_ps, _mm_min_ps, _mm_movemask_ps, _mm_mul_ps, _mm_set1_ps,
    _mm_storeu_ps, _mm_sub_ps,
};
use std::ops::{Add, Mul, Sub};

use super::F32x4;

/// An expression of intrinsics that touch registers only.
macro_rules! sse2 {
    ($expression:expr) => {
        // SAFETY: the intrinsics need SSE2 and nothing else, and every x86-64 machine has that.
        unsafe { $expression }
    };
}

/// Four lanes; `FUSED` is true with FMA. Such values exist only in [kernels](super::Kernel) of sets with FMA.
#[derive(Clone, Copy)]
pub(crate) struct Sse4<const FUSED: bool>(__m128);

impl<const FUSED: bool> Add for Sse4<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(sse2!(_mm_add_ps(self.0, other.0)))
    }
}

impl<const FUSED: bool> Sub for Sse4<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(sse2!(_mm_sub_ps(self.0, other.0)))
    }
}

impl<const FUSED: bool> Mul for Sse4<FUSED> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(sse2!(_mm_mul_ps(self.0, other.0)))
    }
}

/// `$fused` of three operands where there is FMA, `$plain` elsewhere.
macro_rules! fused_or {
    ($fused:ident, $a:expr, $b:expr, $c:expr, $plain:expr) => {
        if FUSED {
            // SAFETY: a fused value exists only where the machine has FMA.
            Self(unsafe { $fused($a.0, $b.0, $c.0) })
        } else {
            $plain
        }
    };
}

impl<const FUSED: bool> F32x4 for Sse4<FUSED> {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(sse2!(_mm_set1_ps(value)))
    }

    #[inline(always)]
    fn load(values: &[f32; 4]) -> Self {
        // SAFETY: the reference is valid for 16 bytes, and the load needs no alignment.
        Self(unsafe { _mm_loadu_ps(values.as_ptr()) })
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 4] {
        let mut values = [0.0; 4];
        // SAFETY: the array has room for 16 bytes, and the store needs no alignment.
        unsafe { _mm_storeu_ps(values.as_mut_ptr(), self.0) };
        values
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(sse2!(_mm_min_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(sse2!(_mm_max_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(sse2!(_mm_andnot_ps(_mm_set1_ps(-0.0), self.0)))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        fused_or!(_mm_fmadd_ps, self, factor, term, self * factor + term)
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        fused_or!(_mm_fmsub_ps, self, factor, term, self * factor - term)
    }

    #[inline(always)]
    fn sub_from(self, factor: Self, term: Self) -> Self {
        fused_or!(_mm_fnmadd_ps, self, factor, term, term - self * factor)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        sse2!(_mm_movemask_ps(_mm_cmplt_ps(self.0, other.0))) as u32
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        sse2!(_mm_movemask_ps(_mm_cmple_ps(self.0, other.0))) as u32
    }
}
