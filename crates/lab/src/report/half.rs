//! Pixels of the page: half floats in base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use half::f16;

/// Rounds a number to a half float, and a finite number beyond ±65504 to ±65504.
///
/// So the viewer shows a very bright pixel, not a broken one. NaN and infinities stay.
fn to_half(value: f32) -> f16 {
    let largest = f32::from(f16::MAX);
    f16::from_f32(if value.is_finite() {
        value.clamp(-largest, largest)
    } else {
        value
    })
}

/// Encodes all channels as half floats, low byte first, in base64.
pub(super) fn halves(pixels: &[[f32; 3]]) -> String {
    let channels = pixels.iter().flatten();
    let bytes = channels.flat_map(|&channel| to_half(channel).to_le_bytes());
    base64(&bytes.collect::<Vec<_>>())
}

/// Encodes bytes in base64, with the padding that browsers' `atob` and security policies expect.
pub(super) fn base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let half = to_half(value).to_bits();
            assert_eq!(half, bits, "{value:e}: {half:#06x}");
        }
    }
}
