//! Fixed-point sums: integers, so that the order of addition does not matter.

use std::sync::atomic::{AtomicU64, Ordering};

/// The scale of values: they are multiples of 2⁻⁶⁰.
pub const VALUE_SCALE: i32 = 60;
/// The scale of squares: they are multiples of 2⁻⁴⁰. Their sum saturates at 2⁸⁷, where only the variance becomes
/// useless.
pub const MOMENT_SCALE: i32 = 40;
/// The largest contribution: a larger one is dropped and counted.
pub const LARGEST_CONTRIBUTION: f32 = 1_099_511_627_776.0; // 2⁴⁰

/// Returns 2^exponent, exactly.
#[inline]
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// Returns `value`·2^scale, rounded towards zero, as every machine does; 0 for NaN.
#[inline]
pub fn from_f64(value: f64, scale: i32) -> i128 {
    let scaled = value * power_of_two(scale);
    if scaled.abs() < power_of_two(63) {
        // One instruction converts to 64 bits.
        i128::from(scaled as i64)
    } else {
        large_from_f64(scaled)
    }
}

/// Converts a number of 2⁶³ or more, which is an integer, by shifting its 53 bits: it takes a tenth of the time of a
/// conversion to 128 bits.
fn large_from_f64(value: f64) -> i128 {
    let (bits, fraction) = (value.to_bits(), (1 << 52) - 1);
    let shift = ((bits >> 52) & 0x7ff) as i32 - 1075;
    if shift > 127 - 53 {
        // It does not fit, or is NaN.
        return value as i128;
    }
    let magnitude = i128::from(bits & fraction | (1 << 52)) << shift;
    if value < 0.0 { -magnitude } else { magnitude }
}

/// Returns `fixed`·2^-scale, rounded to nearest.
#[inline]
pub fn to_f64(fixed: i128, scale: i32) -> f64 {
    let value = i64::try_from(fixed).map_or_else(|_| large_to_f64(fixed), |small| small as f64);
    value * power_of_two(-scale)
}

/// Converts by the first 63 bits. They round as all bits do, if the last of them is set when any bit behind them is.
fn large_to_f64(fixed: i128) -> f64 {
    let magnitude = fixed.unsigned_abs();
    let shift = 65 - magnitude.leading_zeros();
    let first = magnitude >> shift;
    let rest = u128::from(first << shift != magnitude);
    let value = (first | rest) as i64 as f64 * power_of_two(shift as i32);
    if fixed < 0 { -value } else { value }
}

/// A sum that threads add to without a lock: the low word carries into the high one. It may be read only when no
/// thread adds.
#[derive(Debug, Default)]
pub(crate) struct FixedSum {
    low: AtomicU64,
    high: AtomicU64,
}

impl FixedSum {
    #[inline]
    pub(crate) fn add(&self, value: i128) {
        let (low, high) = (value as u64, (value >> 64) as u64);
        let before = self.low.fetch_add(low, Ordering::Relaxed);
        let carry = u64::from(before.checked_add(low).is_none());
        let high = high.wrapping_add(carry);
        if high != 0 {
            self.high.fetch_add(high, Ordering::Relaxed);
        }
    }

    #[inline]
    pub(crate) fn get(&self) -> i128 {
        let high = i128::from(self.high.load(Ordering::Relaxed) as i64);
        (high << 64) | i128::from(self.low.load(Ordering::Relaxed))
    }

    #[inline]
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limbs_carry_and_borrow() {
        let carries = [1i128 << 63, 1 << 63, -1, 5 << 70, -(3 << 70)];
        let values = carries
            .into_iter()
            .chain([i128::from(u64::MAX), -(1 << 90)]);
        let mut sum = FixedSum::default();
        let mut expected = 0;
        for value in values {
            sum.add(value);
            expected += value;
            assert_eq!(sum.get(), expected);
        }
        sum.clear();
        assert_eq!(sum.get(), 0);
    }

    #[test]
    fn threads_lose_nothing() {
        let sum = FixedSum::default();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..10_000).for_each(|i| sum.add((i128::from(i) << 50) - 7)));
            }
        });
        let expected: i128 = (0..10_000i128).map(|i| (i << 50) - 7).sum();
        assert_eq!(sum.get(), 4 * expected);
    }

    /// Checks a fixed-point number against the conversion of the language.
    #[track_caller]
    fn check_float(fixed: i128, scale: i32) {
        let expected = fixed as f64 * power_of_two(-scale);
        let found = to_f64(fixed, scale).to_bits();
        assert_eq!(found, expected.to_bits(), "{fixed}");
    }

    #[test]
    fn small_and_large_values_are_converted_alike() {
        for value in [
            0.0, -0.0, 7.999999, 8.0, 8.000001, -7.3, -8.0, -9.1, 1e-19, -1e12, 1e30,
        ] {
            let fixed = (value * power_of_two(VALUE_SCALE)) as i128;
            assert_eq!(from_f64(value, VALUE_SCALE), fixed, "{value}");
            check_float(fixed, VALUE_SCALE);
        }
        assert_eq!(from_f64(f64::NAN, VALUE_SCALE), 0);
    }

    /// Against the conversions of the language.
    #[test]
    fn all_orders_of_magnitude_are_converted_alike() {
        let mut bits = 1u64;
        for exponent in -3..=127 {
            for _ in 0..64 {
                bits = bits.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29) + 1;
                let digits = 1.0 + (bits >> 12) as f64 * power_of_two(-52);
                let value = digits * power_of_two(exponent);
                for value in [value, -value] {
                    assert_eq!(from_f64(value, 0), value as i128, "{value}");
                }
                let fixed = (i128::from(bits) << 64 | i128::from(!bits)) >> (127 - exponent.max(0));
                for fixed in [fixed, -fixed, fixed | 1, fixed & !0xff] {
                    check_float(fixed, 0);
                }
            }
        }
        for fixed in [i128::MIN, i128::MAX, 1 << 63, -(1 << 63)] {
            check_float(fixed, 0);
            check_float(fixed - fixed.signum(), 0);
        }
        check_float((1 << 64) - 1, 0);
        assert_eq!(from_f64(f64::INFINITY, 0), i128::MAX);
    }
}
