//! Numbers as texts for people.

/// Formats a number with three significant digits, a whole number with all digits.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    let is_whole = value.fract().abs() < f64::EPSILON;
    if value.is_nan() || is_whole && size < 1e6 {
        return format!("{value}");
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{value:.2e}");
    }
    let before = libm::floor(libm::log10(size)) as i32;
    format!("{value:.*}", (2 - before).max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let cases = [
            (64.0, "64"),
            (0.84159, "0.842"),
            (123.456, "123"),
            (12.3456, "12.3"),
            (0.00123456, "0.00123"),
            (1.23456e-7, "1.23e-7"),
            (-0.5, "-0.500"),
        ];
        for (value, expected) in cases {
            assert_eq!(number(value), expected);
        }
    }
}
