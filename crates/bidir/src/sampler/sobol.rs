//! The first two dimensions of Sobol's sequence with hashed Owen scrambling \[Burley20\].
//!
//! Both dimensions need no table: the first is the bits of the index reversed, the second the same
//! after multiplication with Pascal's triangle modulo 2. Indices have 64 bits, so that one sequence
//! can serve all light paths of a render.

/// Point `index` of the sequence that `key` shuffles and scrambles, as 32-bit fractions.
#[inline]
pub(super) fn scrambled_point(index: u64, key: u64) -> (u32, u32) {
    let index = scramble_64(index.reverse_bits(), key).reverse_bits();
    let (x, y) = point(index);
    let (seed_x, seed_y) = (key as u32 ^ 0x5bd1_e995, (key >> 32) as u32 ^ 0x27d4_eb2f);
    (
        scramble_32(x.reverse_bits(), seed_x).reverse_bits(),
        scramble_32(y.reverse_bits(), seed_y).reverse_bits(),
    )
}

/// Point `index` of the unscrambled sequence: the leading 32 digits of each coordinate.
#[inline]
fn point(index: u64) -> (u32, u32) {
    (
        (index.reverse_bits() >> 32) as u32,
        (pascal(index).reverse_bits() >> 32) as u32,
    )
}

/// The product of Pascal's matrix modulo 2 with the bits of `x`.
///
/// Bit i of the result is the parity of the bits j of `x` with C(j, i) odd, which by Lucas' theorem
/// are those whose position j contains all the binary digits of i. That is a sum over supersets,
/// and takes one step per digit of a position.
#[inline]
fn pascal(mut x: u64) -> u64 {
    x ^= (x >> 1) & 0x5555_5555_5555_5555;
    x ^= (x >> 2) & 0x3333_3333_3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f_0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff_00ff_00ff;
    x ^= (x >> 16) & 0x0000_ffff_0000_ffff;
    x ^ (x >> 32)
}

/// A permutation in which bit i of the result depends on bits 0..=i only: on reversed bits, a
/// nested uniform scramble \[Laine11\]. The multipliers are even, so no bit reaches itself.
#[inline]
fn scramble_32(x: u32, seed: u32) -> u32 {
    let mut x = x.wrapping_add(seed);
    for multiplier in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6] {
        x ^= x.wrapping_mul(multiplier);
    }
    x
}

/// [`scramble_32`] for 64 bits.
#[inline]
fn scramble_64(x: u64, seed: u64) -> u64 {
    let mut x = x.wrapping_add(seed);
    for multiplier in [
        0x6c50_b47c_93a1_5d2e,
        0xb82f_1e52_d3c7_4a96,
        0xc7af_e638_5b21_e74a,
        0x8d22_f6e6_2f9d_b358,
    ] {
        x ^= x.wrapping_mul(multiplier);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second coordinate by its direction numbers, v_k = v_{k-1} ⊕ (v_{k-1} >> 1).
    fn second_by_definition(index: u64) -> u32 {
        let (mut y, mut direction) = (0, 1u64 << 63);
        for k in 0..64 {
            if index >> k & 1 == 1 {
                y ^= direction;
            }
            direction ^= direction >> 1;
        }
        (y >> 32) as u32
    }

    #[test]
    fn the_fast_matrix_product_is_the_definition() {
        for index in [
            0,
            1,
            2,
            3,
            77,
            0xdead_beef,
            u64::MAX,
            1 << 63,
            0x1234_5678_9abc_def0,
        ] {
            assert_eq!(point(index).1, second_by_definition(index), "{index:#x}");
        }
    }
}
