//! The first two dimensions of Sobol's sequence with hashed Owen scrambling \[Burley20\].
//!
//! Neither dimension needs a table: the digits of the first are the bits of the index, and those of the second are
//! the same bits multiplied by Pascal's triangle modulo 2, least significant bit first. A digit is bit 31 of a
//! fraction and bit 0 of an index, so that bits are reversed only in the given index and in the resulting fractions.

/// The digits of a point, before they become fractions.
#[derive(Clone, Copy)]
pub(super) struct Digits {
    /// The lower half is the index in the sequence, which is x; the upper half is the digital shift, the index of an
    /// unscrambled point.
    indices: u64,
    key: u64,
}

impl Digits {
    /// Makes the point of the sequence that `key` shuffles and scrambles. `reversed_index` is its index with reversed
    /// bits.
    #[inline]
    pub(super) fn new(reversed_index: u32, key: u64) -> Self {
        Self {
            indices: u64::from(shuffled(reversed_index, key).reverse_bits()),
            key,
        }
    }

    /// Makes the point, shifted digit by digit by a point of another sequence, whose index with reversed bits is
    /// `other`.
    #[inline]
    pub(super) fn moved(reversed_index: u32, other: u32, key: u64) -> Self {
        // The sum is as uniform as one of the two.
        let shift = shuffled(other, key.rotate_left(32));
        let halves = pair(shift, shuffled(reversed_index, key));
        Self {
            indices: halves.reverse_bits(),
            key,
        }
    }

    /// Returns the first coordinate. Unit: 2⁻³².
    #[inline]
    pub(super) fn x(self) -> u32 {
        self.scrambled_x().reverse_bits()
    }

    /// Returns both coordinates. Unit: 2⁻³².
    #[inline]
    pub(super) fn xy(self) -> [u32; 2] {
        let seed = (self.key >> 32) as u32 ^ 0x27d4_eb2f;
        let [index, shift] = halves(pascal(self.indices));
        let y = scramble(index, seed) ^ shift;
        halves(pair(y, self.scrambled_x()).reverse_bits())
    }

    #[inline]
    fn scrambled_x(self) -> u32 {
        let [index, shift] = halves(self.indices);
        scramble(index, self.key as u32 ^ 0x5bd1_e995) ^ shift
    }
}

/// Returns a number with these halves. Reversing it reverses the halves and exchanges them.
#[inline]
fn pair(lower: u32, upper: u32) -> u64 {
    u64::from(upper) << 32 | u64::from(lower)
}

/// Returns the lower and the upper half.
#[inline]
fn halves(x: u64) -> [u32; 2] {
    [x as u32, (x >> 32) as u32]
}

/// Returns the reversed index after a nested uniform scramble: it permutes aligned ranges of the sequence.
#[inline]
fn shuffled(reversed_index: u32, key: u64) -> u32 {
    let seed = (key as u32).rotate_left(16) ^ (key >> 32) as u32;
    scramble(reversed_index, seed)
}

/// Returns the products of Pascal's matrix modulo 2 with the bits of both halves of `x`.
///
/// Bit i of a result is the parity of the bits j of its half with C(j, i) odd, which by Lucas' theorem
/// are those whose position j contains all the binary digits of i. That is a sum over supersets,
/// and takes one step per digit of a position.
#[inline]
fn pascal(mut x: u64) -> u64 {
    x ^= (x >> 1) & 0x5555_5555_5555_5555;
    x ^= (x >> 2) & 0x3333_3333_3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f_0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff_00ff_00ff;
    x ^ ((x >> 16) & 0x0000_ffff_0000_ffff)
}

/// Returns a permutation in which bit i of the result depends only on bits 0..=i: on reversed bits, a nested uniform
/// scramble \[Laine11\]. The multipliers are even, so no bit reaches itself.
#[inline]
fn scramble(x: u32, seed: u32) -> u32 {
    let mut x = x.wrapping_add(seed);
    for multiplier in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6] {
        x ^= x.wrapping_mul(multiplier);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the second coordinate by its direction numbers, v_k = v_{k-1} ⊕ (v_{k-1} >> 1).
    fn second_by_definition(index: u32) -> u32 {
        let (mut y, mut direction) = (0, 1u32 << 31);
        for k in 0..32 {
            if index >> k & 1 == 1 {
                y ^= direction;
            }
            direction ^= direction >> 1;
        }
        y
    }

    #[test]
    fn the_fast_matrix_product_is_the_definition() {
        for index in [0, 1, 2, 3, 77, 0xdead_beef, u32::MAX, 1 << 31, 0x1234_5678] {
            let y = halves(pascal(pair(index, !index))).map(u32::reverse_bits);
            let expected = [index, !index].map(second_by_definition);
            assert_eq!(y, expected, "{index:#x}");
        }
    }
}
