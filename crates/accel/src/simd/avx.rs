//! Eight lanes in one register.

use std::arch::x86_64::{
    __m256, __m256i, _mm_loadl_epi64, _mm256_add_epi32, _mm256_castps_si256, _mm256_castsi256_ps,
    _mm256_cmpgt_epi32, _mm256_cmple_epi32_mask, _mm256_cvtepu8_epi32, _mm256_fmsub_ps,
    _mm256_loadu_ps, _mm256_loadu_si256, _mm256_max_epi32, _mm256_min_epi32, _mm256_movemask_ps,
    _mm256_or_si256, _mm256_permute2x128_si256, _mm256_permutevar8x32_epi32, _mm256_set1_ps,
    _mm256_storeu_si256, _mm256_unpackhi_epi32, _mm256_unpacklo_epi32,
};
use std::mem::MaybeUninit;

use super::F32x8;
use crate::node::WIDTH;

/// An expression of intrinsics that touch registers only.
macro_rules! avx2 {
    ($expression:expr) => {
        // SAFETY: the type of this file is used only in kernels of sets with AVX2 and FMA, which the
        // intrinsics need.
        unsafe { $expression }
    };
}

/// Eight lanes; `MASKS` is true with AVX-512. Values exist only in [kernels](super::Kernel) of sets with AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Avx8<const MASKS: bool>(__m256);

impl<const MASKS: bool> Avx8<MASKS> {
    #[inline(always)]
    fn bits(self) -> __m256i {
        avx2!(_mm256_castps_si256(self.0))
    }
}

impl<const MASKS: bool> F32x8 for Avx8<MASKS> {
    const PACKS_FAST: bool = true;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(avx2!(_mm256_set1_ps(value)))
    }

    #[inline(always)]
    fn load(values: &[f32; WIDTH]) -> Self {
        // SAFETY: the reference is valid for 32 bytes, and the load needs no alignment; as to the
        // instruction see `avx2`.
        Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let (a, b) = (self.bits(), other.bits());
        Self(avx2!(_mm256_castsi256_ps(_mm256_min_epi32(a, b))))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let (a, b) = (self.bits(), other.bits());
        Self(avx2!(_mm256_castsi256_ps(_mm256_max_epi32(a, b))))
    }

    #[inline(always)]
    fn mul_sub(self, factor: Self, term: Self) -> Self {
        Self(avx2!(_mm256_fmsub_ps(self.0, factor.0, term.0)))
    }

    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        let (a, b) = (self.bits(), other.bits());
        if MASKS {
            // SAFETY: with `MASKS` a value exists only in kernels of sets with AVX-512 VL.
            u32::from(unsafe { _mm256_cmple_epi32_mask(a, b) })
        } else {
            let greater = avx2!(_mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b)));
            !(avx2!(_mm256_movemask_ps(greater)) as u32) & 0xff
        }
    }

    #[inline(always)]
    fn over(self, low: &[u32; WIDTH]) -> [u64; WIDTH] {
        let mut words = [0; WIDTH];
        // SAFETY: `low` is valid for 32 bytes and `words` for 64, none of which needs alignment; as to
        // the instructions see `avx2`.
        unsafe {
            let (low, high) = (_mm256_loadu_si256(low.as_ptr().cast()), self.bits());
            // Words 0, 1, 4, 5 and 2, 3, 6, 7.
            let even = _mm256_unpacklo_epi32(low, high);
            let odd = _mm256_unpackhi_epi32(low, high);
            let first = _mm256_permute2x128_si256::<0x20>(even, odd);
            let second = _mm256_permute2x128_si256::<0x31>(even, odd);
            let out: *mut u64 = words.as_mut_ptr();
            _mm256_storeu_si256(out.cast(), first);
            _mm256_storeu_si256(out.add(4).cast(), second);
        }
        words
    }

    #[inline(always)]
    fn upper_two(words: &[u32; WIDTH]) -> u32 {
        // SAFETY: the reference is valid for 32 bytes, and the load needs no alignment; as to the
        // instructions see `avx2`.
        unsafe {
            let words = _mm256_loadu_si256(words.as_ptr().cast());
            let either = _mm256_or_si256(words, _mm256_add_epi32(words, words));
            _mm256_movemask_ps(_mm256_castsi256_ps(either)) as u32
        }
    }

    #[inline(always)]
    fn pack(mask: u32, words: &[u32; WIDTH], to: &mut [MaybeUninit<u32>; WIDTH]) {
        let order = &SET_BITS[mask as usize % SET_BITS.len()];
        // SAFETY: `words` and `to` are valid for 32 bytes and `order` for 8, none of which needs alignment; as
        // to the instructions see `avx2`.
        unsafe {
            let words = _mm256_loadu_si256(words.as_ptr().cast());
            let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order.as_ptr().cast()));
            let packed = _mm256_permutevar8x32_epi32(words, order);
            _mm256_storeu_si256(to.as_mut_ptr().cast(), packed);
        }
    }
}

/// For each byte, the positions of its set bits, ascending, then zeros.
static SET_BITS: [[u8; WIDTH]; 1 << WIDTH] = {
    let mut table = [[0; WIDTH]; 1 << WIDTH];
    let mut mask = 0;
    while mask < table.len() {
        let (mut bit, mut len) = (0, 0);
        while bit < WIDTH {
            if mask >> bit & 1 == 1 {
                table[mask][len] = bit as u8;
                len += 1;
            }
            bit += 1;
        }
        mask += 1;
    }
    table
};
