//! `bidir compare`: two images, in numbers.

use crate::args::CompareArgs;
use crate::console::{print, print_json};
use crate::exit::{Exit, Failure};
use crate::metrics::{self, Pixels};
use crate::resample::resample;
use crate::scene_io::read_image;
use serde::Serialize;
use std::fmt::Write;

/// What is found. As JSON has no other numbers, those that are not finite become null in it.
#[derive(Debug, Serialize)]
struct Comparison {
    /// None: the sizes differ; so below.
    rmse: Option<f64>,
    relmse: Option<f64>,
    mean_ratio: Option<f64>,
    identical: bool,
    /// Width and height of what was compared.
    size: Option<[usize; 2]>,
    /// Which image was brought to the size of the other.
    resampled: Option<&'static str>,
}

/// Compares two images.
pub(crate) fn run(args: &CompareArgs) -> Result<Exit, Failure> {
    let (a, b) = (read_image(&args.a)?, read_image(&args.b)?);
    let comparison = compare(args, a, b)?;
    if args.json {
        print_json(&comparison)?;
    } else {
        print(&comparison.text())?;
    }
    if args.exact && !comparison.identical {
        return Ok(Exit::Validation);
    }
    Ok(Exit::Done)
}

fn compare(args: &CompareArgs, mut a: Pixels, mut b: Pixels) -> Result<Comparison, Failure> {
    let identical = metrics::identical(&a, &b);
    let mut resampled = None;
    if a.size != b.size && args.resample {
        let larger_a = a.data.len() > b.data.len();
        resampled = Some(if larger_a { "A" } else { "B" });
        if larger_a {
            a = resample(&a, b.size);
        } else {
            b = resample(&b, a.size);
        }
    }
    if a.size == b.size {
        return Ok(Comparison {
            rmse: Some(metrics::rmse(&a, &b)),
            relmse: Some(metrics::relmse(&a, &b)),
            mean_ratio: Some(metrics::mean_ratio(&a, &b)),
            identical,
            size: Some(a.size),
            resampled,
        });
    }
    if args.exact {
        let (rmse, relmse, mean_ratio) = (None, None, None);
        return Ok(Comparison {
            rmse,
            relmse,
            mean_ratio,
            identical,
            size: None,
            resampled,
        });
    }
    let ([aw, ah], [bw, bh]) = (a.size, b.size);
    let message = format!("the images differ in size: A is {aw}x{ah}, B is {bw}x{bh}");
    Err(Failure::new(Exit::InputOutput, message)
        .with_hint("average the larger one with --resample"))
}

impl Comparison {
    /// One value per line.
    fn text(&self) -> String {
        let number = |value: Option<f64>| {
            value.map_or_else(
                || "none: the sizes differ".to_owned(),
                |value| format!("{value:.6e}"),
            )
        };
        let identical = if self.identical { "yes" } else { "no" };
        let mut text = format!(
            "rmse        {}\nrelmse      {}\nmean_ratio  {}\nidentical   {identical}\n",
            number(self.rmse),
            number(self.relmse),
            self.mean_ratio
                .map_or_else(|| number(None), |ratio| format!("{ratio:.6}")),
        );
        if let (Some(which), Some([width, height])) = (self.resampled, self.size) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "resampled   {which} to {width}x{height}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::json;

    #[test]
    fn numbers_that_json_does_not_have_are_null() {
        let comparison = Comparison {
            rmse: Some(f64::NAN),
            relmse: Some(f64::INFINITY),
            mean_ratio: None,
            identical: false,
            size: Some([1, 1]),
            resampled: None,
        };
        let json: serde_json::Value = serde_json::from_str(&json(&comparison).unwrap()).unwrap();
        for key in ["rmse", "relmse", "mean_ratio"] {
            assert!(json[key].is_null(), "{key}");
        }
        assert_eq!(json["size"], serde_json::json!([1, 1]));
    }
}
