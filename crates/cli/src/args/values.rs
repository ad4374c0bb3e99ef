//! Values of the command line.

use bidir::film::PixelRect;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

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
        let whole = whole_number(text).filter(|number| range.contains(number));
        let number = whole.and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| format!("expected {}", whole_numbers(&range)))
    }
}

/// Reads a whole number, which may have a unit or an exponent.
fn whole_number(text: &str) -> Option<u64> {
    let text = text.trim();
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let mut units = [('k', 1e3), ('K', 1e3), ('M', 1e6), ('G', 1e9)].into_iter();
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

/// Reads width and height, written `1920x1080`.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |side: &str| {
        let number = side.trim().parse().ok();
        number.filter(|number| (1..=MOST).contains(number))
    };
    let sides = text.split_once(['x', 'X']);
    sides
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| {
            format!("expected WIDTHxHEIGHT of 1 to {MOST} pixels each, such as 1920x1080")
        })
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
    let parsed = text.trim().parse::<f64>().ok();
    let number = parsed.filter(|number| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "expected a number above 0, such as 0.01".into())
}

/// Reads `N` numbers between commas.
fn list<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Result<Vec<T>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    numbers.ok()?.try_into().ok()
}

/// Reads a rectangle of pixels, written `x0,y0,x1,y1`.
pub(crate) fn pixel_bounds(text: &str) -> Result<PixelRect, String> {
    let [x0, y0, x1, y1] = list(text).ok_or("expected four pixel numbers: x0,y0,x1,y1")?;
    rectangle([x0, y0], [x1, y1])
}

/// Reads a rectangle in pbrt's order, `x0,x1,y0,y1`.
pub(crate) fn pbrt_pixel_bounds(text: &str) -> Result<PixelRect, String> {
    let [x0, x1, y0, y1] = list(text).ok_or("expected four pixel numbers: x0,x1,y0,y1")?;
    rectangle([x0, y0], [x1, y1])
}

fn rectangle(min: [u32; 2], max: [u32; 2]) -> Result<PixelRect, String> {
    if min[0] < max[0] && min[1] < max[1] {
        Ok(PixelRect { min, max })
    } else {
        Err("the rectangle is empty: its end is not beyond its beginning".into())
    }
}

/// Reads a part of the film as fractions of its size, in pbrt's order: `x0,x1,y0,y1`.
pub(crate) fn crop_fractions(text: &str) -> Result<[f32; 4], String> {
    let [x0, x1, y0, y1] = list(text).ok_or("expected four numbers from 0 to 1: x0,x1,y0,y1")?;
    if 0.0 <= x0 && x0 < x1 && x1 <= 1.0 && 0.0 <= y0 && y0 < y1 && y1 <= 1.0 {
        Ok([x0, x1, y0, y1])
    } else {
        Err("expected 0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1".into())
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

/// Reads a sample to repeat.
pub(crate) fn replay_target(text: &str) -> Result<ReplayTarget, String> {
    let [x, y, pass] = list(text).ok_or("expected three whole numbers: x,y,pass")?;
    let pixel = |at: u64| u32::try_from(at).map_err(|_| format!("there is no pixel {at}"));
    Ok(ReplayTarget {
        pixel: [pixel(x)?, pixel(y)?],
        pass,
    })
}

/// Reads a length of time, written `90`, `90s`, `10m`, `1h30m`.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let expected = || "expected a time such as 90, 90s, 10m or 1h30m".to_owned();
    let trimmed = text.trim();
    let is_known = |c: char| c.is_ascii_digit() || ".hms".contains(c);
    // A single number without a unit is in seconds.
    let number = trimmed.parse();
    let (mut seconds, mut rest) = number.map_or((0.0, trimmed), |seconds| (seconds, ""));
    for (unit, length) in [('h', 3600.0), ('m', 60.0), ('s', 1.0)] {
        if let Some((count, after)) = rest.split_once(unit) {
            seconds += count.parse::<f64>().map_err(|_| expected())? * length;
            rest = after;
        }
    }
    if trimmed.is_empty() || !trimmed.chars().all(is_known) || !rest.is_empty() {
        return Err(expected());
    }
    match Duration::try_from_secs_f64(seconds) {
        Ok(Duration::ZERO) => Err("must be above 0, such as 90s".to_owned()),
        time => time.map_err(|_| expected()),
    }
}

/// Formats a length of time, such as `1.23s`, `1m30s` or `1h30m`.
pub(crate) fn short(time: Duration) -> String {
    let whole = time.as_secs();
    match (whole / 3600, whole / 60 % 60) {
        (0, 0) if whole < 10 => format!("{:.2}s", time.as_secs_f64()),
        (0, 0) => format!("{:.1}s", time.as_secs_f64()),
        (0, minutes) => format!("{minutes}m{:02}s", whole % 60),
        (hours, minutes) => format!("{hours}h{minutes:02}m"),
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
        let time = duration(text).ok();
        assert_eq!(time.map(|time| time.as_secs_f64()), expected, "{text}");
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
        let write = |seconds| short(Duration::from_secs_f64(seconds));
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
        assert_eq!(pixel_bounds("1,2,3,4"), Ok(rect));
        assert_eq!(pbrt_pixel_bounds("1,3,2,4"), Ok(rect));
        for text in ["1,2,3", "1,2,1,4", "a,b,c,d", "-1,0,3,4"] {
            assert!(pixel_bounds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn fractions_are_checked() {
        assert_eq!(
            crop_fractions("0.25,0.75,0,0.5"),
            Ok([0.25, 0.75, 0.0, 0.5])
        );
        assert!(crop_fractions("0.5,0.5,0,1").is_err());
        assert!(crop_fractions("0,2,0,1").is_err());
        assert!(crop_fractions("nan,1,0,1").is_err());
    }

    #[test]
    fn sizes_and_samples_are_checked() {
        assert_eq!(size("1920x1080"), Ok([1920, 1080]));
        let (pixel, pass) = ([3, 4], 17);
        assert_eq!(replay_target("3,4,17"), Ok(ReplayTarget { pixel, pass }));
        assert!(size("0x5").is_err() && replay_target("1,2").is_err());
    }
}
