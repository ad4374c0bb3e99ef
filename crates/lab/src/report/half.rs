//! Half floats and base64: pixels as they stand in the page.

/// The half float next to a number, to even where there are two; beyond ±65504 those, not infinity.
///
/// The viewer should show a very bright pixel, not a broken one. NaN and infinities stay.
pub(super) fn to_half(value: f32) -> u16 {
    let sign = ((value.to_bits() >> 16) & 0x8000) as u16;
    let magnitude = value.abs();
    if magnitude.is_nan() {
        return sign | 0x7e00;
    }
    if magnitude.is_infinite() {
        return sign | 0x7c00;
    }
    // Below 2⁻¹⁴ halves are multiples of 2⁻²⁴; the product is exact.
    if magnitude < 6.103_515_6e-5 {
        let multiple = f64::from(magnitude) * f64::from(1 << 24);
        return sign | multiple.round_ties_even() as u16;
    }
    let bits = magnitude.min(65504.0).to_bits();
    // 13 bits of the mantissa go; what is carried goes into the exponent, as it should.
    let rounded = bits + 0xfff + ((bits >> 13) & 1);
    sign | ((rounded >> 13) - (112 << 10)) as u16
}

/// All channels as half floats, low byte first.
pub(super) fn half_bytes(pixels: &[[f32; 3]]) -> Vec<u8> {
    let channels = pixels.iter().flatten();
    channels
        .flat_map(|&channel| to_half(channel).to_le_bytes())
        .collect()
}

/// Bytes as base64, with the padding that browsers' `atob` and security policies expect.
pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut written = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let joined = (byte(0) << 16) | (byte(1) << 8) | byte(2);
        for digit in 0..4 {
            let value = (joined >> (18 - 6 * digit)) & 63;
            let is_padding = digit > group.len();
            written.push(if is_padding {
                '='
            } else {
                DIGITS[value as usize] as char
            });
        }
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition of IEEE 754, as the page's script computes it.
    fn from_half(bits: u16) -> f64 {
        let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
        let (exponent, mantissa) = ((bits >> 10) & 31, f64::from(bits & 1023));
        match exponent {
            0 => sign * mantissa * libm::exp2(-24.0),
            31 if mantissa > 0.0 => f64::NAN,
            31 => sign * f64::INFINITY,
            _ => sign * (1024.0 + mantissa) * libm::exp2(f64::from(exponent) - 25.0),
        }
    }

    #[test]
    fn known_bit_patterns() {
        for (value, bits) in [
            (0.0, 0x0000),
            (-0.0, 0x8000),
            (1.0, 0x3c00),
            (-2.0, 0xc000),
            (1.0 / 3.0, 0x3555),
            (65504.0, 0x7bff),
            (1e9, 0x7bff),
            (-70000.0, 0xfbff),
            (6.103_515_6e-5, 0x0400),
            (5.960_464_5e-8, 0x0001),
            (2.980_232_2e-8, 0x0000),
            (f32::INFINITY, 0x7c00),
            (f32::NEG_INFINITY, 0xfc00),
            (f32::NAN, 0x7e00),
            // Half way between two: to the even one, downwards and upwards.
            (1.0 + 1.0 / 2048.0, 0x3c00),
            (1.0 + 3.0 / 2048.0, 0x3c02),
            // Up to the next power of two.
            (1.9998, 0x4000),
            (6.1e-5, 0x03ff),
        ] {
            assert_eq!(to_half(value), bits, "{value:e}: {:#06x}", to_half(value));
        }
    }

    #[test]
    fn every_half_comes_back() {
        for bits in 0..=u16::MAX {
            let value = from_half(bits);
            if !value.is_nan() {
                assert_eq!(to_half(value as f32), bits, "{value:e}");
            }
        }
    }

    #[test]
    fn base64_is_that_of_rfc_4648() {
        for (bytes, expected) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), expected);
        }
        assert_eq!(base64(&[0xfb, 0xff]), "+/8=");
    }
}
