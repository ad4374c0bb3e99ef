//! AgX by Troy Sobotka [Sobotka22, base look], in the small form of Benjamin Wrensch
//! [Wrensch23, appendix].
//!
//!     out = (O · s(x))^2.2,   x = (log2(I · in) - a) / (b - a), clamped to [0, 1]
//!
//! I desaturates colours, so that bright ones fade to white instead of clipping; s is the contrast curve;
//! O restores saturation. Middle grey, 0.18, is at x = 0.606, which s maps to the middle of the screen's
//! coded values, 0.5. The numbers are those of [Wrensch23, appendix]; s there is a polynomial of the sixth
//! degree fitted to the table of [Sobotka22, AgX_Default_Contrast], with a mean square error of 3.7e-6.
//!
//! The exponent 2.2 is that of the screen in the description, so that `out` is linear; this program then
//! encodes it by the curve of sRGB, as in the description.

/// The rows of I.
const INSET: [[f32; 3]; 3] = [
    [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
    [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
    [0.0423756549057051, 0.0784336, 0.879142973793104],
];

/// The rows of O.
const OUTSET: [[f32; 3]; 3] = [
    [1.19687900512017, -0.0980208811401368, -0.0990297440797205],
    [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
    [-0.0529716355144438, -0.0980434501171241, 1.15107367264116],
];

/// a and b: ten stops below middle grey and six and a half above. Unit: stops.
const RANGE: [f32; 2] = [-12.47393, 4.026069];

/// The coefficients of s, from x⁶ down to x⁰.
const CURVE: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];

/// The exponent of the screen.
const EXPONENT: f32 = 2.2;

/// Applies the operator. Range: finite and not negative; the result is in `[0, 1]`.
pub(super) fn apply(color: [f32; 3]) -> [f32; 3] {
    let coded = multiply(
        &OUTSET,
        multiply(&INSET, color).map(|channel| curve(log(channel))),
    );
    // Saturated colours leave the screen's range, and s(0) is a little below 0.
    coded.map(|channel| libm::powf(channel.clamp(0.0, 1.0), EXPONENT))
}

/// Returns x, the position of light in the range of stops. Range: `[0, 1]`.
fn log(light: f32) -> f32 {
    let [low, high] = RANGE;
    // The logarithm of 0 is -∞, and clamped like others.
    (libm::log2f(light).clamp(low, high) - low) / (high - low)
}

/// Returns s(x).
fn curve(x: f32) -> f32 {
    CURVE
        .iter()
        .fold(0.0, |sum, coefficient| sum * x + coefficient)
}

fn multiply(matrix: &[[f32; 3]; 3], [r, g, b]: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * r + row[1] * g + row[2] * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middle_grey_is_in_the_middle_of_the_screen() {
        assert!((log(0.18) - 10.0 / 16.5).abs() < 1e-5);
        // The pivot of [Sobotka22], within the error of the polynomial.
        assert!((curve(log(0.18)) - 0.5).abs() < 4e-3);
        // The polynomial itself.
        assert!((curve(log(0.18)) - 0.496730).abs() < 1e-5);
        for channel in apply([0.18; 3]) {
            assert!(
                (libm::powf(channel, 1.0 / EXPONENT) - 0.49673).abs() < 2e-4,
                "{channel}"
            );
        }
    }

    #[test]
    fn the_matrices_keep_grey_and_are_nearly_inverse() {
        for color in [[0.18; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.3, 0.9]] {
            let back = multiply(&OUTSET, multiply(&INSET, color));
            assert!(
                back.iter().zip(color).all(|(a, b)| (a - b).abs() < 1e-3),
                "{back:?}"
            );
        }
        assert!(
            multiply(&INSET, [1.0; 3])
                .iter()
                .all(|channel| (channel - 1.0).abs() < 2e-4)
        );
    }

    #[test]
    fn bright_colours_fade_to_white() {
        let whiteness = |light: f32| {
            let [r, g, _] = apply([light, 0.1 * light, 0.1 * light]);
            g / r
        };
        assert!(whiteness(0.3) < 0.25 && whiteness(1000.0) > 0.99);
        assert!(whiteness(0.3) < whiteness(3.0) && whiteness(3.0) < whiteness(30.0));
    }
}
