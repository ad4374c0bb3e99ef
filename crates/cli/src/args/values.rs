//! Values of the command line.

use bidir::film::PixelRect;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Returns a parser of the names in a table of the library.
pub(crate) fn named<T, const N: usize>(
    names: [(&'static str, T); N],
) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    PossibleValuesParser::new(names.map(|(name, _)| name)).map(move |given| {
        let entry = names.iter().find(|(name, _)| *name == given);
        entry.expect("clap lets no other name through").1
    })
}

/// Returns a parser of whole numbers in a range: `4096`, `4k` (4000), `2M`, `1e6`.
pub(crate) fn count<T: TryFrom<u64>>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    move |text: &str| {
        let number = whole_number(text).filter(|number| range.contains(number));
        let number = number.and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| format!("expected {}", whole_numbers(&range)))
    }
}

/// Reads a whole number, which may have a unit or an exponent.
fn whole_number(text: &str) -> Option<u64> {
    let text = text.trim();
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let units = [('k', 1e3), ('K', 1e3), ('M', 1e6), ('G', 1e9)];
    let mut units = units.into_iter();
    let found = units.find_map(|(letter, unit)| Some((text.strip_suffix(letter)?, unit)));
    let (number, unit) = found.unwrap_or((text, 1.0));
    let value = number.parse::<f64>().ok()? * unit;
    let whole = value.round();
    // Whole numbers beyond 2⁵³ have no exact floats. NaN fails the comparisons, too.
    let is_whole = (value - whole).abs() <= 1e-9 * whole && whole <= (1_u64 << 53) as f64;
    is_whole.then_some(whole as u64)
}

/// Describes the whole numbers in a range for messages.
fn whole_numbers(range: &RangeInclusive<u64>) -> String {
    match (*range.start(), *range.end()) {
        (1, u64::MAX) => "a whole number above 0".to_owned(),
        (least, u64::MAX) => format!("a whole number, {least} or more"),
        (least, most) => format!("a whole number from {least} to {most}"),
    }
}

/// Reads the name of an instruction set that this machine supports.
pub(crate) fn isa(name: &str) -> Result<accel::Isa, String> {
    let isa = name
        .parse::<accel::Isa>()
        .map_err(|error| error.to_string())?;
    let missing = || format!("this machine does not have the instruction set `{isa}`");
    isa.is_supported().then_some(isa).ok_or_else(missing)
}

/// Width and height, written `1920x1080`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size(pub(crate) [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |side: &str| side.trim().parse::<u32>().ok();
        let sides = text
            .split_once(['x', 'X'])
            .and_then(|(width, height)| Some([side(width)?, side(height)?]));
        let valid = sides.filter(|sides| sides.iter().all(|side| (1..=MOST).contains(side)));
        valid.map(Self).ok_or_else(|| {
            format!("expected WIDTHxHEIGHT of 1 to {MOST} pixels each, such as 1920x1080")
        })
    }
}

/// The most pixels of a side of a film.
const MOST: u32 = 1 << 16;

/// Reads a finite number above zero.
pub(crate) fn positive_number(text: &str) -> Result<f64, String> {
    let percent = text.trim().strip_suffix('%');
    if let Some(percent) = percent.and_then(|percent| percent.trim().parse::<f64>().ok()) {
        return Err(format!(
            "write a fraction without a percent sign: {}",
            percent / 100.0
        ));
    }
    let number = text.trim().parse::<f64>().ok();
    let number = number.filter(|number| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "expected a number above 0, such as 0.01".into())
}

/// Reads `N` numbers between commas.
fn list<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Result<Vec<T>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    numbers.ok()?.try_into().ok()
}

/// A rectangle of pixels, written `x0,y0,x1,y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelBounds(pub(crate) PixelRect);

impl PixelBounds {
    fn new([x0, y0, x1, y1]: [u32; 4]) -> Result<Self, String> {
        if x0 < x1 && y0 < y1 {
            Ok(Self(PixelRect {
                min: [x0, y0],
                max: [x1, y1],
            }))
        } else {
            Err("the rectangle is empty: its end is not beyond its beginning".into())
        }
    }

    /// Reads a rectangle in pbrt's order, `x0,x1,y0,y1`.
    pub(crate) fn from_pbrt(text: &str) -> Result<Self, String> {
        let [x0, x1, y0, y1] = list(text).ok_or("expected four pixel numbers: x0,x1,y0,y1")?;
        Self::new([x0, y0, x1, y1])
    }
}

impl FromStr for PixelBounds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::new(list(text).ok_or("expected four pixel numbers: x0,y0,x1,y1")?)
    }
}

/// A part of the film as fractions of its size, in pbrt's order: `x0,x1,y0,y1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CropFractions(pub(crate) [f32; 4]);

impl FromStr for CropFractions {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x0, x1, y0, y1] =
            list::<f32, 4>(text).ok_or("expected four numbers from 0 to 1: x0,x1,y0,y1")?;
        let inside = [x0, x1, y0, y1]
            .iter()
            .all(|fraction| (0.0..=1.0).contains(fraction));
        if inside && x0 < x1 && y0 < y1 {
            Ok(Self([x0, x1, y0, y1]))
        } else {
            Err("expected 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1".into())
        }
    }
}

/// A sample to repeat, written `x,y,pass`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ReplayTarget {
    /// The pixel.
    pub(crate) pixel: [u32; 2],
    /// The pass, counted from 0.
    pub(crate) pass: u64,
}

