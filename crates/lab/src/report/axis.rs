//! The range of an axis, and where its ticks are.

use super::number::{exponent, number, power_of_ten, with_decimals};
use crate::results::Scale;

/// The share of a range that is left free at each end.
const MARGIN: f64 = 0.04;

/// An axis with its range and ticks.
#[derive(Clone, Debug)]
pub(super) struct Ruler {
    scale: Scale,
    low: f64,
    high: f64,
    /// With what is written beside them.
    pub(super) ticks: Vec<(f64, String)>,
    /// Between the ticks.
    pub(super) minor: Vec<f64>,
}

impl Ruler {
    /// An axis on which all values have a place that can have one. None: there are none.
    pub(super) fn new(scale: Scale, values: impl Iterator<Item = f64>) -> Option<Self> {
        let shown = values.filter(|&value| has_place(scale, value));
        let ends = shown.fold(None, |ends: Option<[f64; 2]>, value| {
            let [low, high] = ends.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        });
        let [low, high] = ends?;
        Some(match scale {
            Scale::Linear => Self::linear(low, high),
            Scale::Log => Self::log(low, high),
        })
    }

    /// True where a value has a place on such an axis at all.
    pub(super) fn has_place(&self, value: f64) -> bool {
        has_place(self.scale, value)
    }

    /// Where a value is. Range: `[0, 1]`; what is beyond an end is at the end.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        let fraction = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log if value <= 0.0 => 0.0,
            Scale::Log => libm::log(value / self.low) / libm::log(self.high / self.low),
        };
        fraction.clamp(0.0, 1.0)
    }

    fn linear(low: f64, high: f64) -> Self {
        let margin = if high > low {
            MARGIN * (high - low)
        } else {
            0.1 * low.abs().max(1.0)
        };
        // No margin shows negative numbers where there are none.
        let start = if low >= 0.0 {
            (low - margin).max(0.0)
        } else {
            low - margin
        };
        let end = high + margin;
        let step = Step::near((end - start) / 6.0);
        Self {
            scale: Scale::Linear,
            low: start,
            high: end,
            ticks: step.ticks(start, end),
            minor: Vec::new(),
        }
    }

    fn log(low: f64, high: f64) -> Self {
        let decades = libm::log10(high / low);
        let margin = libm::exp10((MARGIN * decades).max(0.05));
        let (low, high) = (low / margin, high * margin);
        let decades = libm::log10(high / low);
        let minor = multiples(low, high, &[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let minor = minor.map(|(digit, power)| times_power(digit, power));
        Self {
            scale: Scale::Log,
            low,
            high,
            ticks: if decades < 1.0 {
                Step::near((high - low) / 5.0).ticks(low, high)
            } else {
                powers(low, high)
            },
            minor: minor.take_while(|_| decades < 8.0).collect(),
        }
    }
}

/// Powers of ten, at most about eight of them, and where they are few their multiples by 2 and 5.
fn powers(low: f64, high: f64) -> Vec<(f64, String)> {
    let decades = libm::log10(high / low);
    let every = libm::ceil(decades / 8.0) as i32;
    let digits: &[f64] = if decades < 3.0 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0]
    };
    // One way of writing for the whole axis.
    let is_short = low >= 1e-3 && high < 1e5;
    let label = |digit, power| {
        if is_short {
            number(times_power(digit, power))
        } else {
            power_label(digit, power)
        }
    };
    multiples(low, high, digits)
        .filter(|(_, power)| power.rem_euclid(every) == 0)
        .map(|(digit, power)| (times_power(digit, power), label(digit, power)))
        .collect()
}

/// All numbers of a range that have one of these digits and zeros.
fn multiples(low: f64, high: f64, digits: &[f64]) -> impl Iterator<Item = (f64, i32)> {
    let powers = exponent(low)..=exponent(high);
    powers
        .flat_map(move |power| digits.iter().map(move |&digit| (digit, power)))
        .filter(move |&(digit, power)| (low..=high).contains(&times_power(digit, power)))
}

fn has_place(scale: Scale, value: f64) -> bool {
    value.is_finite() && (scale == Scale::Linear || value > 0.0)
}

/// `digit · 10^power`, rounded once where the power is negative, as a reader of digits does.
fn times_power(digit: f64, power: i32) -> f64 {
    if power < 0 {
        digit / libm::exp10(f64::from(-power))
    } else {
        digit * libm::exp10(f64::from(power))
    }
}

