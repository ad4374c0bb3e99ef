//! Q(a, x) = Γ(a, x)/Γ(a), the tail of the χ² distribution [Press07, §6.2].

/// Returns the upper tail Q(a, x) = Γ(a, x)/Γ(a) of the gamma distribution: by its series below a + 1, by
/// Lentz's continued fraction above [Press07, §6.2].
pub(super) fn upper_tail(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let factor = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        1.0 - factor * series(a, x)
    } else {
        factor * continued_fraction(a, x)
    }
}

fn series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    let mut n = a;
    while term > sum * 1e-15 {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    sum
}

fn continued_fraction(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let mut c = 1e300;
    let mut d = 1.0 / b;
    let mut value = d;
    for i in 1..100_000 {
        let i = f64::from(i);
        let numerator = -i * (i - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        value *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the tail of χ² with `freedom` degrees against a printed table.
    #[track_caller]
    fn check(freedom: f64, statistic: f64, expected: f64) {
        let p = upper_tail(freedom / 2.0, statistic / 2.0);
        assert!(
            (p / expected - 1.0).abs() < 2e-3,
            "{p} instead of {expected}"
        );
    }

    #[test]
    fn tails_are_those_of_the_tables() {
        check(1.0, 3.841, 0.05);
        check(1.0, 10.828, 0.001);
        check(2.0, 2.0 * std::f64::consts::LN_2, 0.5);
        check(10.0, 18.307, 0.05);
        check(10.0, 29.588, 0.001);
        check(10.0, 3.940, 0.95);
        check(100.0, 124.342, 0.05);
        check(1000.0, 1074.679, 0.05);
        check(1000.0, 927.594, 0.95);
        assert!(upper_tail(3.0, 0.0) >= 1.0 && upper_tail(400.0, 4000.0) < 1e-300);
    }
}
