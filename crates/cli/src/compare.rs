//! `bidir compare`: error metrics of images against a reference.

mod noise;
mod report;

use crate::args::{CompareArgs, MetricArgs};
use crate::console::{Console, print, print_json, say};
use crate::exit::{Exit, Failure};
use crate::output;
use crate::scene_io::{self, IMAGES, MetadataValue};
use lab::image::{Pair, identical, resample};
use lab::metric::{ErrorMap, Metric, mean_ratio};
use noise::{Noisy, Significance};
use report::{Comparison, MEAN_RATIO, Number, Replicates};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Compares images with a reference.
pub(crate) fn run(args: &CompareArgs, console: Console) -> Result<Exit, Failure> {
    let (images, reference) = files(args)?;
    if let Some(path) = &args.metrics.error_map {
        let reference = reference_files(reference);
        let inputs = images.iter().chain(&reference);
        output::check_image("--error-map", path, IMAGES, inputs)?;
    }
    let comparisons = compare_all(args, images, reference, console)?;
    match &comparisons[..] {
        [one] if args.json => print_json(one)?,
        [one] => print(&one.text())?,
        several => {
            let replicates = Replicates::of(several, images)?;
            if args.json {
                print_json(&replicates)?
            } else {
                print(&replicates.text())?
            }
        }
    };
    if args.exact && comparisons.iter().any(|one| !one.identical) {
        return Ok(Exit::Validation);
    }
    Ok(Exit::Done)
}

/// Returns the images and the path of the reference.
fn files(args: &CompareArgs) -> Result<(&[PathBuf], &Path), Failure> {
    let (images, reference) = match (&args.reference, &args.images[..]) {
        (Some(reference), images) => (images, reference),
        (None, [image, reference]) => (std::slice::from_ref(image), reference),
        (None, images) => {
            let quoted = images.iter().map(|image| format!("`{}`", image.display()));
            let names: Vec<_> = quoted.collect();
            let message = format!("nothing to compare {} with", names.join(", "));
            let hint = "name one image and its reference, or any number of images and --reference";
            return Err(Failure::usage(message).with_hint(hint));
        }
    };
    if args.metrics.error_map.is_some() && images.len() != 1 {
        return Err(Failure::usage("--error-map takes one image"));
    }
    Ok((images, reference))
}

/// Returns the files of a reference, which may be a folder.
fn reference_files(reference: &Path) -> Vec<PathBuf> {
    if reference.is_dir() {
        return lab::reference::files(reference);
    }
    vec![reference.to_owned()]
}

/// Compares every image. Warns if the noise of two images, or of the pixels of one image, is correlated.
fn compare_all(
    args: &CompareArgs,
    paths: &[PathBuf],
    name: &Path,
    console: Console,
) -> Result<Vec<Comparison>, Failure> {
    let reference = Noisy::reference(name)?;
    let (mut images, mut warnings) = (Vec::new(), Vec::new());
    let compared = paths.iter().map(|path| {
        let image = Noisy::read(path)?;
        let comparison = compare(args, &image, &reference)?;
        // Intervals over several images do not assume independent pixels.
        if paths.len() == 1 && comparison.significance.is_some() {
            warnings.extend(image.correlation().or_else(|| reference.correlation()));
        }
        warnings.extend(image.likeness(&images));
        images.push(image);
        Ok(comparison)
    });
    let comparisons = compared.collect();
    for warning in &warnings {
        console.warning(warning);
    }
    comparisons
}

/// Compares one image.
fn compare(args: &CompareArgs, image: &Noisy, reference: &Noisy) -> Result<Comparison, Failure> {
    let [mut a, mut b] = [&image.pixels, &reference.pixels].map(Cow::Borrowed);
    let mut resampled = None;
    if args.resample && a.size != b.size {
        // The larger image is resampled to the size of the other.
        if a.data.len() > b.data.len() {
            (a, resampled) = (Cow::Owned(resample(&a, b.size)), Some("A"));
        } else {
            (b, resampled) = (Cow::Owned(resample(&b, a.size)), Some("B"));
        }
    }
    let pair = Pair::new(&a, &b);
    if pair.is_none() && !args.exact {
        return Err(sizes_differ([image, reference]));
    }
    Ok(Comparison {
        numbers: numbers(&args.metrics, pair.as_ref())?,
        identical: identical(&image.pixels, &reference.pixels),
        size: pair.map(|pair| pair.size()),
        resampled,
        significance: Significance::of(image, reference),
    })
}

fn sizes_differ(images: [&Noisy; 2]) -> Failure {
    let [a, b] = images.map(|image| {
        let [width, height] = image.pixels.size;
        format!("`{}` is {width}x{height}", image.path.display())
    });
    let message = format!("the images differ in size: {a}, {b}");
    Failure::new(Exit::InputOutput, message).with_hint("average the larger one with --resample")
}

/// Returns the metrics to compute: the fast ones always, FLIP only if flags request it.
fn metrics(args: &MetricArgs) -> impl Iterator<Item = (&'static str, Metric)> {
    let mapped = args.error_map.as_ref().map(|_| args.metric);
    let chosen = move |metric: Metric| metric.is_fast() || args.flip || mapped == Some(metric);
    let metrics = Metric::NAMES.into_iter();
    metrics.filter(move |(_, metric)| chosen(*metric))
}

/// Computes all metrics of a pair, and writes the error map if one is requested. Without a pair, as sizes differ,
/// metrics have no values.
fn numbers(args: &MetricArgs, pair: Option<&Pair<'_>>) -> Result<Vec<Number>, Failure> {
    let mut numbers = Vec::new();
    for (name, metric) in metrics(args) {
        let errors = pair.map(|pair| metric.errors(pair));
        let map = args.error_map.as_deref().filter(|_| args.metric == metric);
        if let Some((path, errors)) = map.zip(errors.as_ref()) {
            write_map(path, name, errors, args.error_max)?;
        }
        numbers.push((name, errors.map(|errors| metric.pool(&errors))));
    }
    numbers.push((MEAN_RATIO, pair.map(mean_ratio)));
    Ok(numbers)
}

fn write_map(path: &Path, metric: &str, errors: &ErrorMap, full: f64) -> Result<(), Failure> {
    let metadata = [(
        "bidir/metric".to_owned(),
        MetadataValue::Text(metric.to_owned()),
    )];
    scene_io::write_error_map(path, errors, full, &metadata)?;
    say(format_args!("wrote {}", path.display()));
    Ok(())
}