impl FromStr for ReplayTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = list::<u64, 3>(text).ok_or("expected three whole numbers: x,y,pass")?;
        let [x, y, pass] = numbers;
        let pixel = |at: u64| u32::try_from(at).map_err(|_| format!("there is no pixel {at}"));
        Ok(Self {
            pixel: [pixel(x)?, pixel(y)?],
            pass,
        })
    }
}

/// A length of time, written `90`, `90s`, `10m`, `1h30m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Duration(pub(crate) std::time::Duration);

impl FromStr for Duration {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected a time such as 90, 90s, 10m or 1h30m".to_owned();
        let text = text.trim();
        let is_known = |c: char| c.is_ascii_digit() || ".hms".contains(c);
        // A single number without a unit is in seconds.
        let (mut seconds, mut rest) = text.parse().map_or((0.0, text), |seconds| (seconds, ""));
        for (unit, length) in [('h', 3600.0), ('m', 60.0), ('s', 1.0)] {
            if let Some((count, after)) = rest.split_once(unit) {
                seconds += count.parse::<f64>().map_err(|_| expected())? * length;
                rest = after;
            }
        }
        if text.is_empty() || !text.chars().all(is_known) || !rest.is_empty() {
            return Err(expected());
        }
        let time = std::time::Duration::try_from_secs_f64(seconds).map_err(|_| expected())?;
        let positive = Some(time).filter(|time| !time.is_zero());
        positive
            .map(Self)
            .ok_or_else(|| "must be above 0, such as 90s".to_owned())
    }
}

impl fmt::Display for Duration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.0.as_secs_f64();
        let (hours, minutes) = (self.0.as_secs() / 3600, self.0.as_secs() / 60 % 60);
        match (hours, minutes) {
            (0, 0) if seconds < 10.0 => write!(f, "{seconds:.2}s"),
            (0, 0) => write!(f, "{seconds:.1}s"),
            (0, _) => write!(f, "{minutes}m{:02}s", self.0.as_secs() % 60),
            _ => write!(f, "{hours}h{minutes:02}m"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_units_and_exponents() {
        let read = |text| count::<u64>(1..=u64::MAX)(text).ok();
        for (text, expected) in [
            ("64", 64),
            (" 64 ", 64),
            ("4k", 4000),
            ("4K", 4000),
            ("2.3k", 2300),
            ("1.5M", 1_500_000),
            ("1G", 1_000_000_000),
            ("1e6", 1_000_000),
            ("1e9", 1_000_000_000),
            ("2.5E3", 2500),
            ("4.0", 4),
            ("18446744073709551615", u64::MAX),
        ] {
            assert_eq!(read(text), Some(expected), "{text}");
        }
        for text in [
            "", "k", "0", "0k", "-1", "-4k", "4.5", "1e-3", "4m", "4kk", "1e400", "inf", "nan",
            "1e17", "4 000", "0x10",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
        assert_eq!(
            count::<u64>(1..=100)("1k").unwrap_err(),
            "expected a whole number from 1 to 100"
        );
    }

    #[track_caller]
    fn check_duration(text: &str, expected: Option<f64>) {
        let seconds = text
            .parse::<Duration>()
            .ok()
            .map(|duration| duration.0.as_secs_f64());
        assert_eq!(seconds, expected, "{text}");
    }

    #[test]
    fn durations_are_parsed() {
        check_duration("90", Some(90.0));
        check_duration("90s", Some(90.0));
        check_duration("0.5", Some(0.5));
        check_duration("10m", Some(600.0));
        check_duration("1h30m", Some(5400.0));
        check_duration("1h30m5s", Some(5405.0));
        for text in [
            "",
            "0",
            "m",
            "10x",
            "1m2h",
            "1h30",
            "-5",
            "1e9h",
            "nan",
            "99999999999999999999h",
        ] {
            check_duration(text, None);
        }
    }

    #[test]
    fn durations_are_printed_in_short_form() {
        let write = |seconds| Duration(std::time::Duration::from_secs_f64(seconds)).to_string();
        assert_eq!(write(1.234), "1.23s");
        assert_eq!(write(12.34), "12.3s");
        assert_eq!(write(90.0), "1m30s");
        assert_eq!(write(5400.0), "1h30m");
    }

    #[test]
    fn rectangles_are_read_in_both_orders() {
        let rect = PixelRect {
            min: [1, 2],
            max: [3, 4],
        };
        assert_eq!("1,2,3,4".parse(), Ok(PixelBounds(rect)));
        assert_eq!(PixelBounds::from_pbrt("1,3,2,4"), Ok(PixelBounds(rect)));
        for text in ["1,2,3", "1,2,1,4", "a,b,c,d", "-1,0,3,4"] {
            assert!(text.parse::<PixelBounds>().is_err(), "{text}");
        }
    }

    #[test]
    fn fractions_are_checked() {
        assert_eq!(
            "0.25,0.75,0,0.5".parse(),
            Ok(CropFractions([0.25, 0.75, 0.0, 0.5]))
        );
        assert!("0.5,0.5,0,1".parse::<CropFractions>().is_err());
        assert!("0,2,0,1".parse::<CropFractions>().is_err());
    }

    #[test]
    fn sizes_and_samples_are_checked() {
        assert_eq!("1920x1080".parse(), Ok(Size([1920, 1080])));
        assert_eq!(
            "3,4,17".parse(),
            Ok(ReplayTarget {
                pixel: [3, 4],
                pass: 17
            })
        );
        assert!("0x5".parse::<Size>().is_err());
        assert!("1,2".parse::<ReplayTarget>().is_err());
    }
}
