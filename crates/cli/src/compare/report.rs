//! The results of a comparison, as text and as JSON.

use super::noise::{self, Significance};
use crate::exit::{Exit, Failure};
use lab::statistics::{Interval, mean_interval};
use serde::{Serialize, Serializer};
use std::path::PathBuf;

/// A metric's name and value. None: the sizes differ.
pub(super) type Number = (&'static str, Option<f64>);

/// The name of the ratio of means, which is printed with fixed digits.
pub(super) const MEAN_RATIO: &str = "mean_ratio";

/// The probability that an interval contains the mean over infinitely many seeds.
const CONFIDENCE: f64 = 0.95;

/// The results of one image. Numbers that are not finite become null in JSON, which has no such numbers.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    #[serde(flatten, serialize_with = "as_map")]
    pub(super) numbers: Vec<Number>,
    /// True if the images have the same size and the same bits.
    pub(super) identical: bool,
    /// Width and height of the compared images. None: the sizes differ.
    pub(super) size: Option<[usize; 2]>,
    /// The image that was resampled to the size of the other: `A` or `B`. None: sizes are equal, or were not changed.
    pub(super) resampled: Option<&'static str>,
    /// The tests of the difference against noise. None: an image has no variances, or the sizes differ.
    #[serde(rename = "z_test", skip_serializing_if = "Option::is_none")]
    pub(super) significance: Option<Significance>,
}

