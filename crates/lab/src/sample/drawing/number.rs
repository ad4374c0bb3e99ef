//! Numbers for people: as many digits as mean something.

/// A number with at most four significant digits; whole numbers below ten millions have all of theirs.
pub(super) fn number(value: f64) -> String {
    if let Some(word) = not_finite(value) {
        return word.to_owned();
    }
    let magnitude = exponent(value);
    if value.fract() == 0.0 && magnitude < 7 {
        return grouped(&format!("{value:.0}"));
    }
    if !(-4..6).contains(&magnitude) {
        return scientific(value, magnitude);
    }
    let decimals = usize::try_from(3 - magnitude).unwrap_or(0);
    grouped(&shortened(&format!("{value:.decimals$}")))
}

/// 10ⁿ.
fn power_of_ten(n: i32) -> String {
    let digit = |character| match character {
        '-' => '⁻',
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        _ => '⁹',
    };
    let raised: String = n.to_string().chars().map(digit).collect();
    format!("10{raised}")
}

/// The power of ten of the first digit; 0 for 0.
fn exponent(value: f64) -> i32 {
    let written = format!("{value:e}");
    let digits = written.split_once('e').map(|(_, exponent)| exponent);
    digits
        .and_then(|digits| digits.parse().ok())
        .unwrap_or_default()
}

fn scientific(value: f64, magnitude: i32) -> String {
    let written = format!("{value:.3e}");
    let (digits, power) = written.split_once('e').unwrap_or((&written, ""));
    let power = power.parse().unwrap_or(magnitude);
    format!("{}·{}", grouped(&shortened(digits)), power_of_ten(power))
}

fn not_finite(value: f64) -> Option<&'static str> {
    if value.is_nan() {
        Some("no number")
    } else if value == f64::INFINITY {
        Some("∞")
    } else if value == f64::NEG_INFINITY {
        Some("−∞")
    } else {
        None
    }
}

/// Decimals without the zeros at their end.
fn shortened(written: &str) -> String {
    if written.contains('.') {
        let digits = written.trim_end_matches('0');
        digits.trim_end_matches('.').to_owned()
    } else {
        written.to_owned()
    }
}

/// With a minus sign, and a narrow space between thousands where there are five digits or more.
fn grouped(written: &str) -> String {
    let (sign, digits) = match written.strip_prefix('-') {
        Some(digits) if digits.bytes().any(|byte| (b'1'..=b'9').contains(&byte)) => ("−", digits),
        Some(digits) => ("", digits),
        None => ("", written),
    };
    let (whole, decimals) = match digits.split_once('.') {
        Some((whole, _)) => digits.split_at(whole.len()),
        None => (digits, ""),
    };
    if whole.len() < 5 {
        return format!("{sign}{whole}{decimals}");
    }
    let spaced = |(index, digit)| {
        let space = index > 0 && (whole.len() - index) % 3 == 0;
        space.then_some('\u{202f}').into_iter().chain([digit])
    };
    let whole: String = whole.chars().enumerate().flat_map(spaced).collect();
    format!("{sign}{whole}{decimals}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (0.5, "0.5"),
            (1.0 / 3.0, "0.3333"),
            (-12.3456, "−12.35"),
            (9.99996, "10"),
            (123456.0, "123\u{202f}456"),
            (1234.0, "1234"),
            (54321.6, "54\u{202f}322"),
            (0.000123456, "0.0001235"),
            (0.0000123456, "1.235·10⁻⁵"),
            (9.9999e-5, "1·10⁻⁴"),
            (2.5e9, "2.5·10⁹"),
            (f64::NAN, "no number"),
            (f64::NEG_INFINITY, "−∞"),
        ] {
            assert_eq!(number(value), expected, "{value:e}");
        }
    }
}