fn power_label(digit: f64, power: i32) -> String {
    match (digit > 1.0, power) {
        (_, 0 | 1) => number(times_power(digit, power)),
        (true, _) => format!("{digit}·{}", power_of_ten(power)),
        (false, _) => power_of_ten(power),
    }
}

/// 1, 2 or 5 times a power of ten.
struct Step {
    digit: f64,
    power: i32,
}

impl Step {
    /// The smallest that is not smaller. Range: positive.
    fn near(size: f64) -> Self {
        let power = exponent(size);
        let digit = size / times_power(1.0, power);
        match digit {
            ..=1.0 => Self { digit: 1.0, power },
            ..=2.0 => Self { digit: 2.0, power },
            ..=5.0 => Self { digit: 5.0, power },
            _ => Self {
                digit: 1.0,
                power: power + 1,
            },
        }
    }

    /// All multiples in a range.
    fn ticks(&self, low: f64, high: f64) -> Vec<(f64, String)> {
        let size = times_power(self.digit, self.power);
        let decimals = usize::try_from(-self.power).unwrap_or(0);
        let label = |value: f64| {
            if (-4..=6).contains(&self.power) {
                with_decimals(value, decimals)
            } else {
                number(value)
            }
        };
        let [first, last] = [
            libm::ceil(low / size) as i64,
            libm::floor(high / size) as i64,
        ];
        let multiples =
            (first..=last).map(|index| times_power(index as f64 * self.digit, self.power));
        multiples.map(|value| (value, label(value))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, values: &[f64]) -> String {
        let ruler = Ruler::new(scale, values.iter().copied()).unwrap();
        let labels: Vec<_> = ruler.ticks.into_iter().map(|(_, label)| label).collect();
        labels.join(" ")
    }

    #[test]
    fn linear_ticks_are_1_2_5() {
        for (values, expected) in [
            ([0.0, 1.0], "0.0 0.2 0.4 0.6 0.8 1.0"),
            ([0.0, 100.0], "0 20 40 60 80 100"),
            ([-3.0, 7.0], "−2 0 2 4 6"),
            ([5.0, 5.0], "4.6 4.8 5.0 5.2 5.4"),
            ([0.0, 0.0031], "0.000 0.001 0.002 0.003"),
            ([0.0, 3e9], "0 1·10⁹ 2·10⁹ 3·10⁹"),
        ] {
            assert_eq!(labels(Scale::Linear, &values), expected, "{values:?}");
        }
    }

    #[test]
    fn logarithmic_ticks_are_powers_and_their_2_and_5() {
        for (values, expected) in [
            ([1.0, 1e5], "1 10 10² 10³ 10⁴ 10⁵"),
            ([1e-6, 1e-2], "10⁻⁶ 10⁻⁵ 10⁻⁴ 10⁻³ 10⁻²"),
            ([3.0, 90.0], "5 10 20 50 100"),
            ([0.4, 0.9], "0.4 0.6 0.8 1.0"),
            ([1e-20, 1e12], "10⁻²⁰ 10⁻¹⁵ 10⁻¹⁰ 10⁻⁵ 1 10⁵ 10¹⁰"),
        ] {
            assert_eq!(labels(Scale::Log, &values), expected, "{values:?}");
        }
    }

    #[test]
    fn all_values_have_a_place_inside() {
        for scale in [Scale::Linear, Scale::Log] {
            let values = [0.013, 1.0, 77.0, f64::NAN, f64::INFINITY];
            let ruler = Ruler::new(scale, values.into_iter()).unwrap();
            for value in [0.013, 1.0, 77.0] {
                let fraction = ruler.fraction(value);
                assert!(
                    fraction > 0.0 && fraction < 1.0,
                    "{scale:?} {value} {fraction}"
                );
            }
            for (tick, label) in &ruler.ticks {
                let fraction = ruler.fraction(*tick);
                assert!((0.0..=1.0).contains(&fraction), "{scale:?} {label}");
            }
            assert!(!ruler.has_place(f64::NAN));
        }
    }

    #[test]
    fn what_has_no_logarithm_has_no_place() {
        assert!(Ruler::new(Scale::Log, [0.0, -1.0].into_iter()).is_none());
        let ruler = Ruler::new(Scale::Log, [0.0, 1.0, 10.0].into_iter()).unwrap();
        assert!(!ruler.has_place(0.0));
        assert!(ruler.fraction(0.0) < 1e-9);
    }
}