/// The results of several images with independent seeds.
#[derive(Debug, Serialize)]
pub(super) struct Replicates {
    #[serde(flatten, serialize_with = "as_map")]
    numbers: Vec<(&'static str, Option<Spread>)>,
    /// True if all images are identical to the reference.
    identical: bool,
    size: Option<[usize; 2]>,
    resampled: Option<&'static str>,
    /// The number of images.
    images: usize,
    /// The confidence level of the intervals.
    confidence: f64,
}

/// The mean of a metric over several images, with its confidence interval.
#[derive(Debug, Serialize)]
struct Spread {
    mean: f64,
    low: f64,
    high: f64,
    /// The values in the order of the images.
    values: Vec<f64>,
}

/// Serializes names and values as a map in their order.
fn as_map<T: Serialize, S: Serializer>(
    entries: &[(&'static str, T)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(entries.iter().map(|(name, value)| (name, value)))
}

/// Refuses images that were compared at different sizes.
fn check_sizes(comparisons: &[Comparison], files: &[PathBuf]) -> Result<(), Failure> {
    let both = comparisons.iter().zip(files);
    let sized: Vec<_> = both
        .filter_map(|(one, file)| Some((file, one.size?)))
        .collect();
    let mut pairs = sized.windows(2).map(|pair| (pair[0], pair[1]));
    let Some(((a, [aw, ah]), (b, [bw, bh]))) = pairs.find(|(a, b)| a.1 != b.1) else {
        return Ok(());
    };
    let (a, b) = (a.display(), b.display());
    let message =
        format!("the images differ in size: `{a}` is compared at {aw}x{ah}, `{b}` at {bw}x{bh}");
    let hint = "the images of one comparison are renders of one film, with seeds of their own";
    Err(Failure::new(Exit::InputOutput, message).with_hint(hint))
}

impl Replicates {
    /// Joins the results of several images, read from `files`.
    pub(super) fn of(comparisons: &[Comparison], files: &[PathBuf]) -> Result<Self, Failure> {
        check_sizes(comparisons, files)?;
        let sizes: Vec<_> = comparisons.iter().filter_map(|one| one.size).collect();
        let spread = |i: usize| {
            let given = comparisons.iter().map(|comparison| comparison.numbers[i].1);
            let values: Vec<f64> = given.collect::<Option<_>>()?;
            let Interval { value, low, high } = mean_interval(&values, CONFIDENCE)?;
            Some(Spread {
                mean: value,
                low,
                high,
                values,
            })
        };
        let all_have_one = sizes.len() == comparisons.len();
        let first = comparisons.first().map_or(&[][..], |one| &one.numbers);
        let names = first.iter().enumerate();
        Ok(Self {
            numbers: names.map(|(i, (name, _))| (*name, spread(i))).collect(),
            identical: comparisons.iter().all(|one| one.identical),
            size: sizes.first().copied().filter(|_| all_have_one),
            resampled: comparisons.iter().find_map(|one| one.resampled),
            images: comparisons.len(),
            confidence: CONFIDENCE,
        })
    }

    /// Returns one number per line, with its interval.
    pub(super) fn text(&self) -> String {
        let numbers = self.numbers.iter().map(|(name, spread)| {
            let number = |value| number_text(name, value);
            let interval = spread.as_ref().map_or_else(String::new, |spread| {
                format!(
                    "  {} to {}",
                    number(Some(spread.low)),
                    number(Some(spread.high))
                )
            });
            let mean = spread.as_ref().map(|spread| spread.mean);
            (*name, number(mean) + &interval)
        });
        let percent = self.confidence * 100.0;
        let others = [
            (
                "identical",
                ["no", "yes"][usize::from(self.identical)].to_owned(),
            ),
            (
                "images",
                format!("{}, with intervals of {percent} %", self.images),
            ),
        ];
        columns(numbers.chain(others).collect(), self.resampled, self.size)
    }
}

impl Comparison {
    /// Returns one value per line.
    pub(super) fn text(&self) -> String {
        let measured = self.numbers.iter();
        let numbers = measured.map(|(name, value)| (*name, number_text(name, *value)));
        let tests = self.significance.as_ref().map(|found| {
            let pixels = ("z_pixels", noise::text(&found.pixels));
            [pixels, ("z_blocks", noise::text(&found.blocks))]
        });
        let identical = [(
            "identical",
            ["no", "yes"][usize::from(self.identical)].to_owned(),
        )];
        let lines = numbers.chain(identical).chain(tests.into_iter().flatten());
        columns(lines.collect(), self.resampled, self.size)
    }
}

/// Formats a number with four digits: errors in scientific notation, the ratio of means, which is near 1, with
/// fixed digits. JSON has all digits.
fn number_text(name: &str, value: Option<f64>) -> String {
    match value {
        None => "none: the sizes differ".to_owned(),
        Some(value) if name == MEAN_RATIO => format!("{value:.4}"),
        Some(value) => format!("{value:.3e}"),
    }
}

/// Formats names and values in two columns.
fn columns(
    lines: Vec<(&str, String)>,
    resampled: Option<&str>,
    size: Option<[usize; 2]>,
) -> String {
    let change = resampled.zip(size);
    let resampled = change.map(|(which, [w, h])| ("resampled", format!("{which} to {w}x{h}")));
    let all = lines.into_iter().chain(resampled);
    let lines = all.map(|(name, value)| format!("{name:<12} {value}\n"));
    lines.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::json;

    fn comparison(numbers: &[Number]) -> Comparison {
        Comparison {
            numbers: numbers.to_vec(),
            identical: false,
            size: Some([1, 1]),
            resampled: None,
            significance: None,
        }
    }

    fn parsed(value: &impl Serialize) -> serde_json::Value {
        serde_json::from_str(&json(value).unwrap()).unwrap()
    }

    #[test]
    fn numbers_that_are_not_finite_are_null_in_json() {
        let json = parsed(&comparison(&[
            ("rmse", Some(f64::NAN)),
            ("relmse", Some(f64::INFINITY)),
            ("mean_ratio", None),
        ]));
        for key in ["rmse", "relmse", "mean_ratio"] {
            assert!(json[key].is_null(), "{key}");
        }
        assert_eq!(json["size"], serde_json::json!([1, 1]));
    }

    #[test]
    fn several_images_have_a_mean_and_an_interval() {
        let comparisons =
            [1.0, 2.0, 3.0, 4.0, 5.0].map(|value| comparison(&[("rmse", Some(value))]));
        let replicates = Replicates::of(&comparisons, &[]).unwrap();
        let json = parsed(&replicates);
        assert_eq!(json["rmse"]["mean"], 3.0);
        // 2.776 · √(2.5 / 5)
        let high = json["rmse"]["high"].as_f64().unwrap();
        assert!((high - 4.963).abs() < 1e-3, "{high}");
        assert_eq!(json["rmse"]["values"][4], 5.0);
        assert_eq!(json["images"], 5);
        let text = replicates.text();
        assert!(
            text.contains("images       5, with intervals of 95 %"),
            "{text}"
        );
        assert!(
            text.contains("rmse         3.000e0  1.037e0 to 4.963e0"),
            "{text}"
        );
    }

    #[test]
    fn images_of_several_sizes_have_no_mean() {
        let mut comparisons = [1.0, 2.0].map(|value| comparison(&[("rmse", Some(value))]));
        comparisons[1].size = Some([2, 3]);
        let files = ["a.exr", "b.exr"].map(PathBuf::from);
        let failure = Replicates::of(&comparisons, &files).unwrap_err();
        let message = failure.message();
        assert!(
            message.ends_with("`a.exr` is compared at 1x1, `b.exr` at 2x3"),
            "{message}"
        );
    }
}
